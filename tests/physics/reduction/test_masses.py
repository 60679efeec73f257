"""Factors of fewer rows keep the energies of potentials of the size that they are weighed by."""

import numpy as np
import pytest
from rcskin.simulator.models.reduced.families.masses import thinned


@pytest.mark.parametrize("share", [1e-3, 1e-8])
def test_thinner_factors_lose_no_more_than_their_share(share):
    rng = np.random.default_rng(0)
    size = np.array([1.0, 1.0, *np.full(10, 1e-3)])
    factors = [
        10.0 ** -np.arange(rows)[:, None] * rng.normal(size=(rows, 12)) / size for rows in (20, 6)
    ]
    found = thinned([*factors, np.zeros((3, 12))], size, share)
    assert found.shape[1] < 12 and not found[2].any()
    for thin, whole in zip(found, factors, strict=False):
        weighed, kept = (each * size for each in (whole, thin))
        most = np.linalg.norm(weighed, 2) ** 2
        lost = np.linalg.eigvalsh(weighed.T @ weighed - kept.T @ kept)
        assert -1e-12 * most < lost.min() and lost.max() <= share * most
