"""Scenes whose pixels are pressed by a depth or a force, given to what counts by factors."""

import numpy as np
import pytest
from rcskin.simulator.inversion.touch_templates import strength_prior
from rcskin.simulator.measure.experiment import own_presses, planned_presses
from rcskin.simulator.measure.simulate import resimulated, simulate
from rcskin.simulator.models.mechanics.force_depths import pressed_by_factors
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.sweeps import InputError, impedance


@pytest.mark.parametrize(
    "feature",
    [
        lambda scene: planned_presses(scene.parts.skin, scene.parts.plan, np.random.default_rng(1)),
        lambda scene: own_presses(scene.parts.skin, scene.press),
        lambda scene: strength_prior(scene.parts.skin, scene.parts.plan, "press"),
    ],
    ids=["planned", "own presses", "tables"],
)
def test_a_force_is_refused_by_its_key(foam_scene, feature):
    with pytest.raises(InputError, match=r"`press\.force`.*`press.depth`"):
        feature(foam_scene(press={"force": 1.0}))


def test_a_depth_is_counted_by_the_factor_under_its_applicator(foam_scene):
    scene = foam_scene(press={"depth": 1e-3})
    factor = float(scene.skin.foam.mechanics.factor(np.array(1e-3 / scene.skin.foam.thickness)))
    assert (
        own_presses(scene.parts.skin, scene.press).low
        == own_presses(scene.parts.skin, scene.press).high
        == pytest.approx(factor)
    )
    assert strength_prior(scene.parts.skin, scene.parts.plan, "press")[0] == pytest.approx([factor])
    press, *_ = planned_presses(scene.parts.skin, scene.parts.plan, np.random.default_rng(1))[
        scene.experiment.repetitions :
    ]
    assert press.touches[0].by.value == pytest.approx(1e-3)


def test_without_a_tension_a_depth_is_its_factor(foam_scene):
    scene = foam_scene(tension=0.0, press={"depth": 1e-3})
    factors = pressed_by_factors(scene.parts)
    assert factors.plan.press.capacitance_factor == scene.press.factor(scene.parts.skin)
    assert factors.plan.press.by_factor


def test_presses_that_do_not_say_how_strongly_are_pressed_as_the_scene_presses(foam_scene):
    scene = foam_scene(press={"depth": 1e-3})
    truth = simulate(Solver(scene.parts), [parse_press("1,1:1mm", 2.0)])
    named = truth.assign(press=("sweep", np.array(["1,1"], dtype=object)))
    again = resimulated(named, scene.parts, scene.frequencies)
    np.testing.assert_allclose(impedance(again), impedance(truth), rtol=1e-12)
