"""Touches on the cells of a grid: by the kernel, by its readable twin, and by closed forms."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.dataset.touch_places import place_texts
from rcskin.simulator.press.cell_kernel import covered_fraction, covered_with_slopes
from rcskin.simulator.press.pixels import GridCells
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.press.rasterized import TouchBatch, rasterized
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.tests.library.rasters import cell_map, twin_map

SCENE = load_scene("sheet-3x3")
SIDE = 0.12


@st.composite
def placed(draw):
    """A few presses of up to two touches, many on lines of cells or one over the other."""
    rng, presses = np.random.default_rng(draw(st.integers(0, 2**32))), 6
    shape, steps = (presses, 2), draw(st.sampled_from([12, 1000]))
    disc = rng.random(shape) < 0.5
    width = np.round(rng.integers(1, steps // 2, shape) * SIDE / steps, 6)
    height = np.where(disc, width, np.round(rng.integers(1, steps // 2, shape) * SIDE / steps, 6))
    low = rng.integers(0, steps // 2, (2, *shape)) * SIDE / steps
    x, y = (np.round(each + side / 2, 7) for each, side in zip(low, (width, height), strict=True))
    factor = np.round(rng.uniform(0.5, 3.0, shape), 6)
    counts = rng.integers(0, 3, presses)
    return TouchBatch(counts, disc, x, y, width, height, factor, 0 * factor)


@pytest.mark.kernel
@given(placed=placed(), grid=st.tuples(st.integers(1, 4), st.integers(1, 4)))
def test_many_presses_are_each_of_them_and_the_twin(placed, grid):
    grid = 3 * grid[0], 3 * grid[1]
    batch = rasterized(SCENE.parts.skin, placed, grid)
    assert batch.starts[-1] == len(batch.cells)
    for own, text in zip(batch.each(), place_texts(placed, placed.factor, ""), strict=True):
        found, press = np.ones(grid), parse_press(text, np.nan)
        assert (np.diff(own.cells) > 0).all()
        found.ravel()[own.cells] += own.rises
        np.testing.assert_allclose(found, twin_map(SCENE.parts.skin, press, *grid), rtol=1e-9)
        alone = cell_map(SCENE.parts.skin, press, *grid)
        np.testing.assert_allclose(alone, found, rtol=1e-9)


def test_no_cell_beside_a_touch_is_counted():
    one, count = np.ones((1, 1)), np.ones(1, dtype=np.int64)
    place = 0.06 * one, 0.06 * one, 0.04 * one, 0.04 * one
    disc = TouchBatch(count, one > 0, *place, 2 * one, 0 * one)
    on_lines = disc._replace(disc=one < 0)
    assert rasterized(SCENE.parts.skin, on_lines, (12, 12)).cells.size == 4 * 4
    whole = rasterized(SCENE.parts.skin, disc, (24, 24))
    assert whole.cells.size < 8 * 8
    assert whole.rises.sum() * (SIDE / 24) ** 2 == pytest.approx(np.pi * 0.02**2, rel=1e-12)


def fractions(x, y, radius, columns, rows):
    """Part of each cell between lines that a disc covers, shape (row, column)."""
    box = x - radius, x + radius, y - radius, y + radius
    sides = [(*along, *across) for across in pairwise(rows) for along in pairwise(columns)]
    found = [covered_fraction(box, radius, each) for each in sides]
    return np.reshape(found, (len(rows) - 1, len(columns) - 1))


LINES = st.lists(st.integers(-1500, 1500), max_size=6, unique=True).map(
    lambda at: np.array([-2000, *sorted(at), 2000]) / 1000
)


@given(columns=LINES, rows=LINES)
def test_parts_of_a_disc_add_up_to_it(columns, rows):
    areas = np.multiply.outer(np.diff(rows), np.diff(columns))
    fraction = fractions(0.3, -0.2, 0.7, columns, rows)
    np.testing.assert_allclose((areas * fraction).sum(), np.pi * 0.49, rtol=1e-12)


def test_a_quarter_and_a_segment_of_a_disc():
    """The part beyond half the radius is r² (pi / 3 - sqrt(3) / 4)."""
    quarter = fractions(1.0, 2.0, 3.0, np.array([1.0, 4.0]), np.array([2.0, 5.0]))
    np.testing.assert_allclose(quarter, np.pi / 4, rtol=1e-14)
    segment = fractions(0.0, 0.0, 1.0, np.array([0.5, 1.0]), np.array([-1.0, 1.0]))
    np.testing.assert_allclose(segment, np.pi / 3 - np.sqrt(3) / 4, rtol=1e-14)


def test_cells_against_counted_points():
    columns, rows = np.linspace(0, 1, 6), np.linspace(0, 1, 5)
    x, y = np.meshgrid((np.arange(2000) + 0.5) / 2000, (np.arange(2000) + 0.5) / 2000)
    inside = np.hypot(x - 0.4, y - 0.55) < 0.33
    counted = inside.reshape(4, 500, 5, 400).mean(axis=(1, 3))
    fraction = fractions(0.4, 0.55, 0.33, columns, rows)
    np.testing.assert_allclose(fraction, counted, atol=1e-3)


@pytest.mark.kernel
@pytest.mark.parametrize("radius", [0.0, 0.023])
def test_slopes_are_those_of_a_patch_that_moves(radius):
    """Also beyond the end of the skin, where it leaves it."""
    cells, step, middle = GridCells.of(SCENE.parts.skin, (6, 9)), 1e-7, np.array([0.016, 0.0517])

    def covered(x, y):
        wide, high = (radius, radius) if radius else (0.021, 0.0155)
        return covered_with_slopes((x - wide, x + wide, y - high, y + high), radius, cells)

    part, *slopes = covered(*middle)
    box = middle[0] - 0.021, middle[0] + 0.021, middle[1] - 0.0155, middle[1] + 0.0155
    if radius:
        expected = fractions(*middle, radius, cells.x, cells.y)
    else:
        across, along = (
            np.minimum(last, lines[1:]) - np.maximum(first, lines[:-1])
            for first, last, lines in ((*box[2:], cells.y), (*box[:2], cells.x))
        )
        expected = np.multiply.outer(across.clip(0.0), along.clip(0.0)) / (SIDE / 6 * SIDE / 9)
    np.testing.assert_allclose(part, expected, atol=1e-12)
    for shift, slope in zip(step * np.eye(2), slopes, strict=True):
        ahead, behind = covered(*(middle + shift))[0], covered(*(middle - shift))[0]
        np.testing.assert_allclose(slope, (ahead - behind) / (2 * step), atol=1e-4)


@pytest.mark.kernel
def test_edges_on_lines_count_in_the_cell_behind_and_not_at_the_ends_of_the_skin():
    cells = GridCells.of(SCENE.parts.skin, (1, 4))
    _, by_x, by_y = covered_with_slopes((0.03, 0.06, 0.0, SIDE), 0.0, cells)
    np.testing.assert_allclose(by_x, [[0.0, -4 / SIDE, 4 / SIDE, 0.0]])
    assert not by_y.any()
    assert not covered_with_slopes((0.0, SIDE, 0.0, SIDE), 0.0, cells)[1:].any()
