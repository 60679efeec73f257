"""Sweeps of the training drift as skins differ; what is told of is left as it is."""

import numpy as np
import pytest
from rcskin.localization.inputs.samples import LocalizationProblem
from rcskin.localization.learners.drift import DRIFT, Drifting, drifting, with_drift
from sklearn.pipeline import Pipeline
from sklearn.preprocessing import StandardScaler
from sklearn.utils.estimator_checks import parametrize_with_checks

SWEEPS, READINGS = 500, 2
BOTH = ("dlnZ", "dphase", "lnZ0", "phase0")


def problem(quantities):
    return LocalizationProblem(
        "column", READINGS * len(quantities), quantities, ("left",), (1e3, 1e4), ""
    )


def allowing(quantities):
    return with_drift(Pipeline([("scale", StandardScaler())]), problem(quantities))


def sweeps(quantities, seed=1):
    """Skins that differ by 1 in one way, changes of nothing at all."""
    skin = np.random.default_rng(seed).standard_normal((SWEEPS, 1))
    way = {"lnZ0": [1.0, 2.0], "phase0": [3.0, 4.0]}
    nothing = [0.0, 0.0]
    return np.hstack([skin * way.get(name, nothing) for name in quantities])


@parametrize_with_checks([Drifting()])
def test_keeps_the_conventions(estimator, check):
    check(estimator)


def test_changes_move_as_skins_differ_and_the_curve_stays():
    X = sweeps(BOTH)
    moved = drifting(allowing(BOTH))(X)
    np.testing.assert_array_equal(moved[:, 4:], X[:, 4:])
    np.testing.assert_allclose(moved[:, :4], moved[:, :1] * [1, 2, 3, 4], rtol=1e-12)
    assert moved[:, 0].std() == pytest.approx(DRIFT * X[:, 4].std())
    assert abs(np.corrcoef(moved[:, 0], X[:, 4])[0, 1]) < 0.1, "a skin does not tell its drift"


def test_the_sweep_as_it_was_read_moves_with_its_change():
    quantities = ("lnZ", "lnZ0", "dlnZ")
    X = sweeps(quantities)
    moved = drifting(allowing(quantities))(X)
    np.testing.assert_array_equal(moved[:, :2] - X[:, :2], moved[:, 4:])
    assert moved[:, 4:].std() > 0


def test_only_what_is_learned_from_drifts():
    X, allowed = sweeps(BOTH), allowing(BOTH)
    learned = allowed.fit_transform(X)
    as_read = allowed.transform(X)
    assert np.abs(learned[:, :4]).max() > 1
    np.testing.assert_array_equal(
        as_read[:, :4] * allowed[-1].scale_[:4] + allowed[-1].mean_[:4], 0
    )


@pytest.mark.parametrize("quantities", [("Rs", "Cp"), ("dlnZ", "dphase"), ("dlnZ", "phase0")])
def test_without_the_curve_of_each_change_nothing_drifts(quantities):
    X, plain = sweeps(quantities), allowing(quantities)
    assert [name for name, _ in plain.steps] == ["scale"]
    np.testing.assert_array_equal(drifting(plain)(X), X)
