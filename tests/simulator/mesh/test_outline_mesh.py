"""Skins by outline: what their meshes conform to, and how triangles and facets are labelled."""

import sys

import numpy as np
import pytest
from rcskin.simulator.mesh import skin_mesh
from rcskin.simulator.mesh.drawing import shape_of, sharp_touches
from rcskin.simulator.mesh.skin_mesh import domain
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.press.touch import Disc, Polygon, Rectangle, Touch
from rcskin.simulator.scene.planar import Circle, sides
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import InputError

REST = Press()
TOUCHED = Press(
    (
        Touch(1, 1, 2.0),
        Rectangle(0.045, 0.03, 0.02, 0.03, 2.0),
        Disc(0.02, 0.08, 0.01, 3.0),
        Polygon(((0.03, 0.01), (0.09, 0.02), (0.07, 0.045)), 1.5),
    )
)


def test_a_rectangle_without_outline(make_scene, tools):
    scene = make_scene({"top-left": {"span": (0.2, 0.7)}, "bottom-bottom": {}}, rows=2, columns=5)
    mesh = domain(scene.parts.skin, REST, 0.05)
    assert mesh.areas.sum() == pytest.approx(0.1 * 0.08, rel=1e-13)
    assert np.bincount(mesh.pixel, mesh.areas) == pytest.approx([0.1 * 0.08 / 10] * 10, rel=1e-12)
    for line in (0.02, 0.04, 0.06, 0.08):
        segment = ((line, 0.0), (line, 0.08))
        assert tools.length_along(mesh, segment) == pytest.approx(0.08, rel=1e-12)
    left, bottom = (mesh.p[:, mesh.foils[name]] for name in ("top-left", "bottom-bottom"))
    assert (left[0] == 0).all()
    assert (left[1].min(), left[1].max()) == pytest.approx((0.016, 0.056), rel=1e-12)
    assert (bottom[1] == 0).all()
    assert tools.euler(mesh) == 1


@pytest.mark.parametrize(
    ("edge", "ends"),
    [
        ("left", [(0, 0.02), (0, 0.06)]),
        ("right", [(0.1, 0.02), (0.1, 0.06)]),
        ("bottom", [(0.025, 0), (0.075, 0)]),
        ("top", [(0.025, 0.08), (0.075, 0.08)]),
    ],
)
def test_spans_on_a_rectangle_run_from_the_low_coordinate(make_scene, edge, ends):
    scene = make_scene({f"top-{edge}": {"span": (0.25, 0.75)}, "bottom-left": {}})
    mesh = domain(scene.parts.skin, REST, 0.03)
    foil = mesh.p[:, mesh.foils[f"top-{edge}"]].reshape(2, -1)
    assert foil.min(axis=1) == pytest.approx(np.min(ends, axis=0), abs=1e-15)
    assert foil.max(axis=1) == pytest.approx(np.max(ends, axis=0), abs=1e-15)


def test_an_l_its_pixels_and_touches(tools):
    scene = load_scene(tools.SCENES / "l-shape.toml")
    mesh = domain(scene.parts.skin, TOUCHED, 0.02)
    assert mesh.areas.sum() == pytest.approx(tools.L_AREA, rel=1e-13)
    assert tools.euler(mesh) == 1
    expected = {0: 0.0016, 1: 0.0016, 2: 0.0016, 3: 0.0016, 4: 0.0016 - 0.03**2, 5: 0.0004}
    found = np.bincount(mesh.pixel, mesh.areas, minlength=9)
    assert [found[pixel] for pixel in expected] == pytest.approx(list(expected.values()), rel=1e-9)
    assert found[8] == 0  # the corner that is cut out
    rectangle, disc, polygon = (mesh.areas[covered].sum() for covered in mesh.covered)
    assert rectangle == pytest.approx(0.02 * 0.03, rel=1e-9)
    assert disc == pytest.approx(np.pi * 0.01**2, rel=1e-9)
    assert polygon == pytest.approx((0.06 * 0.035 - 0.04 * 0.01) / 2, rel=1e-9)
    shapes = [shape_of(scene.parts.skin, touch) for touch in sharp_touches(TOUCHED)]
    for shape in [each for each in shapes if not isinstance(each, Circle)]:
        for side in sides(shape):
            whole = np.linalg.norm(side[1] - side[0])
            assert tools.length_along(mesh, side) == pytest.approx(whole, rel=1e-6)


def test_triangles_reach_their_order(tools):
    mesh = domain(load_scene(tools.SCENES / "l-shape.toml").parts.skin, TOUCHED, 0.02)
    assert (np.diff(mesh.t, axis=0) > 0).all()
    for lines in mesh.foils.values():
        assert (lines[0] < lines[1]).all()
        _, count = tools.edges(mesh.t)
        rim = tools.edges(mesh.t)[0][:, count == 1]
        assert len(np.unique(np.hstack([rim, lines]), axis=1).T) == rim.shape[1]


def test_a_disc_with_a_hole_has_their_areas_and_circumferences(tools):
    mesh = domain(load_scene(tools.SCENES / "disc-with-hole.toml").parts.skin, REST, 0.02)
    assert mesh.areas.sum() == pytest.approx(np.pi * (0.05**2 - 0.01**2), rel=1e-12)
    rim, hole = (tools.lengths(mesh, mesh.foils[name]).sum() for name in ("rim", "hole"))
    assert rim == pytest.approx(2 * np.pi * 0.05 / 4, rel=1e-12)
    assert hole == pytest.approx(2 * np.pi * 0.01, rel=1e-12)
    assert tools.euler(mesh) == 0
    quarter = mesh.p[:, mesh.foils["rim"]]
    assert quarter[0].max() <= 0.05 + 1e-9 and quarter[1].min() >= 0.05 - 1e-9


def test_sides_and_holes_are_named_in_the_order_given(tools):
    mesh = domain(load_scene(tools.SCENES / "plate-with-slot.toml").parts.skin, REST, 0.03)
    left, slot = (mesh.p[:, mesh.foils[name]] for name in ("top-left", "bottom-slot"))
    assert (left[0] == 0).all()
    assert (left[1].min(), left[1].max()) == pytest.approx((0.016, 0.064), rel=1e-9)
    assert (slot[1] == 0.038).all()
    assert (slot[0].min(), slot[0].max()) == pytest.approx((0.02, 0.08), rel=1e-9)
    assert tools.euler(mesh) == -1


def test_a_touch_covers_what_is_there_of_the_skin(tools):
    square = {"points": [(0.01, 0.01), (0.03, 0.01), (0.03, 0.03), (0.01, 0.03)]}
    outline = {"points": [(0, 0), (0.06, 0), (0.06, 0.06), (0, 0.06)], "holes": [square]}
    foils = [{"name": each, "electrode": each, "edge": "outline"} for each in ("top", "bottom")]
    scene = tools.altered(
        "l-shape",
        {"outline": outline, "length": 0.06, "width": 0.06},
        contact=foils,
        interface=[{"name": "through", "high": ["top"], "low": ["bottom"]}],
    )
    in_hole, around = (
        domain(scene.parts.skin, parse_press(f"disc(0.02,0.02,{radius})", 2.0), 0.02)
        for radius in (0.005, 0.018)
    )
    assert not in_hole.covered.any()
    expected = np.pi * 0.018**2 - 0.02**2
    assert around.areas[around.covered[0]].sum() == pytest.approx(expected, rel=1e-9)


def test_creases_are_conformed_to(make_scene, tools):
    angle = np.linspace(0, np.pi, 9)
    crease = np.stack([0.05 + 0.02 * np.cos(angle), 0.03 + 0.02 * np.sin(angle)], axis=1)
    mesh = domain(make_scene().parts.skin, REST, 0.05, [crease])
    for side in np.stack([crease[:-1], crease[1:]], axis=1):
        whole = np.linalg.norm(side[1] - side[0])
        assert tools.length_along(mesh, side) == pytest.approx(whole, rel=1e-9)


@pytest.mark.parametrize("size", [0.03, 0.01, 0.004])
def test_edges_are_no_longer_than_requested(make_scene, size):
    mesh = domain(make_scene().parts.skin, REST, size)
    assert mesh.lengths.max() < 1.7 * size
    assert np.median(mesh.lengths) > 0.5 * size


def test_narrow_places_are_resolved_and_stay_well_shaped(make_scene, tools):
    press = Press((Rectangle(0.05, 0.04, 0.0999, 0.02, 2.0), Disc(0.05, 0.065, 1e-5, 2.0)))
    mesh = domain(make_scene().parts.skin, press, 0.03)
    assert tools.least_angle(mesh) > 5
    assert mesh.t.shape[1] < 20_000
    assert mesh.areas[mesh.covered[1]].sum() == pytest.approx(np.pi * 1e-10, rel=1e-6)


def test_lines_that_nearly_coincide_are_one(make_scene, tools):
    scene = make_scene(columns=5)
    press = Press((Rectangle(0.05 + 1e-12, 0.04, 0.02, 0.02, 2.0),))
    mesh = domain(scene.parts.skin, press, 0.03)
    assert tools.least_angle(mesh) > 20


def test_meshes_are_the_same_each_time(tools):
    scene = load_scene(tools.SCENES / "l-shape.toml")
    first = domain(scene.parts.skin, TOUCHED, 0.02)
    assert domain(scene.parts.skin, TOUCHED, 0.02) is first
    skin_mesh._drawn.cache_clear()
    second = domain(scene.parts.skin, TOUCHED, 0.02)
    assert second is not first
    for name in ("p", "t", "pixel", "covered"):
        assert np.array_equal(getattr(first, name), getattr(second, name))


def test_meshing_is_silent(make_scene, capfd):
    skin_mesh._drawn.cache_clear()
    domain(make_scene().parts.skin, TOUCHED, 0.03)
    assert capfd.readouterr() == ("", "")


def test_a_missing_library_is_reported(make_scene, monkeypatch):
    monkeypatch.setitem(sys.modules, "pythoncdt", None)
    skin_mesh._drawn.cache_clear()
    with pytest.raises(InputError, match=r"meshed by pythoncdt.*pip install 'rcskin\[mesh\]'"):
        domain(make_scene().parts.skin, REST, 0.03)
