"""Limits of touches by fingers: their slopes, and the kinds of touch."""

import numpy as np
import pytest
from rcskin.simulator.bounds.full_fields import FullFields
from rcskin.simulator.bounds.position_bound import chosen_touch
from rcskin.simulator.bounds.touch_rasterizers import AreaRasterizer
from rcskin.simulator.design.goals import TouchPositions
from rcskin.simulator.limits.survey import with_finger
from rcskin.simulator.limits.touch_identity import Sampling, identity
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press
from rcskin.simulator.press.touch import Rectangle
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import InputError
from rcskin.tests.refusals import refusal_of

ROD = load_scene("sheet-3x3")
RIM = {"mutual": 5.4e-12, "top": 5.5e-12, "bottom": 5.5e-12}
EARTH = ROD.with_(
    {
        "surroundings": {"rim": RIM, "body": {"distance": 1e-2}},
        "pixels": 2,
        "sweep.frequencies": [2e3, 5e4],
    }
)
FINGER = EARTH.with_({"press.finger": 5e-12})


@pytest.fixture(scope="module")
def fields():
    return FullFields(FINGER.parts, 5e4, cells=2)


def rasterized(fields, place, touch):
    cells = AreaRasterizer.of(FINGER.parts.skin, fields.grid)
    return cells.with_finger(cells.rasterized(place, touch), place, touch)


def test_a_touch_by_a_finger_equals_that_of_the_full_model(fields):
    touch = chosen_touch(FINGER.parts.skin, FINGER.press)
    factors, _ = rasterized(fields, (0.06, 0.03), touch)
    found = fields.respond(factors, {}, FINGER.frequencies).Z
    press = Press((Rectangle(0.06, 0.03, 0.06, 0.06, 2.0, 5e-12),))
    np.testing.assert_allclose(found, Solver(FINGER.parts, 1e-5).solve(press).Z, rtol=2e-3)


@pytest.mark.parametrize("rise", [1.0, 0.0])
def test_slopes_of_a_touch_by_a_finger_are_those_of_differences(fields, rise):
    touch, place = (
        chosen_touch(FINGER.parts.skin, FINGER.press)._replace(rise=rise),
        np.array([0.045, 0.07]),
    )
    own = rasterized(fields, tuple(place), touch)
    slopes = fields.respond(own.factors, own.changes, FINGER.frequencies).by_parameter

    def Z(place, touch):
        factors, _ = rasterized(fields, tuple(place), touch)
        return fields.respond(factors, {}, FINGER.frequencies).Z

    for name, step in (("x", [1e-5, 0]), ("y", [0, 1e-5])):
        moved = (Z(place + step, touch) - Z(place - np.array(step), touch)) / 2e-5
        np.testing.assert_allclose(slopes[name], moved, rtol=1e-3)
    for name, field, step in (("strength", "rise", 1e-4), ("finger", "finger", 1e-16)):
        up, down = (
            touch._replace(**{field: getattr(touch, field) + sign * step}) for sign in (1, -1)
        )
        moved = (Z(place, up) - Z(place, down)) / (2 * step)
        np.testing.assert_allclose(slopes[name], moved, rtol=1e-3)


def test_a_finger_changes_a_touch_and_a_tiny_one_equals_a_rod():
    own, none = (
        identity(FINGER.with_({"press.finger": C}).parts, Sampling(1, 300, 6))
        for C in (5e-12, 1e-18)
    )
    assert own.kinds is not None and none.kinds is not None
    assert own.kinds.kinds.share > 0.99
    assert none.kinds.kinds.share == pytest.approx(2 / 3, abs=0.02)
    rod, touched = none.kinds.accuracy.values()
    for target, found in none.accuracy.items():
        assert found.share == pytest.approx(rod[target].share, abs=0.03)
    assert touched["column"].share == pytest.approx(2 / 5, abs=0.02)
    assert own.kinds.accuracy["touched by a finger without a press"]["column"].share > 0.97
    assert identity(EARTH.parts, Sampling(1, 20, 6)).kinds is None


def test_fingers_are_given_as_in_texts_of_presses():
    assert with_finger(EARTH, "5.3pF").press.finger == pytest.approx(5.3e-12)
    assert with_finger(FINGER, "rod").press.finger is None
    assert with_finger(FINGER, None) is FINGER
    assert chosen_touch(FINGER.parts.skin, FINGER.press, factor=1.0).finger == 5e-12


@pytest.mark.parametrize(
    ("scene", "finger", "told"),
    [
        (ROD, "5pF", "needs the table [surroundings]"),
        (EARTH, "finger", "cover"),
        (EARTH, "thumb", "--finger must be finger, floating, rod or"),
    ],
)
def test_an_impossible_finger_is_refused(scene, finger, told):
    assert told in refusal_of(with_finger, scene, finger)


def test_designs_for_positions_refuse_surroundings():
    with pytest.raises(InputError, match="a design for positions cannot take `surroundings`"):
        TouchPositions(FINGER.parts)


def test_a_touch_that_changes_nothing_is_refused():
    with pytest.raises(InputError, match="without a finger"):
        chosen_touch(EARTH.parts.skin, EARTH.press, factor=1.0)
