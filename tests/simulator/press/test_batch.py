"""Batches of presses: what one press touches comes out as it went in."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.press.batch import NOTHING, PressBatch

PRESS = st.dictionaries(st.integers(0, 8), st.floats(-0.5, 2.0).filter(bool), max_size=4).map(
    lambda touched: (
        np.array(sorted(touched), dtype=int),
        np.array([touched[k] for k in sorted(touched)]),
    )
)
PRESSES = st.lists(PRESS, max_size=5)


def same(batch, presses):
    assert batch.count == len(presses)
    for (cells, rises), expected in zip(batch.each(), presses, strict=True):
        np.testing.assert_array_equal(cells, expected[0])
        np.testing.assert_array_equal(rises, expected[1])


@given(presses=PRESSES)
def test_presses_keep_their_cells_and_rises(presses):
    same(PressBatch.of(presses), presses)


@given(presses=PRESSES)
def test_a_grid_gives_the_cells_that_rise(presses):
    rises = np.zeros((len(presses), 9))
    for row, (cells, each) in zip(rises, presses, strict=True):
        row[cells] = each
    same(PressBatch.on_grid(rises), presses)


def test_equally_many_cells_are_reported_once():
    batch = PressBatch.even(np.array([3, 1]), np.array([[0.5, 1.0], [2.0, 0.1]]))
    same(batch, [([3, 1], [0.5, 1.0]), ([3, 1], [2.0, 0.1])])


def test_a_batch_has_arrays_of_its_own():
    cells, rises = np.array([[3, 4], [0, 1]]), np.ones((2, 2))
    batch = PressBatch.even(cells, rises)
    batch.cells[:], batch.rises[:] = 9, 9.0
    np.testing.assert_array_equal(cells, [[3, 4], [0, 1]])
    np.testing.assert_array_equal(rises, 1.0)


def test_rest_is_a_press_of_no_cells():
    same(PressBatch.of([NOTHING, NOTHING]), [NOTHING, NOTHING])
    assert PressBatch.of([]).count == 0


def test_weights_are_those_of_the_cells_touched():
    batch = PressBatch.of([(np.array([2, 0]), np.array([1.0, 3.0]))])
    np.testing.assert_array_equal(batch.weighted(np.array([0.5, 7.0, 2.0])).rises, [2.0, 1.5])
