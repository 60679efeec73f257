"""The planned presses of an experiment."""

import numpy as np
import pytest
from rcskin.simulator.measure.experiment import (
    METER,
    PRESSES,
    own_presses,
    planned_presses,
    stream,
    strengths,
)
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.meter import Experiment
from rcskin.simulator.scene.parts import Pressing
from rcskin.simulator.scene.randomisation import Uniform
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import InputError


def test_every_pixel_is_pressed_six_times_and_rest_where_it_is_a_class():
    for name, unpressed in (("sheet-3x3", 6), ("sheet-4x4", 0)):
        scene = load_scene(name)
        presses = planned_presses(
            scene.parts.skin, scene.parts.plan, stream(scene.parts.plan, PRESSES)
        )
        assert presses.count(Press()) == unpressed
        pixels, counts = np.unique(
            [p.pixel for p in presses if p.touches], axis=0, return_counts=True
        )
        assert len(pixels) == scene.pixels.rows * scene.pixels.columns
        assert set(counts) == {6}


def test_the_rise_spreads_as_the_scene_says():
    scene = load_scene("sheet-5x5")
    many = scene.model_copy(
        update={"experiment": scene.experiment.model_copy(update={"repetitions": 400})}
    )
    presses = planned_presses(many.parts.skin, many.parts.plan, stream(many.parts.plan, PRESSES))
    rise = np.array([press.touches[0].factor - 1 for press in presses])
    assert rise.mean() == pytest.approx(1.0, abs=0.005)
    assert rise.std() == pytest.approx(0.1, rel=0.03)


def pressing(name="sheet-5x5", **press):
    scene = load_scene(name)
    return scene.model_copy(
        update={
            "press": Pressing(**press),
            "experiment": Experiment(repetitions=400, unpressed=False),
        }
    )


@pytest.mark.parametrize("factor", [2.0, 0.5])
def test_no_planned_press_is_beyond_what_limits_take_presses_to_be(factor):
    scene = pressing(capacitance_factor=factor, factor_spread=0.2)
    drawn = [
        each.touches[0].factor
        for each in planned_presses(
            scene.parts.skin, scene.parts.plan, stream(scene.parts.plan, PRESSES)
        )
    ]
    known = own_presses(scene.parts.skin, scene.press)
    assert known.low <= min(drawn) < max(drawn) <= known.high
    far = sorted(np.abs(np.array(drawn) - factor))[-10]
    assert far > 2.5 * known.deviation


def test_presses_of_which_some_would_leave_no_capacitance_are_refused():
    scene = pressing(capacitance_factor=3.0, factor_spread=0.5)
    with pytest.raises(InputError, match="`press.factor_spread` must be < 0.5 .* got 0.5"):
        planned_presses(scene.parts.skin, scene.parts.plan, stream(scene.parts.plan, PRESSES))


def test_presses_and_meter_draw_from_streams_of_their_own():
    scene = load_scene("sheet-5x5")
    first, again, other = (
        stream(scene.parts.plan, purpose) for purpose in (PRESSES, PRESSES, METER)
    )
    assert first.random() == again.random() != other.random()


def test_strengths_have_the_distributions_moments():
    found = strengths(Uniform(low=1.0, high=3.0), 50)
    assert found.weight.sum() == pytest.approx(1)
    assert found.weight @ found.factor == pytest.approx(2)
    assert found.weight @ (found.factor - 2) ** 2 == pytest.approx(1 / 3, rel=1e-3)
