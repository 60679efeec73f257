"""A mesh in another unit than m is refused before any solving, one off the grid is warned of."""

import numpy as np
import pytest
from rcskin.simulator.scene.mesh_data import check_extent, off_grid
from rcskin.simulator.scene.mesh_file import MeshSurface

SQUARE = np.array([[0.0, 0.12, 0.12, 0.0], [0.0, 0.0, 0.12, 0.12]])
EMPTY = np.empty((2, 0), dtype=np.int64)


def surface(points):
    return MeshSurface(points, np.array([[0, 0], [1, 2], [2, 3]]), EMPTY, {}, {})


@pytest.mark.parametrize(
    ("factor", "hint"),
    [
        (1e3, "120 x 120 m .* a factor of 1000; .*did you mean mm"),
        (100, "did you mean cm"),
        (1 / 0.0254, "did you mean inches"),
        (1e-3, "did you mean km"),
        (20, "a factor of 20; points of a mesh are in m$"),
    ],
)
def test_a_mesh_in_another_unit_is_refused(factor, hint):
    with pytest.raises(ValueError, match=hint):
        check_extent(surface(factor * SQUARE), 0.12, 0.12)


@pytest.mark.parametrize(("shift", "warned"), [(0, False), (0.005, False), (-0.06, True)])
def test_a_mesh_off_the_grid_is_warned_of(shift, warned):
    moved = surface(SQUARE + shift)
    check_extent(moved, 0.12, 0.12)
    found = list(off_grid(moved, 0.12, 0.12))
    assert [bool(each) for each in found] == [True] * warned
    assert all("x = -60 to 60 mm" in each for each in found)
