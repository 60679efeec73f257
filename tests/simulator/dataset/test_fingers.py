"""Fingers, touches that do not press, bodies and rims of a data set: what is drawn, and told."""

import numpy as np
import pytest
from rcskin.simulator.dataset.dataset_plan import DatasetPlan
from rcskin.simulator.dataset.drawn_presses import drawn_presses, pressed_pixels
from rcskin.simulator.dataset.store import variables
from rcskin.simulator.measure.skins import PRESSES, drawn_skin, stream
from rcskin.simulator.press.finger import finger_capacitance
from rcskin.simulator.press.parts import parts_of
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.press.touch import Touch
from rcskin.simulator.scene.scene_files import load_scene, parse_scene, scene_text
from rcskin.simulator.sweeps import InputError

ROD = load_scene("sheet-3x3")
COVER = {"thickness": 1e-3, "relative_permittivity": 3.0}
EARTH = ROD.with_({"surroundings": {"rim": True, "cover": COVER, "body": {"distance": 5e-3}}})
WALLED = EARTH.with_({"surroundings.thickness": True, "surroundings.edges": True})
FINGERS = EARTH.with_({"dataset.press.finger": {"low": 0.0, "high": 1e-11}})
ANYWHERE = {"dataset.press.place": "anywhere", "dataset.press.size": {"low": 0.01, "high": 0.05}}
MISSED = {"dataset.press.offset": 0.1, "dataset.press.cells_per_pixel": 3}


def drawn(scene, count=60, grid=(6, 6)):
    return drawn_presses(scene.parts, stream(1, 0, PRESSES), count, grid)


@pytest.mark.parametrize("place", [{}, ANYWHERE])
def test_fingers_equal_their_texts_and_have_the_places_of_their_touches(place):
    presses = drawn(FINGERS.with_(place))
    foam = parts_of(FINGERS.parts.skin, (6, 6)).foam
    for k, text in enumerate(presses.text):
        press = parse_press(text, default=np.nan)
        assert str(press) == text
        fingers = [touch.finger for touch in press.touches]
        assert fingers == presses.finger[k, : len(fingers)].tolist()
        cells, rises = presses.batch.one(k)
        assert rises[cells >= foam].sum() == pytest.approx(sum(fingers), rel=1e-12)
        assert {*(cells[cells >= foam] - foam).tolist()} == {*cells[cells < foam].tolist()}
    assert 0 < presses.finger[presses.finger > 0].min() < 1e-12
    assert 9e-12 < presses.finger.max() <= 1e-11


def test_a_finger_is_as_dense_all_over_a_touch():
    for scene in (FINGERS, FINGERS.with_(ANYWHERE)):
        presses = drawn(scene)
        foam = parts_of(scene.parts.skin, (6, 6)).foam
        for k in np.flatnonzero(presses.touches == 1):
            cells, rises = presses.batch.one(k)
            covered = dict(zip(cells.tolist(), rises / (presses.factor[k, 0] - 1), strict=True))
            total = sum(part for cell, part in covered.items() if cell < foam)
            for cell, F in zip(cells[cells >= foam], rises[cells >= foam], strict=True):
                share = covered[int(cell) - foam] / total
                assert F == pytest.approx(presses.finger[k, 0] * share, rel=1e-9)


def test_a_hand_that_misses_the_skin_loses_that_part_of_its_finger():
    presses = drawn(FINGERS.with_({**MISSED, "dataset.press.offset": 0.3}), 200, (9, 9))
    meant = [sum(t.finger for t in parse_press(text, 1.0).touches) for text in presses.text]
    whole, left = np.array(meant), presses.finger.sum(axis=1)
    assert (left <= whole * (1 + 1e-12)).all()
    assert 0.3 < np.mean(left[whole > 0] < whole[whole > 0] * (1 - 1e-9)) < 0.95


def test_places_and_strengths_are_drawn_as_without_fingers():
    for place in ({}, ANYWHERE, MISSED):
        own, other = drawn(FINGERS.with_(place)), drawn(EARTH.with_(place))
        np.testing.assert_array_equal(own.x, other.x)
        np.testing.assert_array_equal(own.factor, other.factor)
        assert not other.finger.any()


def test_some_touches_do_not_press():
    presses = drawn(FINGERS.with_({"dataset.press.without_press": 0.3}), 2000)
    there = np.arange(2) < presses.touches[:, None]
    alone = presses.factor[there] == 1
    assert alone.mean() == pytest.approx(0.3, abs=0.03)
    assert (presses.finger[there][alone] > 0).all()
    text = next(t for t, f in zip(presses.text, presses.factor, strict=True) if (f == 1).all())
    assert text == "none" or ":1.0:" in text


def test_the_finger_of_the_scene_is_the_default():
    scene = EARTH.with_({"press.finger": "floating"})
    presses, one = drawn(scene), Touch(1, 1, 1.0)
    own = finger_capacitance(EARTH.with_({"surroundings.body": None}).parts.skin, one, "floating")
    there = np.arange(2) < presses.touches[:, None]
    np.testing.assert_allclose(presses.finger[there], own, rtol=1e-4)
    pressed = pressed_pixels(scene.parts, np.array([[0, 1]]), np.array([2.0]), (3, 3))
    assert pressed.text == [str(parse_press(pressed.text[0], 1.0))]
    assert pressed.batch.rises.tolist() == [1.0, presses.finger.max()]


def test_bodies_and_rims_differ_by_session_and_nothing_else_does():
    scene = EARTH.with_({"dataset.session.body": {"low": 0.5, "high": 2.0}})
    scene = scene.with_({"dataset.session.rim": {"low": 0.9, "high": 1.1}})
    for number in range(20):
        own, other = (drawn_skin(each.parts, 3, number, (3, 3), 4) for each in (scene, EARTH))
        assert 0.5 <= own.variation.body <= 2.0 and 0.9 <= own.variation.rim <= 1.1
        assert (other.variation.body, other.variation.rim) == (1.0, 1.0)
        np.testing.assert_array_equal(own.variation.capacitance, other.variation.capacitance)
        assert own.leads == other.leads


def test_a_scene_without_surroundings_has_the_arrays_that_it_had():
    plain, around = (
        {each.name for each in variables(DatasetPlan(scene.parts, 10, 1, 1e-3))}
        for scene in (ROD, EARTH)
    )
    assert around - plain == {"touch_finger", "drawn_body", "drawn_rim"}
    assert parse_scene(scene_text(FINGERS), "kept") == FINGERS
    assert not any(word in scene_text(ROD) for word in ("finger", "without_press", "rim ="))


WRONG = {
    "no earth": (ROD, {"dataset.press.finger": 5e-12}, "needs the table [surroundings]"),
    "no earth for a body": (ROD, {"dataset.session.body": 2.0}, "`dataset.session.body` needs"),
    "no body": (
        EARTH.with_({"surroundings.body": None}),
        {"dataset.session.body": 2.0},
        "needs a `surroundings.body`",
    ),
    "walls of touches beside pixels": (
        WALLED,
        MISSED,
        "next to pixels cannot take `surroundings.edges`: it is for touches of whole pixels",
    ),
    "walls of touches anywhere": (WALLED, ANYWHERE, "next to pixels cannot take"),
    "no rim": (
        EARTH.with_({"surroundings.rim": False}),
        {"dataset.session.rim": 2.0},
        "needs `surroundings.rim`",
    ),
    "nothing to touch with": (EARTH, {"dataset.press.without_press": 0.5}, "needs fingers"),
    "a body in front": (
        EARTH.with_({"surroundings.cover": None, "surroundings.body.side": "top"}),
        {"dataset.press.finger": 5e-12},
        "cannot touch the top sheet",
    ),
    "a negative finger": (EARTH, {"dataset.press.finger": -1e-12}, "dataset.press.finger"),
    "from high to low": (
        EARTH,
        {"dataset.press.finger": {"low": 2e-12, "high": 1e-12}},
        "low must be <= high",
    ),
    "a finger of 1 F": (EARTH, {"dataset.press.finger": 1.0}, "from 0 to 1e-9 F in every draw"),
}


@pytest.mark.parametrize("name", WRONG)
def test_draws_of_missing_parts_are_refused(name):
    scene, changes, told = WRONG[name]
    with pytest.raises(InputError) as error:
        DatasetPlan(scene.with_(changes).parts, 10, 1, 1e-3)
    assert told in str(error.value) and "\n" not in str(error.value)
