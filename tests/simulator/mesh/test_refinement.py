"""Refinement keeps regions, labels and foils, meets edge to edge, and leaves angles bounded."""

from dataclasses import replace

import numpy as np
import pytest
from rcskin.simulator.mesh.arcs import NO_ARCS
from rcskin.simulator.mesh.refinement import refined
from rcskin.simulator.mesh.skin_mesh import domain
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.planar import inside
from rcskin.simulator.scene.scene_files import load_scene

PRESS = "rect(0.045,0.03,0.02,0.03)+disc(0.02,0.08,0.01)"


@pytest.fixture(scope="module")
def mesh(tools):
    return domain(
        load_scene(tools.SCENES / "l-shape.toml").parts.skin, parse_press(PRESS, 2.0), 0.02
    )


def nearest(mesh, x, count):
    """The triangles nearest to x."""
    middle = mesh.p[:, mesh.t].mean(axis=1)
    return np.linalg.norm(middle - np.array(x)[:, None], axis=0).argsort(kind="stable")[:count]


def measures(mesh, tools):
    areas = mesh.areas
    return [
        *np.bincount(mesh.pixel, areas, minlength=9),
        *(areas[covered].sum() for covered in mesh.covered),
        *(tools.lengths(mesh, lines).sum() for lines in mesh.foils.values()),
    ]


def test_towards_a_corner_everything_is_kept(mesh, tools):
    before, angle = measures(mesh, tools), tools.least_angle(mesh)
    for _ in range(40):
        mesh = refined(mesh, nearest(mesh, (0.05, 0.05), 8))
        assert tools.euler(mesh) == 1
        assert (np.diff(mesh.t, axis=0) > 0).all()
    assert measures(mesh, tools) == pytest.approx(before, rel=1e-10)
    assert tools.least_angle(mesh) > 0.5 * angle
    assert mesh.lengths.min() < 1e-7


def test_anywhere_everything_is_kept(mesh, tools):
    random = np.random.default_rng(1)
    before, angle = measures(mesh, tools), tools.least_angle(mesh)
    for _ in range(8):
        mesh = refined(mesh, random.choice(mesh.t.shape[1], 100, replace=False))
    assert tools.euler(mesh) == 1
    assert measures(mesh, tools) == pytest.approx(before, rel=1e-10)
    assert tools.least_angle(mesh) > 0.5 * angle


def test_foils_are_halved_with_their_triangles(mesh, tools):
    finer = refined(mesh, np.arange(mesh.t.shape[1]))
    assert finer.t.shape[1] == 4 * mesh.t.shape[1]
    for name, lines in mesh.foils.items():
        assert finer.foils[name].shape[1] == 2 * lines.shape[1]
        assert (finer.foils[name][0] < finer.foils[name][1]).all()
        rim, count = tools.edges(finer.t)
        every = np.hstack([rim[:, count == 1], finer.foils[name]])
        assert np.unique(every, axis=1).shape[1] == np.count_nonzero(count == 1)


def test_labels_are_those_of_the_triangle_around(mesh):
    finer = refined(mesh, nearest(mesh, (0.03, 0.07), 50))
    middle = finer.middles
    column, row = (middle // 0.04).astype(int)
    assert (finer.pixel == 3 * row + column).all()
    corners = np.array([(0.035, 0.015), (0.055, 0.015), (0.055, 0.045), (0.035, 0.045)])
    assert (finer.covered[0] == inside(corners, middle)).all()


def test_nothing_marked_changes_nothing_but_the_order(mesh):
    same = refined(mesh, [])
    assert np.array_equal(same.p, mesh.p)
    assert np.array_equal(same.t, mesh.t)


def test_a_marked_triangle_is_cut_in_four(mesh):
    finer = refined(mesh, [7])
    inside_it = mesh.p[:, mesh.t[:, 7]].T
    middle = finer.p[:, finer.t].mean(axis=1)
    assert np.count_nonzero(inside(inside_it, middle)) == 4


def test_in_space_as_in_the_plane(mesh, tools):
    """Bent to a cylinder the edges have other lengths, but halves are halves."""
    x, y = mesh.p
    bent = replace(
        mesh, p=np.stack([0.1 * np.sin(x / 0.1), y, 0.1 * np.cos(x / 0.1)]), arcs=NO_ARCS
    )
    total = bent.areas.sum()
    for _ in range(10):
        bent = refined(bent, nearest(bent, (0.05, 0.05, 0.08), 8))
    assert tools.euler(bent) == 1
    assert bent.areas.sum() == pytest.approx(total, rel=1e-12)
