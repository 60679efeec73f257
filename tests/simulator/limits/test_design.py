"""The best frequencies, beside the sets that they are held against."""

import numpy as np
import pytest
from rcskin.simulator.bounds.position import chosen_touch
from rcskin.simulator.bounds.sets import LOGARITHMIC
from rcskin.simulator.limits.design import design
from rcskin.simulator.sweeps import InputError


def test_the_best_set_is_no_worse_than_the_others_and_always_the_same(noisy_strip):
    found, again = (
        design(noisy_strip, 4, (1e2, 1e5), chosen_touch(noisy_strip), grid=12) for _ in range(2)
    )
    assert min(found.figures.values()) == found.figures["optimal"]
    assert all(found.ratio(name) >= 1 for name in found.sets)
    np.testing.assert_array_equal(found.best, again.best)
    assert len(set(found.best)) == 4 and len(found.sets[LOGARITHMIC]) == 4


@pytest.mark.parametrize(("n", "grid"), [(0, 10), (11, 10), (3, 1)])
def test_numbers_out_of_range_are_refused(noisy_strip, n, grid):
    with pytest.raises(InputError, match="must be from"):
        design(noisy_strip, n, (1e2, 1e5), chosen_touch(noisy_strip), grid=grid)
