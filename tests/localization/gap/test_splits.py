"""What is tested was never added to training, nor used to calibrate."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.localization.gap.mean_accuracy import largest_k, reserved_for_calibration, touch_splits
from rcskin.simulator.sweeps import InputError


def grid(rows, columns, repetitions, rest=0):
    """Rows, columns and numbers of pixels, each pressed several times."""
    pixels = [(0, 0)] * rest + [(i, j) for i in range(1, rows + 1) for j in range(1, columns + 1)]
    pixels = [(0, 0)] * rest + pixels[rest:] * repetitions
    row, column = np.array(pixels).T
    return row, column, np.where(row > 0, 10_000 * row + column, 0)


@given(
    st.lists(st.integers(0, 5), min_size=4, max_size=60),
    st.integers(0, 6),
    st.integers(0, 2**16),
    st.data(),
)
def test_no_split_leaks(pixels, k, seed, data):
    pixel = np.array(pixels)
    reserved = np.array(
        data.draw(st.lists(st.booleans(), min_size=len(pixel), max_size=len(pixel)))
    )
    splits = touch_splits(pixel, reserved, k, 3, seed)
    for added, tested in splits or []:
        assert not set(added) & set(tested)
        assert not reserved[tested].any()
        for each in set(pixel[tested]):
            assert np.sum(pixel[added] == each) == k
            first = np.flatnonzero((pixel == each) & reserved)[:k]
            assert set(first) <= set(added)
        assert set(pixel[added]) <= set(pixel[tested])


def test_every_sweep_that_is_neither_added_nor_reserved_is_tested():
    row, column, pixel = grid(2, 3, 4)
    reserved = reserved_for_calibration(row, column, 2, np.zeros(row.size))
    for k in (0, 1, 3):
        for added, tested in touch_splits(pixel, reserved, k, 4, 0):
            assert set(added) | set(tested) | set(np.flatnonzero(reserved)) == set(range(row.size))


def test_draws_differ_and_come_again_with_the_seed():
    row, column, pixel = grid(2, 3, 5)
    none = np.zeros(row.size, dtype=bool)
    first, again, other = (touch_splits(pixel, none, 2, 3, seed) for seed in (1, 1, 2))
    added = [[split.added.tolist() for split in splits] for splits in (first, again, other)]
    assert added[0] == added[1] != added[2]
    assert len({tuple(each) for each in added[0]}) == 3
    assert len(touch_splits(pixel, none, 0, 3, 1)) == 1


def test_a_pixel_without_one_to_spare_leaves_no_split():
    row, column, pixel = grid(1, 3, 3)
    none = np.zeros(row.size, dtype=bool)
    assert touch_splits(pixel, none, 2, 1, 0) is not None
    assert touch_splits(pixel, none, 3, 1, 0) is None
    assert largest_k(pixel, none) == 2
    assert touch_splits(pixel, ~none, 0, 1, 0) is None


def test_half_of_the_rest_of_each_session_and_pixels_far_apart_calibrate():
    row = np.array([0, 0, 0, 0, 0, *[1, 1, 1, 3, 3, 3] * 2])
    column = np.array([0, 0, 0, 0, 0, *[1, 2, 3, 1, 2, 3] * 2])
    session = np.array([1, 1, 1, 2, 2, *[1] * 6, *[2] * 6])
    reserved = reserved_for_calibration(row, column, 2, session)
    assert reserved[:5].tolist() == [True, True, False, True, False]
    chosen = [(row[k], column[k]) for k in np.flatnonzero(reserved) if row[k]]
    assert chosen == [(1, 1), (3, 3)]


@pytest.mark.parametrize(("touches", "pressed"), [(0, 0), (4, 4), (99, 6)])
def test_as_many_pixels_calibrate_as_asked_and_there_are(touches, pressed):
    row, column, _ = grid(2, 3, 2)
    assert reserved_for_calibration(row, column, touches, np.zeros(12)).sum() == pressed


def test_fewer_than_no_touches_are_refused():
    with pytest.raises(InputError, match="must be >= 0, got -1"):
        reserved_for_calibration(*grid(1, 2, 2)[:2], -1, np.zeros(4))
