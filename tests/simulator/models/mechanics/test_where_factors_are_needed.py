"""Scenes whose pixels are pressed by a depth or a force, given to what presses by factors."""

import numpy as np
import pytest
from rcskin.simulator.bounds.fields import Fields
from rcskin.simulator.calibration.run import calibrate
from rcskin.simulator.inversion.tables import strength_prior
from rcskin.simulator.measure.experiment import own_presses, planned_presses
from rcskin.simulator.measure.simulate import resimulated, simulate
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.files import scene_text
from rcskin.simulator.sweeps import InputError, impedance


def calibrated(scene):
    return calibrate(scene, simulate(Solver(scene), [parse_press("none", 2.0)]))


@pytest.mark.parametrize("key", ["depth", "force"])
@pytest.mark.parametrize(
    "asked",
    [
        calibrated,
        lambda scene: Fields(scene, 1e4),
        lambda scene: planned_presses(scene, np.random.default_rng(1)),
        own_presses,
        lambda scene: strength_prior(scene, "press"),
    ],
    ids=["calibrate", "limits", "planned", "own presses", "tables"],
)
def test_it_is_refused_by_its_key(foam_scene, key, asked):
    scene = foam_scene(press={key: 1e-3})
    with pytest.raises(InputError, match=rf"`press\.{key}`: it needs `press.capacitance_factor`"):
        asked(scene)


def test_presses_that_do_not_say_how_strongly_are_pressed_as_the_scene_presses(foam_scene):
    scene = foam_scene(press={"depth": 1e-3})
    truth = simulate(Solver(scene), [parse_press("1,1:1mm", 2.0)])
    named = truth.assign(press=("sweep", np.array(["1,1"], dtype=object)))
    again = resimulated(named, scene_text(scene), scene.frequencies)
    np.testing.assert_allclose(impedance(again), impedance(truth), rtol=1e-12)
