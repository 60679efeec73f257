"""Triangles halved towards corners as often as their parts of an error ask for, labels kept."""

from dataclasses import replace

import numpy as np
import pytest
from rcskin.simulator.mesh.corner_exponents import SheetAtCorners, corner_exponents
from rcskin.simulator.mesh.refinement import fewest, graded
from rcskin.simulator.mesh.skin_mesh import domain
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.scene.scene_files import load_scene

CORNER = (0.05, 0.05)
ORDER = 3


@pytest.fixture(scope="module")
def mesh(tools):
    return domain(
        load_scene(tools.SCENES / "l-shape.toml").parts.skin, Press(), 0.05, between=False
    )


def singular(mesh, *names, films=()):
    """Places that are no smooth ones, with their exponents."""
    found = corner_exponents(mesh, [SheetAtCorners(names, films)])
    return {
        tuple(np.round(mesh.p[:, k], 6).tolist()): found[k]
        for k in np.flatnonzero(np.isfinite(found))
    }


def parts_at(mesh, place):
    """All of an error in the triangles at a place."""
    point = np.linalg.norm(mesh.p - np.array(place)[:, None], axis=0).argmin()
    there = (mesh.t == point).any(axis=0)
    return there, (there / there.sum())[None]


def test_where_an_angle_turns_in_the_field_is_singular(mesh):
    assert singular(mesh, "top-end") == {CORNER: pytest.approx(2 / 3)}


def test_where_a_foil_ends_within_an_edge_the_field_is_singular(make_scene):
    scene = make_scene({"top-left": {"span": (0.0, 0.7)}, "bottom-bottom": {}})
    mesh = domain(scene.parts.skin, Press(), 0.05)
    assert singular(mesh, "top-left") == {(0.0, 0.056): pytest.approx(0.5)}
    found = corner_exponents(
        mesh, [SheetAtCorners(["top-left"]), SheetAtCorners(["bottom-bottom"])]
    )
    assert np.isfinite(found).sum() == 1


def test_circles_have_no_corners(tools):
    mesh = domain(load_scene(tools.SCENES / "disc-with-hole.toml").parts.skin, Press(), 0.02)
    assert singular(mesh, "hole") == {}
    ends = singular(mesh, "rim")
    assert sorted(ends) == [pytest.approx((0.0, 0.05)), pytest.approx((0.05, 0.1))]
    assert list(ends.values()) == [pytest.approx(0.5, rel=1e-6)] * 2


def test_towards_a_corner_triangles_are_halved_by_its_exponent(mesh, tools):
    exponents = corner_exponents(mesh, [SheetAtCorners(["top-end"])])
    there, parts = parts_at(mesh, CORNER)
    levels = 3
    found, _ = graded(mesh, parts, 1.01 * 4 ** (-2 / 3 * levels), ORDER, exponents)
    at_corner, _ = parts_at(found, CORNER)
    halved = np.log2(mesh.areas[there].max() / found.areas[at_corner].max()) / 2
    assert levels <= halved < levels + 1
    assert tools.euler(found) == 1
    kept = [found.areas[found.pixel == k].sum() for k in np.unique(mesh.pixel)]
    assert kept == pytest.approx([mesh.areas[mesh.pixel == k].sum() for k in np.unique(mesh.pixel)])
    for name, lines in mesh.foils.items():
        same = tools.lengths(mesh, lines).sum()
        assert tools.lengths(found, found.foils[name]).sum() == pytest.approx(same)


def test_a_smooth_part_is_halved_once_where_once_is_enough(mesh):
    _, parts = parts_at(mesh, CORNER)
    smooth = np.full(mesh.p.shape[1], np.inf)
    found, _ = graded(mesh, parts, 1.01 * 4.0**-ORDER, ORDER, smooth)
    at_corner, _ = parts_at(found, CORNER)
    before, _ = parts_at(mesh, CORNER)
    assert found.areas[at_corner].min() == pytest.approx(mesh.areas[before].min() / 4)


def test_every_error_is_reduced(mesh):
    exponents = corner_exponents(mesh, [SheetAtCorners(["top-end"])])
    _, corner = parts_at(mesh, CORNER)
    far, other = parts_at(mesh, (0.0, 0.0))
    found, _ = graded(mesh, np.concatenate([corner, other]), 0.1, ORDER, exponents)
    there, _ = parts_at(found, (0.0, 0.0))
    assert found.areas[there].max() < mesh.areas[far].max()
    within, _ = graded(mesh, np.concatenate([corner, 0.05 * other]), 0.1, ORDER, exponents)
    alone, _ = graded(mesh, corner, 0.1, ORDER, exponents)
    assert np.array_equal(within.t, alone.t) and alone.t.shape[1] < found.t.shape[1]


def test_what_is_enough_stays_as_it_is(mesh):
    _, parts = parts_at(mesh, CORNER)
    assert graded(mesh, parts, 1.0, ORDER, np.empty(0))[0] is mesh


def test_the_fewest_triangles_hold_the_target():
    parts = np.array([0.1, 0.4, 0.2, 0.3])
    assert fewest(parts, 0.65).tolist() == [1, 3]
    assert fewest(parts, 0.0).tolist() == [1]


def test_without_lines_between_pixels_meshes_follow_those_that_are_pressed(tools):
    scene = load_scene(tools.SCENES / "l-shape.toml")
    whole = domain(scene.parts.skin, parse_press("1,2", 2.0), 0.05)
    assert domain(scene.parts.skin, parse_press("2,1", 2.0), 0.05) is whole
    bare = domain(scene.parts.skin, parse_press("1,2", 2.0), 0.05, between=False)
    assert bare.t.shape[1] < whole.t.shape[1]
    assert bare.areas[bare.pixel == 1].sum() == pytest.approx(0.04**2, rel=1e-9)
    for side in (((0.04, 0.0), (0.04, 0.04)), ((0.04, 0.04), (0.08, 0.04))):
        assert tools.length_along(bare, side) == pytest.approx(0.04, rel=1e-9)
    assert tools.length_along(bare, ((0.0, 0.08), (0.04, 0.08))) < 0.04


def test_files_are_cut_along_pressed_pixels_alone(tools, tmp_path):
    scene = tools.on_mesh(tools.write_l(tmp_path / "l.msh"))
    press = parse_press("1,2", 2.0)
    whole, bare = (domain(scene.parts.skin, press, 0.05, between=each) for each in (True, False))
    assert bare.t.shape[1] < whole.t.shape[1]
    assert bare.areas[bare.pixel == 1].sum() == pytest.approx(0.04**2, rel=1e-9)
    assert replace(bare, pixel=whole.pixel).areas.sum() == pytest.approx(tools.L_AREA, rel=1e-9)
