"""What touches besides pressing: the capacitance of a finger, by its patch, cover and text."""

import numpy as np
import pytest
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.finger import PERSON, finger_capacitance, touched_area
from rcskin.simulator.press.press import (
    Press,
    every_press,
    label_of,
    parse_press,
    pixel_pressed,
    press_on,
)
from rcskin.simulator.press.touch import Disc, Indentation, Rectangle, Touch
from rcskin.simulator.scene.foam import VACUUM_PERMITTIVITY
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import InputError
from rcskin.tests.refusals import refusal_of

COVER = {"thickness": 1e-3, "relative_permittivity": 3.0}
PIXEL = 0.02**2 * VACUUM_PERMITTIVITY * 3.0 / 1e-3
"""F: of a finger as large as a pixel of `fingered` on its cover."""


@pytest.fixture
def fingered(make_scene):
    """A function that builds a scene with a cover; changes by key."""

    def build(**changes):
        scene = make_scene(rows=2, columns=3, length=0.06, width=0.04)
        return scene.with_({"surroundings.cover": COVER, **changes})

    return build


def only(scene, text):
    (touch,) = press_on(scene.parts.skin, scene.press, text).touches
    return touch


@pytest.mark.parametrize(
    ("text", "finger"),
    [
        ("1,2", 0.0),
        ("1,2:2", 0.0),
        ("1,2:rod", 0.0),
        ("1,2:finger", PIXEL),
        ("1,2:3:finger", PIXEL),
        ("1,2:touch", PIXEL),
        ("1,2:touch:2pF", 2e-12),
        ("1,2:5.3pF", 5.3e-12),
        ("1,2:5.3 pF", 5.3e-12),
        ("1,2:2:5.3e-12F", 5.3e-12),
        ("1,2:0.0053nF", 5.3e-12),
        ("disc(0.02,0.02,0.01):finger", PIXEL * np.pi / 4),
        ("rect(0.02,0.02,0.01,0.02):touch", PIXEL / 2),
        ("poly(0,0,0.02,0,0,0.02):touch", PIXEL / 2),
    ],
)
def test_a_finger_is_a_plate_on_the_cover(fingered, text, finger):
    touch = only(fingered(), text)
    assert touch.finger == pytest.approx(finger, rel=1e-12)
    assert touch.factor == (3.0 if ":3" in text else 1.0 if "touch" in text else 2.0)


@pytest.mark.parametrize(
    ("of_scene", "text", "finger"),
    [
        ("earthed", "1,2", PIXEL),
        ("floating", "1,2", PIXEL * PERSON / (PIXEL + PERSON)),
        (4e-12, "1,2", 4e-12),
        (4e-12, "1,2:touch", 4e-12),
        ("floating", "1,2:touch", PIXEL * PERSON / (PIXEL + PERSON)),
        ("floating", "1,2:finger", PIXEL),
        ("earthed", "1,2:rod", 0.0),
        (0.0, "1,2", 0.0),
    ],
)
def test_touches_that_do_not_say_are_by_the_finger_of_the_scene(fingered, of_scene, text, finger):
    scene = fingered(**{"press.finger": of_scene})
    assert only(scene, text).finger == pytest.approx(finger, rel=1e-12)


def test_air_is_in_series_with_the_cover(fingered):
    pixel = Touch(1, 1, 1.0)
    apart = [
        finger_capacitance(fingered(**{"surroundings.air": a}).parts.skin, pixel, "earthed")
        for a in (0.0, 1e-3, 3e-3)
    ]
    assert np.diff(1 / np.array(apart)) == pytest.approx(
        np.array([1e-3, 2e-3]) / VACUUM_PERMITTIVITY / 0.02**2
    )


def test_every_pixel_is_pressed_by_the_finger_of_the_scene(fingered):
    scene = fingered(**{"press.finger": "earthed"})
    rest, *others = every_press(scene.parts.skin, scene.press)
    assert (rest, len(others)) == (Press(), 6)
    assert {touch.finger for press in others for touch in press.touches} == {PIXEL}
    assert pixel_pressed(scene.parts.skin, scene.press, 1, 2, 3.0) == Touch(1, 2, 3.0, PIXEL)


def test_the_text_of_a_press_carries_the_capacitance(fingered):
    scene = fingered()
    pressed = press_on(
        scene.parts.skin,
        scene.press,
        "2,3:touch:5.3pF+1,1:3+1,2:finger+disc(0.02,0.02,0.01):1pF",
    )
    assert str(pressed) == (
        f"1,1:3.0+1,2:2.0:{PIXEL!r}F+2,3:1.0:5.3e-12F+disc(0.02,0.02,0.01):2.0:1e-12F"
    )
    assert parse_press(str(pressed), 7.0) == pressed


def test_a_finger_may_press_to_a_depth(fingered):
    foam = {
        "thickness": 4e-3,
        "mechanics": {"porosity": 0.67, "solid_permittivity": 2.8, "modulus": 1e5},
    }
    touch = only(fingered(**{"skin.foam": foam}), "1,2:1mm:5pF")
    assert isinstance(touch, Indentation)
    assert (touch.finger, touch.place.finger, str(touch)) == (5e-12, 0.0, "1,2:0.001m:5e-12F")


def test_only_the_part_of_a_patch_that_has_skin_counts():
    """A quarter of a disc of 60 mm lies in each of four pixels, and all of it in the rectangle."""
    disc = load_scene("sheet-3x3").with_(
        {
            "skin.outline": {"circle": [0.06, 0.06, 0.05]},
            "pixels": 2,
            "contact": [
                {"name": "top-left", "electrode": "top", "edge": "outline", "span": [0.4, 0.6]},
                {
                    "name": "bottom-left",
                    "electrode": "bottom",
                    "edge": "outline",
                    "span": [0.4, 0.6],
                },
            ],
        }
    )
    quarter = np.pi * 0.05**2 / 4
    assert touched_area(disc.parts.skin, Touch(1, 1, 1.0)) == pytest.approx(quarter, rel=1e-3)
    assert touched_area(disc.parts.skin, Rectangle(0.06, 0.06, 0.12, 0.12, 1.0)) == pytest.approx(
        4 * quarter, rel=1e-3
    )
    assert touched_area(disc.parts.skin, Disc(0.06, 0.06, 0.02, 1.0)) == pytest.approx(
        np.pi * 0.02**2, rel=1e-3
    )


def test_a_patch_is_stretched_with_the_skin(fingered):
    scene = fingered(**{"skin.stretch": {"x": 1.5, "y": 0.9}})
    assert only(scene, "1,2:finger").finger == pytest.approx(1.35 * PIXEL)


@pytest.mark.parametrize(
    ("changes", "text", "why"),
    [
        ({}, "2,3:touch", "needs the table [surroundings]"),
        ({}, "2,3:finger", "needs the table [surroundings]"),
        ({}, "2,3:5pF", "needs the table [surroundings]"),
        ({"surroundings": {}}, "2,3:touch", "needs surroundings.cover or surroundings.air"),
        (
            {"surroundings.body": {"side": "top", "distance": 5e-3}},
            "2,3:5pF",
            "cannot touch the top sheet, which has surroundings.body in front of it",
        ),
    ],
)
def test_a_finger_that_a_scene_does_not_have_is_reported_in_one_line(changes, text, why):
    scene = load_scene("sheet-5x5").with_(changes)
    assert why in refusal_of(press_on, scene.parts.skin, scene.press, text)


def test_no_solver_leaves_a_finger_out_without_a_word():
    scene, pressed = load_scene("sheet-3x3"), Press((Touch(1, 1, 2.0, 5e-12),))
    for model in ("auto", "sheet", "reduced", "line", "lumped"):
        with pytest.raises(InputError, match="needs the table"):
            Solver(scene.parts, 1e-2, model).solve(pressed)


@pytest.mark.parametrize("text", ["2,3:2.0:rod", "2,3:2.0", "2,3:touch", "2,3", "2,3:rod+1,1:5pF"])
def test_a_label_of_a_sweep_names_the_press_that_was_made(fingered, text):
    """Also a rod's, where the scene's own touches are fingers."""
    scene = fingered(press={"finger": "earthed"})
    press = press_on(scene.parts.skin, scene.press, text)
    assert (
        press_on(scene.parts.skin, scene.press, label_of(press, scene.parts.skin, scene.press))
        == press
    )
    made = fingered()
    assert (
        label_of(
            press_on(fingered().parts.skin, fingered().press, "2,3:2.0"),
            made.parts.skin,
            made.press,
        )
        == "2,3:2.0"
    )
