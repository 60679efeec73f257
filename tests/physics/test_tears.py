"""Tears of a strip against closed forms: a cut ends the line, a slit along it narrows it."""

import numpy as np
import pytest
from rcskin.simulator.describe.facts import key_facts
from rcskin.simulator.measure.symmetry import representative
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import InputError

WIDTH = 1e-4
STRIP = load_scene("strip-1x5").with_({"sweep.frequencies": [700.0, 18e3]})


def torn(scene, *sheets, **tear):
    table = {"kind": "tear", "width": WIDTH, **tear}
    return scene.with_({f"skin.{sheet}.map": table for sheet in sheets})


def Z(scene, rtol=1e-3):
    return Solver(scene.parts, rtol).solve(Press()).Z[0]


@pytest.mark.parametrize("sheets", [("top",), ("top", "bottom")])
def test_a_cut_across_a_strip_ends_it_there(sheets):
    cut = torn(STRIP, *sheets, edge="bottom", at=0.5, length=1.0)
    length = STRIP.skin.length / 2 - WIDTH / 2
    line = STRIP.with_({"skin.length": length, "pixels.columns": 1})
    np.testing.assert_allclose(Z(cut), Z(line), rtol=1e-3)


def test_a_slit_along_the_current_takes_its_width_alone():
    slit = torn(STRIP, "top", "bottom", edge="right", at=0.5, length=1.0)
    np.testing.assert_allclose(Z(slit), Z(STRIP) / (1 - WIDTH / STRIP.skin.width), rtol=1e-3)


def test_a_longer_tear_hinders_the_current_more():
    lengths = [0.3, 0.6]
    found = [Z(torn(STRIP, "top", edge="bottom", at=0.2, length=each)) for each in lengths]
    resistance = [Z(STRIP).real[0], *(each.real[0] for each in found)]
    assert np.all(np.diff(resistance) > 0)


def test_a_tear_breaks_a_symmetry_that_a_coarse_grid_of_points_would_miss():
    sheet = load_scene("sheet-3x3")
    assert representative(sheet.parts.skin, sheet.parts.setup, sheet.press)(
        (3, 2)
    ) == representative(sheet.parts.skin, sheet.parts.setup, sheet.press)((1, 2))
    below = torn(sheet, "top", edge="left", at=0.2, length=0.5)
    assert representative(below.parts.skin, below.parts.setup, below.press)(
        (3, 2)
    ) != representative(below.parts.skin, below.parts.setup, below.press)((1, 2))
    middle = torn(sheet, "top", edge="left", at=0.5, length=0.5)
    assert representative(middle.parts.skin, middle.parts.setup, middle.press)(
        (3, 2)
    ) == representative(middle.parts.skin, middle.parts.setup, middle.press)((1, 2))


def test_a_scene_describes_its_tear():
    text = str(list(key_facts(torn(STRIP, "top", edge="bottom", at=0.5, length=0.25).parts)))
    assert "torn from the bottom edge over 25 % of the skin" in text


REFUSED = {
    "no skin": ({"edge": "left", "at": 1e-4, "length": 0.5}, "`top.map` at must be from 0.005"),
    "too long": ({"edge": "left", "at": 0.5, "length": 1.5}, "length"),
    "no edge": ({"edge": "outline", "at": 0.5, "length": 0.5}, "edge"),
}


@pytest.mark.parametrize("tear, why", REFUSED.values(), ids=REFUSED)
def test_a_tear_beside_the_skin_is_refused(tear, why):
    with pytest.raises(InputError, match=why):
        torn(STRIP, "top", **tear)


def test_foam_has_no_tears():
    with pytest.raises(InputError, match="whose kind is one of constant, gradient, random, grid"):
        STRIP.with_({"skin.foam.map": {"kind": "tear", "edge": "left", "at": 0.5, "length": 0.5}})
