"""Scenes with a multisine reader: tones, refusals, times, noise, and what other scenes keep."""

import numpy as np
import pytest
from rcskin.simulator.measure.foam_state import reading_moments
from rcskin.simulator.measure.readout import read_out
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.scene_files import load_scene, parse_scene, scene_text
from rcskin.simulator.sweeps import InputError, impedance
from rcskin.tests.refusals import refusal_of

ELECTRONICS = {"feedback_resistance": 1e6}


def multisine(name="strip-1x3", electronics=ELECTRONICS, **changes):
    scene = load_scene(name)
    readers = {f"interface.{each.name}.reader": "multisine" for each in scene.interfaces}
    quiet = {"readout.magnitude_noise": 0.0, "readout.phase_noise": 0.0}
    return scene.with_({**readers, **quiet, "readout.multisine": electronics, **changes})


REFUSALS = {
    "table": ({"electronics": None}, "needs the table readout.multisine with feedback_resistance"),
    "resistance": ({"electronics": {"frames": 2}}, "feedback_resistance` is missing"),
    "reader": (
        {"interface.left.reader": "impedance"},
        '`readout.multisine` is of interfaces with reader = "multisine", got "impedance"',
    ),
    "own frequencies": (
        {"interface.left.frequencies": [707]},
        "`frequencies` must be left out with reader",
    ),
    "low": ({"sweep.frequencies": [40.0, 1e3]}, "must be >= 125 Hz for a frame of 0.008 s, got 40"),
    "amplitudes": (
        {"electronics": {**ELECTRONICS, "amplitudes": [1.0]}},
        "`readout.multisine.amplitudes` must have one item for each of the 3 frequencies, got 1",
    ),
    "gain": (
        {"interface.left.series_resistance": 1e5},
        'takes series_resistance with reader = "gain" only',
    ),
}


@pytest.mark.parametrize("changes, message", REFUSALS.values(), ids=REFUSALS)
def test_readers_that_do_not_fit_a_scene(changes, message):
    assert message in refusal_of(multisine, **changes)


def test_tones_are_on_the_grid_and_a_scene_file_keeps_the_reader():
    scene = multisine("sheet-5x5")
    assert np.all(scene.frequencies % 125 == 0) and len(scene.frequencies) == 20
    again = parse_scene(scene_text(scene), "again")
    assert again == scene and scene_text(again) == scene_text(scene)


def test_a_scene_with_another_reader_says_nothing_of_a_multisine():
    scene = load_scene("sheet-5x5")
    assert "multisine" not in scene_text(scene) + scene.readout.model_dump_json()


def test_all_frequencies_of_an_interface_are_read_at_the_same_time():
    scene = multisine("sheet-5x5-two-interfaces", {**ELECTRONICS, "frames": 3})
    moments, whole = reading_moments(scene.parts)
    assert whole == pytest.approx(2 * (0.02 + 0.024))
    np.testing.assert_allclose(moments - moments[:, :1], 0, atol=1e-15)
    assert moments[1, 0] - moments[0, 0] == pytest.approx(0.044)


def test_readings_have_the_noise_of_the_electronics_and_other_noise_is_added():
    extra = {"readout.magnitude_noise": 1e-3, "readout.phase_noise": 2e-3}
    scene = multisine(**extra, **{"readout.display_digits": 15})
    exact = simulate(Solver(scene.parts), [Press()])
    seen = read_out(exact.isel(sweep=np.zeros(3000, int)), scene.readout, np.random.default_rng(1))
    error = np.log(impedance(seen) / impedance(exact))
    expected = scene.readout.noise(impedance(exact), scene.frequencies)[:, 0]
    assert (expected[0] > 1e-3).all() and (expected[1] > 2e-3).all()
    np.testing.assert_allclose(error.real.std(axis=0), expected[0], rtol=0.1)
    np.testing.assert_allclose(error.imag.std(axis=0), expected[1], rtol=0.1)


def test_a_skin_that_drives_the_amplifier_beyond_its_range_is_refused():
    scene = multisine(electronics={"feedback_resistance": 1e9})
    exact = simulate(Solver(scene.parts), [Press()])
    with pytest.raises(InputError, match=r"`readout.multisine.full_scale` must be >= .* V, the"):
        read_out(exact, scene.readout, np.random.default_rng(1))
