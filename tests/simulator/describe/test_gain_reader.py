"""What `describe` says of readers of gains, and of multisine readers."""

import pytest
from rcskin.simulator.describe.facts import FILLED, describe_multisine, fitted_resistance
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.multisine import output_peak
from rcskin.simulator.scene.scene_files import load_scene


@pytest.fixture
def lines(run):
    """Lines that the command prints of a built-in scene, by their label."""
    _, out, _ = run("describe", "knit-36")
    return [line.split(maxsplit=1) for line in out.splitlines()[1:]]


def test_readers_of_gains_are_described(lines):
    said = [text for label, text in lines if label == "gain"]
    assert said[0] == (
        "left: reads the magnitude of the gain, driven through 1 Mohm; the input has 10 pF; the "
        "source of right is on at the same time"
    )
    assert said[2].startswith("left: unpressed 0.969 and 0.292 at 2 kHz and 25.8 kHz")
    noise = next(text for label, text in lines if label == "noise")
    assert "of |V / V_s|" in noise


def test_the_stated_feedback_resistance_fills_the_range():
    strip = load_scene("strip-1x3").with_(
        {
            "interface.left.reader": "multisine",
            "readout": {"multisine": {"feedback_resistance": 1e6, "peak_voltage": 1.0}},
        }
    )
    Z = Solver(strip.parts).solve(Press()).Z
    for C in (0.0, 1e-12):
        scene = strip.with_({"readout.multisine.feedback_capacitance": C})
        reader, f = scene.readout.multisine, scene.frequencies
        stated = fitted_resistance(reader, Z, f)
        assert f"feedback_resistance = {stated:g} fills 70 %" in describe_multisine(
            scene.parts, reader
        )
        fitted = scene.with_({"readout.multisine.feedback_resistance": stated}).readout.multisine
        peak = output_peak(fitted, Z, f).max()
        assert peak == pytest.approx(FILLED * reader.full_scale, rel=0.01)
