"""Two frequencies are the same within 1e-6, or within the digits that a file keeps."""

import pytest
from rcskin.simulator.sweeps.same_skin import same_frequencies


@pytest.mark.parametrize(
    ("one", "other", "same"),
    [
        ([1000, 2000], [1000.0005, 2000], True),
        ([1000, 2000], [1000.005, 2000], False),
        ([1000, 1585, 2512], [1000, 1584.893, 2511.886], True),
        ([1584.893], [1585], True),
        ([1585, 2512], [1586, 2512], False),
        ([100, 200], [101, 200], False),
        ([1.0001e5], [1.0002e5], False),
    ],
)
def test_frequencies(one, other, same):
    assert bool(same_frequencies(one, other).all()) == same
    assert bool(same_frequencies(other, one).all()) == same
