"""Skins and presses that cannot be: one line for each, naming what is wrong."""

import numpy as np
import pytest
import tomli_w
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import press_on
from rcskin.simulator.scene.scene_files import load_scene, parse_scene
from rcskin.simulator.sweeps import InputError

SHEETS = ("top", "bottom")
SQUARE = [[0, 0], [0.12, 0], [0.12, 0.12], [0, 0.12]]


def outlined(*holes, span=(0.0, 1.0)):
    """TOML of a square with holes, fed along part of one side."""
    table = {
        "name": "odd",
        "skin": {
            "length": 0.12,
            "width": 0.12,
            "outline": {"points": SQUARE, "holes": list(holes)},
            "foam": {"capacitance_per_area": 4.861e-9},
            **dict.fromkeys(SHEETS, {"sheet_resistance": 50e3}),
        },
        "contact": [
            {"name": name, "electrode": name, "edge": "outline.4", "span": list(span)}
            for name in SHEETS
        ],
        "interface": [{"name": "meter", "high": ["top"], "low": ["bottom"]}],
        "pixels": {"rows": 3, "columns": 3},
        "sweep": {"frequencies": [1e3]},
    }
    return tomli_w.dumps(table)


def circle(x, y, radius):
    return {"circle": [x, y, radius]}


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"span": (0.0, 1.3)}, "must be <= 1.0, got 1.3"),
        ({"holes": [circle(0.02, 0.06, 0.02)]}, "must lie inside the outline"),
        ({"holes": [circle(0.5, 0.06, 0.01)]}, "must lie within x = 0..0.12 m, got 0.49..0.51"),
        ({"holes": [circle(0.05, 0.06, 0.02), circle(0.07, 0.06, 0.02)]}, "must lie at least"),
        ({"holes": [circle(0.06, 0.06, 0.03), circle(0.06, 0.06, 0.01)]}, "must lie at least"),
    ],
)
def test_outlines_and_foils_that_cannot_be(given, message):
    text = outlined(*given.get("holes", ()), span=given.get("span", (0.0, 1.0)))
    with pytest.raises(InputError, match=message) as told:
        parse_scene(text, "odd.toml")
    assert "\n" not in str(told.value)


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ("1,nan\n2,1\n", "got 'nan'"),
        ("1,0\n2,1\n", "got '0'"),
        ("1,2\n3\n", "equally many numbers"),
    ],
)
def test_map_files_that_say_no_factors(tmp_path, lines, message):
    (tmp_path / "map.csv").write_text(lines, encoding="utf-8")
    text = 'foam = {{capacitance_per_area = 4.9e-9, map = {{kind = "file", path = "{}"}}}}'
    scene = f'name = "odd"\n[skin]\n{text.format(tmp_path / "map.csv")}\n'
    with pytest.raises(InputError, match=message):
        parse_scene(scene, "odd.toml", tmp_path)


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
    press = press_on(scene, "disc(0.112,0.112,0.004):1mm")
    for model in ("auto", "reduced"):
        with pytest.raises(InputError, match=r"press disc\(0.112,0.112,0.004\): must touch"):
            Solver(scene, 1e-2, model).solve(press)


def test_a_depth_beyond_the_foam_is_refused_before_any_training():
    scene = load_scene("foam")
    with pytest.raises(InputError, match="where foam of 0.004 m is compressed by 0.669"):
        Solver(scene, 1e-3, "reduced").solve(press_on(scene, "2,2:5mm"))


def test_a_map_of_one_column_varies_along_the_other_side():
    scene, rows = load_scene("sheet-3x3"), [1.0, 2.0, 3.0]
    grids = ([[each] * columns for each in rows] for columns in (1, 3))
    mapped = [
        scene.with_({"skin.foam.map": {"kind": "grid", "values": values}}) for values in grids
    ]
    Z = [Solver(each, 1e-5).solve(press_on(each, "none")).Z for each in mapped]
    np.testing.assert_allclose(*Z, rtol=2e-5)
