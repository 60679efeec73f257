"""Sweeps of the training drift as skins differ."""

import numpy as np
import pytest
from rcskin.localization.inputs.samples import LocalizationProblem
from rcskin.localization.learners.drift import DRIFT, with_drift

SWEEPS, READINGS = 500, 2
BOTH = ("dlnZ", "dphase", "lnZ0", "phase0")


def problem(quantities):
    return LocalizationProblem(
        "column", READINGS * len(quantities), quantities, ("left",), (1e3, 1e4), ""
    )


def sweeps(quantities, seed=1):
    """Skins that differ by 1 in one way, changes of nothing at all."""
    skin = np.random.default_rng(seed).standard_normal((SWEEPS, 1))
    way = {"lnZ0": [1.0, 2.0], "phase0": [3.0, 4.0]}
    nothing = [0.0, 0.0]
    return np.hstack([skin * way.get(name, nothing) for name in quantities])


def test_changes_move_as_skins_differ_and_the_curve_stays():
    X = sweeps(BOTH)
    moved = with_drift(problem(BOTH), X)
    np.testing.assert_array_equal(moved[:, 4:], X[:, 4:])
    np.testing.assert_allclose(moved[:, :4], moved[:, :1] * [1, 2, 3, 4], rtol=1e-12)
    assert moved[:, 0].std() == pytest.approx(DRIFT * X[:, 4].std())
    assert abs(np.corrcoef(moved[:, 0], X[:, 4])[0, 1]) < 0.1, "a skin does not tell its drift"


def test_the_sweep_as_it_was_read_moves_with_its_change(monkeypatch):
    quantities = ("lnZ", "lnZ0", "dlnZ")
    X = sweeps(quantities)
    monkeypatch.setattr("rcskin.localization.inputs.features.BLOCK", SWEEPS // 3)
    moved = with_drift(problem(quantities), X)
    np.testing.assert_array_equal(moved[:, :2] - X[:, :2], moved[:, 4:])
    assert (np.abs(moved[:, 4:]).max(axis=1) > 0).all()


@pytest.mark.parametrize("quantities", [("Rs", "Cp"), ("dlnZ", "dphase"), ("dlnZ", "phase0")])
def test_without_the_curve_of_each_change_nothing_drifts(quantities):
    X = sweeps(quantities)
    assert with_drift(problem(quantities), X) is X
