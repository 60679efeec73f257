"""Touches rasterized all at once are those rasterized press by press."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.dataset.anywhere.touch_places import place_texts
from rcskin.simulator.press.capacitance import touched_cells
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.press.rasterized import Footprints, rasterized
from rcskin.simulator.scene.scene_files import load_scene

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
    return rng.integers(0, 3, presses), Footprints(disc, x, y, width, height, factor, 0 * factor)


@pytest.mark.kernel
@given(placed=placed(), grid=st.tuples(st.integers(1, 4), st.integers(1, 4)))
def test_all_at_once_is_press_by_press(placed, grid):
    touches, where = placed
    grid = 3 * grid[0], 3 * grid[1]
    batch = rasterized(SCENE.parts.skin, touches, where, grid)
    assert batch.starts[-1] == len(batch.cells)
    for own, text in zip(batch.each(), place_texts(touches, where, where.factor, ""), strict=True):
        found, expected = np.zeros((2, grid[0] * grid[1]))
        assert (np.diff(own.cells) > 0).all()
        found[own.cells] = own.rises
        at, by = touched_cells(SCENE.parts.skin, parse_press(text, np.nan), grid)
        expected[at] = by
        np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9)


def test_no_cell_beside_a_touch_is_counted():
    one = np.ones((1, 1))
    disc = Footprints(one > 0, 0.06 * one, 0.06 * one, 0.04 * one, 0.04 * one, 2 * one, 0 * one)
    on_lines = disc._replace(disc=one < 0)
    count = np.ones(1, dtype=np.int64)
    assert rasterized(SCENE.parts.skin, count, on_lines, (12, 12)).cells.size == 4 * 4
    whole = rasterized(SCENE.parts.skin, count, disc, (24, 24))
    assert whole.cells.size < 8 * 8
    assert whole.rises.sum() * (SIDE / 24) ** 2 == pytest.approx(np.pi * 0.02**2, rel=1e-12)
