"""Triangles with arcs for edges: on the circle exactly, whatever a circle meets or nearly meets."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.mesh.arcs import arc_length, mapped, on_arcs
from rcskin.simulator.mesh.arrangement import WIDEST, chords
from rcskin.simulator.mesh.refinement import finer
from rcskin.simulator.mesh.skin_mesh import domain
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.press.touch import Disc
from rcskin.simulator.scene.planar import Circle, area
from skfem.quadrature import get_quadrature
from skfem.refdom import RefTri

LENGTH, WIDTH = 0.1, 0.08
POINTS, WEIGHTS = get_quadrature(RefTri, 14)


def covered_areas(mesh):
    """Areas of the touches and of the mesh, by quadrature over upright bent triangles."""
    _, along, across = mapped(mesh.p, mesh.t, mesh.curvature, POINTS)
    signed = along[0] * across[1] - along[1] * across[0]
    assert (np.sign(signed) == np.sign(signed[:, :1])).all()
    own = np.abs(signed) @ WEIGHTS
    np.testing.assert_allclose(own, mesh.areas, rtol=1e-9, atol=1e-15 * own.sum())
    return np.array([own[within].sum() for within in mesh.covered]), own.sum()


def assert_exact(mesh, press):
    of_touches, whole = covered_areas(mesh)
    assert whole == pytest.approx(LENGTH * WIDTH, rel=1e-12)
    assert of_touches == pytest.approx([np.pi * each.radius**2 for each in press.touches], rel=1e-9)


@pytest.mark.parametrize(
    "text",
    [
        "disc(0.05,0.04,0.02)",
        "disc(0.05,0.04,0.04)",  # touches both long edges
        "disc(0.02,0.04,0.02)",  # touches the foil, and lines of pixels
        "disc(0.0200001,0.04,0.02)",  # all but touches it
        "disc(0.0203,0.04,0.02)",
        "disc(0.03,0.03,0.01)+disc(0.03,0.05,0.01)",  # touch each other
        "disc(0.03,0.03,0.01)+disc(0.049,0.03,0.01)",  # overlap by a little
        "disc(0.05,0.04,0.02)+disc(0.05,0.04,0.0199)",
        "disc(0.05,0.04,0.02)+disc(0.06,0.04,0.01)",  # one within the other, touching
        "disc(0.031,0.04,0.0001)",
    ],
)
def test_circles_that_touch_or_nearly_touch_are_exact(make_scene, text):
    scene, press = make_scene(rows=4, columns=5), parse_press(text, 2.0)
    mesh = domain(scene.parts.skin, press, 0.02)
    assert_exact(mesh, press)
    assert mesh.t.shape[1] < 20_000


@given(seed=st.integers(0, 10**6))
def test_circles_anywhere_stay_exact_as_triangles_are_halved(make_scene, seed):
    rng = np.random.default_rng(seed)
    discs = []
    for radius in 0.04 * 10 ** rng.uniform(-1.5, 0, rng.integers(1, 4)):
        x, y = rng.uniform(radius, [LENGTH - radius, WIDTH - radius])
        discs.append(Disc(x, y, radius, 2.0))
    press = Press(tuple(discs))
    mesh = domain(make_scene(rows=4, columns=5).parts.skin, press, 0.02)
    for _ in range(3):
        assert_exact(mesh, press)
        mesh = finer(mesh, rng.choice(mesh.t.shape[1], mesh.t.shape[1] // 5, replace=False))


def test_a_bent_triangle_runs_along_its_arc_and_nowhere_else_off_its_edges():
    circle, angle = Circle(0.3, -0.2, 2.0), np.array([0.3, 0.3 + WIDEST])
    p = np.column_stack([*circle.at(angle), (1.0, 0.5)])
    part = np.linspace(0, 1, 9)
    for curvature in (-0.5, 0.5):
        on_edge = [
            mapped(p, np.arange(3)[:, None], np.array([[curvature], [0], [0]]), points)[0][:, 0]
            for points in (
                np.stack([part, 0 * part]),
                np.stack([1 - part, part]),
                np.stack([0 * part, part]),
            )
        ]
        bulge = np.abs(np.linalg.norm(on_edge[0].T - circle.centre, axis=1) - 2)
        assert bulge.max() < 1e-14 or curvature > 0
        expected = on_arcs(
            *np.repeat(p[:, :2], 9, axis=1).reshape(2, 2, 9).swapaxes(0, 1), curvature, part
        )
        np.testing.assert_allclose(on_edge[0], expected, atol=1e-14)
        for edge, (i, j) in zip(on_edge[1:], ((1, 2), (0, 2)), strict=True):
            straight = p[:, [i]] + part * (p[:, [j]] - p[:, [i]])
            np.testing.assert_allclose(edge, straight, atol=1e-15)


def test_slopes_of_a_bent_triangle_are_those_of_its_places():
    p = np.array([[0.0, 1.0, 0.3], [0.0, 0.2, 0.9]])
    bend, t, h = np.array([[0.4], [-0.7], [0.5]]), np.arange(3)[:, None], 1e-6
    at = np.array([[0.2, 0.5, 0.1], [0.3, 0.1, 0.6]])
    _, *slopes = mapped(p, t, bend, at)
    for axis, slope in enumerate(slopes):
        step = h * np.eye(2)[axis][:, None]
        difference = (mapped(p, t, bend, at + step)[0] - mapped(p, t, bend, at - step)[0]) / (2 * h)
        np.testing.assert_allclose(slope, difference, rtol=1e-8)


def test_arcs_by_their_chords():
    circle, angle = Circle(0.3, -0.2, 2.0), np.array([0.3, 0.7])
    start, stop = circle.at(angle)[:, :, None]
    bend = np.array([-0.5])  # to the right of the way: anticlockwise
    assert on_arcs(start, stop, bend)[:, 0] == pytest.approx(circle.at(np.array(0.5)))
    assert arc_length(np.linalg.norm(stop - start, axis=0), bend) == pytest.approx(2 * 0.4)


def test_a_circle_is_divided_where_lines_and_circles_meet_it():
    circle, other = Circle(0.0, 0.0, 1.0), Circle(1.5, 0.0, 1.0)
    lines = np.array([[(-2.0, 0.6), (2.0, 0.6)], [(0.8, -3.0), (0.8, 3.0)]])
    own, _, _ = chords([circle, other, lines], np.array([[0.0, -1.0]]), 1e-9)
    corners = own.segments[:, 0]
    for x, y in [(0.8, 0.6), (-0.8, 0.6), (0.8, -0.6), (0.75, 0.4375**0.5), (0.0, -1.0)]:
        assert np.linalg.norm(corners - [x, y], axis=1).min() < 1e-12
    assert np.linalg.norm(np.diff(own.segments, axis=1), axis=2).max() <= 2 * np.sin(WIDEST / 2) * (
        1 + 1e-12
    )
    assert (own.curvature == -1).all() and area(corners) > 0


def test_no_corner_lies_between_a_chord_and_its_arc():
    circle = Circle(0.0, 0.0, 1.0)
    corner = np.array([np.cos(0.21), np.sin(0.21)]) * (1 - 1e-4)
    wedge = np.array([[corner, (0.0, 0.0)], [corner, (0.2, -0.5)]])
    own, _ = chords([circle, wedge], np.empty((0, 2)), 1e-9)
    start, stop = own.segments.transpose(1, 2, 0)
    run, offset = stop - start, corner[:, None] - start
    assert (run[0] * offset[1] - run[1] * offset[0] > 0).all()
