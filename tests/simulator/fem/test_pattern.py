"""Sparsity patterns: the compiled searches against numpy's, and blocks against slices."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.fem.pattern import DROPPED, compressed, compressed_readable, pattern_of_pairs


@st.composite
def pairs(draw):
    """Rows, columns, of which some are left out, and the size of the matrix."""
    size, count = draw(st.integers(1, 12)), draw(st.integers(0, 60))
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    return rng.integers(DROPPED, size, count), rng.integers(DROPPED, size, count), size


@pytest.mark.kernel
@given(pairs=pairs())
def test_every_pair_has_the_slot_that_numpy_finds(pairs):
    for ours, plain in zip(compressed(*pairs), compressed_readable(*pairs), strict=True):
        np.testing.assert_array_equal(ours, plain)


@pytest.mark.kernel
@given(pairs=pairs(), data=st.data())
def test_a_block_holds_the_values_of_the_whole(pairs, data):
    size = pairs[-1]
    whole, _ = pattern_of_pairs(*pairs)
    kept = np.array(sorted(data.draw(st.sets(st.integers(0, size - 1), min_size=1))))
    values = np.arange(1.0, len(whole.indices) + 1)
    block, entries = whole.within(kept)
    np.testing.assert_array_equal(
        block.matrix(values[entries]).toarray(), whole.matrix(values).toarray()[np.ix_(kept, kept)]
    )
