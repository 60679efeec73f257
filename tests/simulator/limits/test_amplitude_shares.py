"""Amplitudes of a multisine that minimize a limit."""

import numpy as np
import pytest
from rcskin.simulator.bounds.position_bound import chosen_touch
from rcskin.simulator.limits.amplitude_shares import FILLED, fitted, shared_amplitudes
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.multisine.excitation import output_peak
from rcskin.simulator.scene.scene_files import load_scene, write_scene


@pytest.fixture(scope="module")
def scene():
    return load_scene("strip-1x3").with_(
        {
            "interface.left.reader": "multisine",
            "readout.magnitude_noise": 0.0,
            "readout.phase_noise": 0.0,
            "readout.multisine": {"feedback_resistance": 1e6, "peak_voltage": 1e-3},
        }
    )


def test_the_feedback_resistance_fills_the_stated_part_of_the_range(scene):
    Z = Solver(scene).solve(Press()).Z
    for C in (0.0, 1e-12):
        changes = {"peak_voltage": 1.0, "feedback_capacitance": C}
        keys = {f"readout.multisine.{key}": value for key, value in changes.items()}
        own = fitted(scene.with_(keys), Z)
        peak = output_peak(own.readout.multisine, Z, own.frequencies).max()
        assert peak == pytest.approx(FILLED * own.readout.multisine.full_scale, rel=0.01)


@pytest.mark.parametrize("criterion", ["position", "column"])
def test_shared_amplitudes_lower_the_limit_at_the_same_peak_voltage(scene, criterion):
    found = shared_amplitudes(scene, chosen_touch(scene), criterion=criterion, against_rest=1)
    equal, shared = found.figures
    assert shared < equal
    power = found.amplitudes**2
    assert power.min() > 0.05 and 0.5 < np.mean(power) < 2
    noisier, quieter = found.deviations
    assert (quieter[found.amplitudes > 1.05] < noisier[found.amplitudes > 1.05]).all()
    for each in (found.equal, found.shared):
        assert each.readout.multisine.peak_voltage == 1e-3


def test_the_command_writes_a_scene_with_the_amplitudes(run, tmp_path, scene):
    path, made = tmp_path / "scene.toml", tmp_path / "shared.toml"
    write_scene(path, scene)
    code, out, err = run("amplitudes", path, "--against-rest", "1", "-o", made)
    assert code == 0
    assert len(out.split()) == 3 and "equal: rms bound" in err and "shared: rms bound" in err
    assert len(load_scene(made).readout.multisine.amplitudes) == 3


def test_a_scene_without_multisine_has_no_amplitudes(run):
    code, out, err = run("amplitudes", "strip-1x3")
    assert (code, out) == (2, "")
    assert 'strip-1x3: `reader` must be "multisine" for amplitudes of tones' in err
