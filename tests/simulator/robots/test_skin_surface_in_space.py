"""Points in space are found again at their places on the unrolled skin."""

import numpy as np
import pytest
from rcskin.simulator.robots.skin_surface_in_space import (
    ShapedSurface,
    TriangleSurface,
    place_of,
)
from rcskin.simulator.scene.scene import Scene

from .conftest import SIDES, small_scene

SHAPES = {
    "flat": {},
    "stretched": {"stretch": {"x": 1.2}},
    "cylinder": {"shape": {"kind": "cylinder", "radius": 0.03}},
    "cylinder along x": {"shape": {"kind": "cylinder", "radius": 0.03, "axis": "x"}},
    "sphere": {"shape": {"kind": "sphere", "radius": 0.05}},
}


def places(n=40):
    return np.random.default_rng(2).uniform(0.001, 0.999, (2, n)) * np.array(SIDES)[:, None]


class Found:
    """Places that are nearest to points, m, (3, n)."""

    def __init__(self, mounted, points):
        each = [place_of(mounted.numbers, *point) for point in points.T.tolist()]
        self.x = np.array([(place.x, place.y) for place in each]).T
        self.height = np.array([place.height for place in each])
        self.normals = np.array([place.normal for place in each]).T
        self.on = np.array([place.above for place in each]) & mounted.holds(self.x)


def surface(scene: Scene):
    return ShapedSurface(scene.skin)


@pytest.mark.parametrize("shape", SHAPES)
def test_points_above_a_skin_are_at_their_places(shape):
    mounted = surface(small_scene(**SHAPES[shape]))
    x = places()
    points, normals, on = mounted.points(x)
    found = Found(mounted, points + 2e-3 * normals)
    assert on.all() and found.on.all()
    assert found.x == pytest.approx(x, abs=1e-12)
    assert found.height == pytest.approx(2e-3, abs=1e-12)
    assert found.normals == pytest.approx(normals, abs=1e-12)


def test_the_middle_of_a_skin_is_at_the_site():
    for skin in SHAPES.values():
        points, normals, _ = surface(small_scene(**skin)).points(np.array(SIDES)[:, None] / 2)
        assert points == pytest.approx(0.0, abs=1e-15)
        assert normals == pytest.approx(np.array([[0.0], [0.0], [1.0]]))


def test_triangles_of_a_cylinder_unroll_like_the_cylinder():
    bent = surface(small_scene(**SHAPES["cylinder"]))
    columns = np.linspace(0, SIDES[0], 81)
    low = np.stack([columns[:-1], columns[1:], columns[1:]])
    high = np.stack([columns[:-1], columns[1:], columns[:-1]])
    flat = np.concatenate(
        [
            np.stack([low, np.array([[0.0], [0.0], [SIDES[1]]]) * np.ones(80)], axis=1),
            np.stack([high, np.array([[0.0], [SIDES[1]], [SIDES[1]]]) * np.ones(80)], axis=1),
        ],
        axis=2,
    )
    corners = np.stack([bent.points(each)[0] for each in flat])
    mesh = TriangleSurface(corners, flat)
    assert mesh.area == pytest.approx(np.prod(SIDES), rel=1e-4)
    x = places()
    points, normals, _ = bent.points(x)
    found = Found(mesh, points + 1e-3 * normals)
    assert found.on.all() and found.x == pytest.approx(x, abs=2e-5)
    assert found.height == pytest.approx(1e-3, abs=1e-5)
    assert mesh.holds(x).all() and not mesh.holds(x + SIDES[0]).any()
    back, _, on = mesh.points(x)
    assert on.all() and back == pytest.approx(points, abs=1e-5)
    beside = Found(mesh, np.array([[0.0], [0.05], [0.0]]))
    assert not beside.on.any()


def test_a_place_beside_a_skin_is_not_on_it():
    found = Found(surface(small_scene()), np.array([[0.041], [0.0], [0.001]]))
    assert not found.on.any()
