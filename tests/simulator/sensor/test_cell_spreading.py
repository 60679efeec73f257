"""Presses on fine cells, spread over the cells of a model."""

import numpy as np
import pytest
from rcskin.simulator.press.batch import PressBatch
from rcskin.simulator.sensor.cell_spreading import PARTS, CellSpreading

GRID = 5, 7
FINE = PARTS * GRID[0], PARTS * GRID[1]
SPREADING = CellSpreading(GRID, PARTS)


def coarse_map(batch, press=0, grid=GRID, first=0):
    found = np.zeros(grid[0] * grid[1])
    cells, rises = batch.one(press)
    own = (cells >= first) & (cells < first + found.size)
    found[cells[own] - first] = rises[own]
    return found.reshape(grid)


def twin(rises):
    """Spreading by dense matrices; rises: on fine cells, shape (row, column)."""
    down, along = map(shares, GRID)
    return down @ rises @ along.T / PARTS**2


def shares(coarse):
    """Shares of coarse cells in fine ones along an axis, shape (coarse, fine)."""
    cell, part = np.divmod(np.arange(coarse * PARTS), PARTS)
    t = (part + 0.5) / PARTS - 0.5
    second = t**2 + (1 / PARTS**2 - 1) / 12
    each = np.stack([(second - t) / 2, 1 - second, (second + t) / 2])
    first, last = cell == 0, cell == coarse - 1
    each[:, first] = np.stack([0 * t, 1 - t, t])[:, first]
    each[:, last] = np.stack([-t, 1 + t, 0 * t])[:, last]
    found = np.zeros((coarse + 2, len(cell)))
    for k in range(3):
        found[cell + k, np.arange(len(cell))] = each[k]
    return found[1:-1]


def moments(rises, grid):
    """Integrals of rises, constant in each cell, with 1, x, y, x² and y²."""
    middle = [(np.arange(n) + 0.5) / n for n in grid]
    squares = [each**2 + 1 / (12 * n**2) for each, n in zip(middle, grid, strict=True)]
    (y, x), (yy, xx) = middle, squares
    tests = [
        np.outer(a, b) for a, b in ((y**0, x**0), (y, x**0), (y**0, x), (yy, x**0), (y**0, xx))
    ]
    return [float((rises * each).sum()) / (grid[0] * grid[1]) for each in tests]


@pytest.mark.kernel
def test_the_kernel_is_the_product_of_dense_matrices():
    rises = np.random.default_rng(1).random((3, *FINE))
    rises[1:, :10] = 0
    spread = SPREADING(PressBatch.on_grid(rises.reshape(3, -1)))
    for press in range(3):
        np.testing.assert_allclose(coarse_map(spread, press), twin(rises[press]), atol=1e-12)


def test_moments_of_second_degree_are_kept_inside():
    rises = np.zeros(FINE)
    rises[7:11, 9:14] = np.random.default_rng(2).random((4, 5))
    spread = coarse_map(SPREADING(PressBatch.on_grid(rises.reshape(1, -1))))
    np.testing.assert_allclose(moments(spread, GRID), moments(rises, FINE), rtol=1e-12)


def test_first_moments_are_kept_at_the_border():
    rises = np.zeros(FINE)
    rises[0, 0] = rises[-1, 2] = 1.0
    spread = coarse_map(SPREADING(PressBatch.on_grid(rises.reshape(1, -1))))
    np.testing.assert_allclose(moments(spread, GRID)[:3], moments(rises, FINE)[:3], rtol=1e-12)


def test_whole_cells_stay_as_they_are():
    rises = np.kron(np.arange(35.0).reshape(GRID), np.ones((PARTS, PARTS)))
    spread = SPREADING(PressBatch.on_grid(rises.reshape(1, -1)))
    np.testing.assert_allclose(coarse_map(spread), np.arange(35.0).reshape(GRID), rtol=1e-12)
    assert len(spread.cells) == 34


def test_fingers_keep_their_capacitance():
    cells, rises = np.array([3, 400 % 140, FINE[0] * FINE[1] + 33]), np.array([1.0, 2.0, 5e-12])
    spread = SPREADING(PressBatch.of([(cells, rises)]))
    finger = coarse_map(spread, first=GRID[0] * GRID[1])
    assert finger.sum() == pytest.approx(5e-12)
    assert (np.diff(spread.cells) > 0).all()
