"""Factors of fewer rows keep the energies of potentials of the size that they are weighed by."""

import numpy as np
import pytest
from rcskin.simulator.models.reduced.family import compressed_factors
from rcskin.simulator.press.parts import Parts


@pytest.mark.parametrize("share", [1e-3, 1e-8])
def test_thinner_factors_lose_no_more_than_their_share(share):
    rng = np.random.default_rng(0)
    size = np.array([1.0, 1.0, *np.full(10, 1e-3)])
    factors = [
        10.0 ** -np.arange(rows)[:, None] * rng.normal(size=(rows, 12)) / size for rows in (20, 6)
    ]
    found = compressed_factors([*factors, np.zeros((3, 12))], size, share, Parts(3))
    assert found.shape[1] < 12 and not found[2].any()
    for thin, whole in zip(found, factors, strict=False):
        weighed, kept = (each * size for each in (whole, thin))
        most = np.linalg.norm(weighed, 2) ** 2
        lost = np.linalg.eigvalsh(weighed.T @ weighed - kept.T @ kept)
        assert -1e-12 * most < lost.min() and lost.max() <= share * most


def test_the_field_across_a_part_is_kept_as_far_as_that_part_itself():
    """It is small beside that: what is of no account for the part needs no row of its own."""
    rng = np.random.default_rng(0)
    foam, across = rng.normal(size=(2, 4, 12))
    found = compressed_factors([foam, 1e-3 * across], np.ones(12), 1e-4, Parts(1, thickness=1))
    assert found.shape == (2, 4, 12)
    assert not found[1].any() and np.linalg.matrix_rank(found[0]) == 4
