"""Accuracies across and within a side."""

import numpy as np
import pytest
from rcskin.localization.gap.mean_accuracy import (
    PairedSamples,
    Split,
    cross_validated,
    feature_sets,
    paired_samples,
    transfer_accuracy,
)
from rcskin.localization.inputs.samples import LocalizationProblem
from rcskin.localization.inversion.estimators import chosen

KSVM = chosen("ksvm-ovo", "column")


def points(places, classes, repetitions=4):
    """Samples that lie in a tight heap for each class."""
    random = np.random.default_rng(0)
    problem = LocalizationProblem("column", 1, ("Rs",), ("left",), (1e3,), "")
    X = np.repeat(np.array(places, dtype=float), repetitions)[:, None]
    y = np.repeat(classes, repetitions)
    return PairedSamples(problem, X + 1e-3 * random.standard_normal(X.shape), y, y)


def indices(*which):
    return np.array(which, dtype=np.intp)


def test_a_shift_of_one_class_is_undone_by_what_is_added():
    """The other side's class 1 lies where the simulation has class 2."""
    simulated, other = points([0, 1, 2], [1, 2, 3]), points([1, 2, 3], [1, 2, 3])
    everything = Split(indices(), np.arange(12))
    alone = transfer_accuracy(simulated, other, [everything], KSVM)
    assert alone.confusion.counts[0].tolist() == [0, 4, 0]
    same = transfer_accuracy(simulated, simulated, [everything], KSVM)
    assert (same.mean, same.spread, same.draws) == (1.0, 0.0, 1)


def test_draws_are_reported_by_their_mean_and_spread_and_counted_together():
    simulated, other = points([0, 1], [1, 2]), points([0, 0], [1, 2])
    splits = [Split(indices(), indices(0, 1, 2, 4)), Split(indices(), indices(0, 4, 5, 6))]
    found = transfer_accuracy(simulated, other, splits, KSVM)
    assert (found.mean, found.spread) == (0.5, pytest.approx(0.5 * np.sqrt(0.5)))
    assert found.confusion.labels == (1, 2)
    assert found.confusion.counts.tolist() == [[4, 0], [4, 0]]


@pytest.mark.parametrize(
    ("sessions", "rows", "target", "grouping"),
    [
        (2, (0, 1, 2), "column", "session"),
        (1, (0, 1, 2), "column", "press"),
        (1, (0, 1), "column", None),
        (1, (0, 1, 2), "pixel", None),
    ],
)
def test_the_hardest_grouping_that_can_be_is_taken(
    make_skin_sweeps, sessions, rows, target, grouping
):
    sweeps = make_skin_sweeps(rows=2, sessions=sessions)
    sweeps = sweeps.isel(sweep=np.isin(sweeps["row"].values, rows))
    samples = paired_samples(sweeps, feature_sets(sweeps)["absolute"], target)
    found = cross_validated(sweeps, samples, KSVM, 0)
    assert found.grouping == grouping
    assert found.accuracy.confusion.total == sweeps.sizes["sweep"]
    assert cross_validated(sweeps, samples, KSVM, 0, grouped=False).grouping is None


def test_a_class_of_one_sweep_cannot_be_cross_validated(make_skin_sweeps):
    sweeps = make_skin_sweeps(1)
    samples = paired_samples(sweeps, feature_sets(sweeps)["absolute"], "pixel")
    assert cross_validated(sweeps, samples, KSVM, 0) is None
