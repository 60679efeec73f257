"""Pixels that mirror each other show the same."""

import numpy as np
import pytest
from rcskin.simulator.measure.symmetry import representative
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press
from rcskin.simulator.press.touch import Touch
from rcskin.simulator.scene.scene_files import load_scene

MERGED = {
    "sheet-5x5": [(4, 2), (4, 5)],
    "sheet-5x5-crossed": [(4, 2)],  # along the diagonal, with the sheets exchanged
    "sheet-5x5-two-interfaces": [],
}


@pytest.mark.parametrize("name", MERGED)
def test_mirrored_pixels_show_the_same(name):
    scene = load_scene(name)
    of = representative(scene.parts.skin, scene.parts.setup, scene.press)
    solver = Solver(scene.parts, rtol=1e-6)
    merged = [(i, j) for i in (1, 4) for j in (2, 5) if of((i, j)) != (i, j)]
    assert merged == MERGED[name]
    for pixel in merged:
        own, other = (solver.solve(Press((Touch(*at, 2.0),))).Z for at in (pixel, of(pixel)))
        np.testing.assert_allclose(own, other, rtol=1e-5)


def test_a_skin_fed_all_around_has_two_mirrors(make_scene):
    edges = ("left", "right", "bottom", "top")
    contacts = {f"{sheet}-{edge}": {} for sheet in ("top", "bottom") for edge in edges}
    interfaces = {
        "meter": [[name for name in contacts if name.startswith(s)] for s in ("top", "b")]
    }
    scene = make_scene(contacts, interfaces, rows=4, columns=3)
    of = representative(
        scene.parts.skin,
        scene.parts.setup,
        scene.press,
    )
    assert {of((i, j)) for i in range(1, 5) for j in range(1, 4)} == {
        (1, 1),
        (1, 2),
        (2, 1),
        (2, 2),
    }


def test_gains_with_low_at_earth_distinguish_both_sheets(make_scene):
    """The node's current into earth passes the series resistor, and only that at the top."""
    body = {"surroundings": {"body": [{"side": s, "distance": 1e-3} for s in ("top", "bottom")]}}
    pairs = {f"{sheet}-{edge}": {} for sheet in ("top", "bottom") for edge in ("left", "right")}
    crossed = {"meter": (["top-left"], ["bottom-right"])}
    scene = make_scene(pairs, crossed, top=3e4, bottom=3e4, columns=2).with_(body)
    gain = {"interface.1.reader": "gain", "interface.1.series_resistance": 1e6}
    assert representative(scene.parts.skin, scene.parts.setup, scene.press)((1, 2)) == (1, 1)
    made = scene.with_(gain)
    assert representative(made.parts.skin, made.parts.setup, made.press)((1, 2)) == (1, 2)
