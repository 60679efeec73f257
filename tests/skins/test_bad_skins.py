"""Skins and presses that cannot be: one line for each, naming what is wrong."""

import numpy as np
import pytest
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import press_on
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import InputError


def test_an_applicator_off_the_skin_is_named_as_it_was_given():
    """Though the membrane takes a polygon for it."""
    scene = load_scene("foam").with_(
        {
            "skin.outline.points": [[0, 0], [0.12, 0], [0.12, 0.06], [0.06, 0.12], [0, 0.12]],
            "contact.top-left.edge": "outline.5",
            "contact.bottom-left.edge": "outline.5",
            "pixels": 3,
            "sweep.frequencies": [1e3],
        }
    )
    press = press_on(scene.parts.skin, scene.press, "disc(0.112,0.112,0.004):1mm")
    for model in ("auto", "reduced"):
        with pytest.raises(InputError, match=r"press disc\(0.112,0.112,0.004\): must touch"):
            Solver(scene.parts, 1e-2, model).solve(press)


def test_a_depth_beyond_the_foam_is_refused_before_any_training():
    scene = load_scene("foam")
    with pytest.raises(InputError, match="where foam of 0.004 m is compressed by 0.669"):
        Solver(scene.parts, 1e-3, "reduced").solve(
            press_on(scene.parts.skin, scene.press, "2,2:5mm")
        )


def test_a_map_of_one_column_varies_along_the_other_side():
    scene, rows = load_scene("sheet-3x3"), [1.0, 2.0, 3.0]
    grids = ([[each] * columns for each in rows] for columns in (1, 3))
    mapped = [
        scene.with_({"skin.foam.map": {"kind": "grid", "values": values}}) for values in grids
    ]
    Z = [
        Solver(each.parts, 1e-5).solve(press_on(each.parts.skin, each.press, "none")).Z
        for each in mapped
    ]
    np.testing.assert_allclose(*Z, rtol=2e-5)
