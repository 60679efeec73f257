"""Which pixels have skin in them: those that a mesh of the skin finds triangles in."""

import numpy as np
import pytest
from rcskin.simulator.mesh.skin_mesh import domain
from rcskin.simulator.press.pixels import pixels_with_skin
from rcskin.simulator.press.press import Press, every_press
from rcskin.simulator.scene.scene_files import load_scene

L = [[0, 0], [0.12, 0], [0.12, 0.04], [0.04, 0.04], [0.04, 0.12], [0, 0.12]]
OUTLINES = {
    "along lines of pixels": {"points": L},
    "a disc": {"circle": [0.06, 0.06, 0.06]},
    "a small disc within one pixel": {"circle": [0.06, 0.06, 0.01]},
    "a hole that takes a pixel": {
        "points": [[0, 0], [0.12, 0], [0.12, 0.12], [0, 0.12]],
        "holes": [{"points": [[0.04, 0.04], [0.08, 0.04], [0.08, 0.08], [0.04, 0.08]]}],
    },
    "a round hole around a pixel": {
        "circle": [0.06, 0.06, 0.06],
        "holes": [{"circle": [0.06, 0.06, 0.03]}],
    },
    "a corner that reaches into a pixel": {"points": [[0, 0], [0.12, 0], [0.041, 0.041]]},
}


@pytest.mark.parametrize("outline", OUTLINES.values(), ids=OUTLINES)
def test_pixels_with_skin_are_those_of_a_mesh(outline):
    foils = {f"contact.{number}.edge": "outline" for number in (1, 2)}
    scene = load_scene("sheet-3x3").with_({"skin.outline": outline, **foils})
    found = np.unique(domain(scene.parts.skin, Press(), 0.12).pixel)
    assert pixels_with_skin(scene.parts.skin) == [(n // 3 + 1, n % 3 + 1) for n in found if n >= 0]
    assert [
        press.pixel for press in every_press(scene.parts.skin, scene.press)[1:]
    ] == pixels_with_skin(scene.parts.skin)
