"""Scenes that are cheap to fit, and what a meter would read on others like them."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from rcskin.simulator.measure.readout import read_out
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.models.parameters import parts_with
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.models.terminals import reduced_for
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.meter import Readout
from rcskin.simulator.scene.parts import Meter, Pressing

METER = Readout(
    magnitude_accuracy=3e-3,
    phase_accuracy=2e-3,
    magnitude_noise=2e-3,
    phase_noise=2e-3,
    display_digits=9,
)
SPREAD = 0.1
NOWHERE = np.array([1.0])


@pytest.fixture(scope="session")
def line(make_scene):
    """A line of three pixels with a meter whose errors are known."""
    scene = make_scene(columns=3, frequencies=np.geomspace(1e3, 2e5, 12).tolist())
    press = Pressing(factor_spread=SPREAD)
    return scene.model_copy(update={"readout": METER, "press": press})


def true_sweeps(scene, truth, presses):
    """Of a skin of other parameters than the scene's, without a meter's errors."""
    return _solved(parts_with(scene.parts, truth or {}).scene, tuple(presses)).copy(deep=True)


@cache
def _solved(scene, presses):
    return simulate(Solver(scene.parts, 1e-5), [parse_press(press, 2.0) for press in presses])


def of_the_skin(parts):
    """The parts without their meter's errors, and without what is read and what is left out."""
    return replace(parts, meter=Meter(), setup=parts.setup.taking(NOWHERE))


@pytest.fixture(scope="session")
def models_made_once():
    """Fits of the same skin share the model that the first of them trains, whatever is read."""
    known = {}

    def train(parts, rtol, draw, **more):
        key = of_the_skin(parts), rtol, more["modes"], more["same_sheets"], *more["frequency"]
        if key not in known:
            known[key] = reduced_for(parts, rtol, draw, **more)
        return replace(known[key], parts=parts)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("rcskin.simulator.calibration.problem.reduced_for", train)
        yield


@pytest.fixture(autouse=True)
def nothing_tried(request, monkeypatch):
    """What surrounds a skin is tried in the tests of that alone: its training takes seconds."""
    if request.module.__name__.rpartition(".")[2] != "test_surroundings":
        for module in ("surroundings_trials", "misfit"):
            name = f"rcskin.simulator.calibration.{module}.addable_effects"
            monkeypatch.setattr(name, lambda scene: [])


@pytest.fixture(scope="session")
def simulated():
    """A function: sweeps of a skin of other parameters than the scene's."""
    return true_sweeps


@pytest.fixture(scope="session")
def read():
    """A function: the same as a meter reads them, and as those who pressed it call the presses."""

    def read(scene, truth=None, presses=("none",), seed=0, readout=None, called=None):
        sweeps = true_sweeps(scene, truth, presses)
        if called is not None:
            sweeps["press"] = ("sweep", np.array(called, dtype=object))
        return read_out(sweeps, readout or scene.readout, np.random.default_rng(seed))

    return read
