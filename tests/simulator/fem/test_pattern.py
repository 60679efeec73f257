"""Sparsity patterns: the compiled searches against numpy's, and blocks against slices."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.fem import assembly
from rcskin.simulator.fem.assembly import (
    DROPPED,
    block_readable,
    compressed_readable,
    pattern_of_pairs,
)
from rcskin.simulator.fem.kernels import block, compressed


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
        assert ours.dtype == plain.dtype


@given(pairs=pairs())
def test_a_table_of_keys_finds_what_sorting_them_does(pairs):
    found = []
    for most in (0, 10**6):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(assembly, "TABLE", most)
            found.append(compressed_readable(*pairs))
    for sorted_, looked_up in zip(*found, strict=True):
        np.testing.assert_array_equal(looked_up, sorted_)
        assert looked_up.dtype == sorted_.dtype


@pytest.mark.kernel
@given(pairs=pairs(), data=st.data())
def test_a_block_holds_the_values_of_the_whole(pairs, data):
    size = pairs[-1]
    whole, _ = pattern_of_pairs(*pairs)
    kept = np.array(sorted(data.draw(st.sets(st.integers(0, size - 1), min_size=1))))
    values = np.arange(1.0, len(whole.indices) + 1)
    part, entries = whole.within(kept)
    np.testing.assert_array_equal(
        part.matrix(values[entries]).toarray(), whole.matrix(values).toarray()[np.ix_(kept, kept)]
    )
    number = np.full(size, DROPPED, dtype=np.int32)
    number[kept] = np.arange(len(kept), dtype=np.int32)
    given = whole.indices, whole.indptr, kept, number
    for compiled, read in zip(block(*given), block_readable(*given), strict=True):
        np.testing.assert_array_equal(compiled, read)
        assert compiled.dtype == read.dtype
