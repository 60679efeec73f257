"""Distances of distributions against plain loops and closed cases."""

import numpy as np
import pytest
from rcskin.localization.gap.gap_findings import (
    MAX_SAMPLE,
    discrepancy,
    energy_distance,
    kernel,
    permutation_p,
    unbiased_mmd2,
)


def normal(n, features=3, shift=0.0, seed=0):
    return shift + np.random.default_rng(seed).standard_normal((n, features))


def all_distances(X, Y):
    both = np.concatenate([X, Y])
    return np.linalg.norm(both[:, None] - both, axis=-1)


def mmd2_in_loops(X, Y):
    """Gretton et al. (2012), Eq. 3, with the median of all distances as the kernel's width."""
    both = [*X, *Y]
    apart = [np.linalg.norm(a - b) for i, a in enumerate(both) for b in both[:i]]
    width = np.median(apart)

    def k(a, b):
        return np.exp(-np.sum((a - b) ** 2) / (2 * width**2))

    n, m = len(X), len(Y)
    first = sum(k(X[i], X[j]) for i in range(n) for j in range(n) if i != j) / (n * (n - 1))
    second = sum(k(Y[i], Y[j]) for i in range(m) for j in range(m) if i != j) / (m * (m - 1))
    return first + second - 2 * sum(k(x, y) for x in X for y in Y) / (n * m)


def energy_in_loops(X, Y):
    def mean(A, B):
        return sum(np.linalg.norm(a - b) for a in A for b in B) / (len(A) * len(B))

    return 2 * mean(X, Y) - mean(X, X) - mean(Y, Y)


@pytest.mark.parametrize("shift", [0.0, 0.7])
def test_both_distances_are_those_of_plain_loops(shift):
    X, Y = normal(9), normal(7, shift=shift, seed=1)
    distances = all_distances(X, Y)
    assert unbiased_mmd2(kernel(distances), 9) == pytest.approx(mmd2_in_loops(X, Y), abs=1e-12)
    assert energy_distance(distances, 9)[0] == pytest.approx(energy_in_loops(X, Y), abs=1e-12)


def test_the_energy_distance_of_a_sample_to_itself_is_none():
    X = normal(12)
    assert energy_distance(all_distances(X, X), 12) == (0.0, 0.0)


def test_two_points_are_apart_by_twice_their_distance_and_never_touch():
    X, Y = np.zeros((4, 2)), np.full((6, 2), [3.0, 4.0])
    assert energy_distance(all_distances(X, Y), 4) == (pytest.approx(10.0), pytest.approx(1.0))


def test_samples_that_are_all_the_same_are_not_apart():
    found = discrepancy(np.ones((4, 2)), np.ones((5, 2)), np.random.default_rng(0))
    assert (found.mmd2, found.energy, found.coefficient, found.p) == (0.0, 0.0, 0.0, 1.0)


def test_the_unbiased_discrepancy_of_one_distribution_is_none_on_average():
    found = [
        unbiased_mmd2(kernel(all_distances(normal(10, seed=s), normal(10, seed=500 + s))), 10)
        for s in range(200)
    ]
    deviation = np.std(found) / np.sqrt(len(found))
    assert abs(np.mean(found)) < 3 * deviation
    assert min(found) < 0 < max(found)


def test_chances_of_one_distribution_are_even_and_of_a_shifted_one_small():
    random = np.random.default_rng(3)
    same = [
        permutation_p(kernel(all_distances(normal(12, seed=s), normal(9, seed=90 + s))), 12, random)
        for s in range(60)
    ]
    assert 0.35 < np.mean(same) < 0.65
    assert np.mean(np.array(same) < 0.05) < 0.15
    shifted = all_distances(normal(12), normal(9, shift=1.5, seed=1))
    assert permutation_p(kernel(shifted), 12, random) < 0.01


def test_the_energy_coefficient_does_not_depend_on_the_unit():
    X, Y = normal(8), normal(8, shift=1.0, seed=1)
    small, large = (energy_distance(all_distances(u * X, u * Y), 8) for u in (1e-12, 1e6))
    assert small[1] == pytest.approx(large[1])
    assert large[0] == pytest.approx(1e18 * small[0])


def test_of_many_sweeps_some_are_drawn_and_one_alone_shows_nothing():
    random = np.random.default_rng(0)
    found = discrepancy(normal(MAX_SAMPLE + 20, 1), normal(5, 1, seed=1), random)
    assert (found.first, found.second) == (MAX_SAMPLE, 5)
    assert discrepancy(normal(1), normal(5), random) is None
