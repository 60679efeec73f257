"""The gap of a yarn that is read by gains, with phase or by magnitude alone."""

import json

import numpy as np
import pytest
from rcskin.simulator.measure.experiment import planned_presses
from rcskin.simulator.measure.readout import read_out
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import every_press
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import write

FREQUENCIES = {"start": 2e3, "stop": 25e3, "points": 6, "spacing": "linear"}


def yarn(magnitude_only, sheet_resistance=13.889e3):
    return load_scene("knit-36").with_(
        {
            "pixels.columns": 4,
            "sweep.frequencies": FREQUENCIES,
            "experiment.repetitions": 3,
            "interface.1.magnitude_only": magnitude_only,
            "interface.2.magnitude_only": magnitude_only,
            "skin.top.sheet_resistance": sheet_resistance,
            "press.factor_spread": 0.0,
        }
    )


def simulated(magnitude_only):
    scene = yarn(magnitude_only)
    return simulate(Solver(scene.parts), every_press(scene.parts.skin, scene.press))


def recorded(magnitude_only):
    """Sweeps of a yarn with a tenth more of resistance, as its reader reads them."""
    scene = yarn(magnitude_only, 1.1 * 13.889e3)
    presses = planned_presses(scene.parts.skin, scene.parts.plan, np.random.default_rng(1))
    return read_out(simulate(Solver(scene.parts), presses), scene.readout, np.random.default_rng(2))


@pytest.mark.usefixtures("linear_intervals", "unpainted")
@pytest.mark.parametrize("magnitude_only", [True, pytest.param(False, marks=pytest.mark.slow)])
def test_the_resistance_of_a_yarn_is_named_as_the_cause(run, tmp_path, magnitude_only):
    write(simulated(magnitude_only), tmp_path / "simulated.nc")
    write(recorded(magnitude_only), tmp_path / "recorded.nc")
    files = tmp_path / "simulated.nc", tmp_path / "recorded.nc"
    asked = ("--target", "column", "--draws", 1, "-o", tmp_path / "gap")
    code, out, _ = run("gap", *files, *asked)
    assert code == 0 and "Sheet resistance explains most of the gap" in out
    found = json.loads((tmp_path / "gap" / "gap.json").read_text())
    phase = [] if magnitude_only else ["phaseG"]
    assert found["features"]["gains"] == ["lnG", *phase]
    before, after = (found["distance"][stage]["pressed"] for stage in ("before", "after"))
    assert list(before) == ["gain", *([] if magnitude_only else ["gain_phase"])]
    for name in before:
        far, near = (np.abs(each[name]["mean"]).max() for each in (before, after))
        assert near < 0.2 * far


def test_gains_are_not_compared_with_magnitudes(refused, tmp_path):
    write(simulated(True), tmp_path / "magnitudes.nc")
    write(simulated(False), tmp_path / "gains.nc")
    files = tmp_path / "magnitudes.nc", tmp_path / "gains.nc"
    message = "the simulated sweeps hold the magnitude of the gain, the others the gain; "
    assert message in refused("gap", *files, "-o", tmp_path / "gap")
