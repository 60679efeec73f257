"""Inverting estimators keep the conventions of scikit-learn, given tables as wide as the data."""

from typing import Any

import numpy as np
import pytest
from rcskin.localization.inversion.adapted import AdaptedClassifier, AdaptedPosition
from rcskin.localization.inversion.classifier import ModelBased
from rcskin.localization.inversion.position import ModelBasedPosition
from rcskin.localization.inversion.skin_cache import SkinCache
from sklearn.base import is_regressor
from sklearn.utils.estimator_checks import parametrize_with_checks
from sklearn.utils.validation import check_array, check_is_fitted, validate_data

STRENGTHS = np.linspace(1.8, 2.2, 4)
LABELS = "tells touches of its scene, whatever labels it is shown"
PLACES = "tells places, and cannot be scored by one number"
SCORED = ("check_fit_score_takes_y", "check_pipeline_consistency")
FAILING = {
    "check_classifiers_classes": LABELS,
    "check_classifiers_train": LABELS,
    "check_classifiers_regression_target": LABELS,
    "check_classifiers_one_label": LABELS,
    "check_supervised_y_no_nan": LABELS,
    "check_supervised_y_2d": LABELS,
    "check_regressors_train": LABELS,
}


def tables(width: int, target: str) -> dict[str, Any]:
    """Of three columns, or of places, on a skin that is read by so many numbers."""
    random = np.random.default_rng(0)
    common = {
        "deviation": np.ones(width),
        "chances": np.array([0.3, 0.7, 0.0]),
        "strengths": STRENGTHS,
        "weights": np.ones(4) / 4,
        "spread": np.array(0.05),
    }
    if target == "position":
        nodes = np.linspace(0.01, 0.11, 4)
        u, v, f = np.meshgrid(nodes, nodes, STRENGTHS - 1, indexing="ij")
        along = random.standard_normal((3, width))
        values = f[..., None] * (np.stack([u, v, 1 + u * v], axis=-1) @ along)
        skin = np.zeros((4, 4, width, 1))
        named = {"x": nodes, "y": nodes, "strength_nodes": STRENGTHS}
        return common | named | {"values": 30 * values, "skin": skin, "sides": np.full(2, 0.12)}
    single = random.standard_normal((2, 1, width)) * (STRENGTHS - 1)[:, None]
    return common | {
        "grid": np.array([1, 2]),
        "pixels": np.array([[1, 1], [1, 2]]),
        "single": single,
        "shift": np.zeros_like(single),
        "slope": single / (STRENGTHS - 1)[:, None],
        "skin": np.zeros((*single.shape, 1)),
    }


@pytest.fixture(autouse=True)
def few_entries(monkeypatch):
    """Conventions do not hang on how finely places are told apart."""
    monkeypatch.setattr("rcskin.localization.inversion.position.GRID", (4, 4, 4))


class _Wide:
    """Is given the tables that fit the features it is shown."""

    def fit(self, X, y=None):
        self._width = check_array(X, allow_nd=True, ensure_all_finite=False).shape[1]
        return super().fit(X, y)  # type: ignore[misc]


class WideClassifier(_Wide, ModelBased):
    def _tables(self):
        return tables(self._width, "column")


class WidePosition(_Wide, ModelBasedPosition):
    def _tables(self):
        return tables(self._width, "position")


class _Doubled:
    """Takes the features it is shown for the change and for the curve at rest."""

    def fit(self, X, y=None):
        X = validate_data(self, X)
        self.mean_, self._skins = self._fitted(None, X), SkinCache(self._fitted)
        return self

    def _fitted(self, curve, X=None):
        X = curve[None] if X is None else X
        placed = isinstance(self, AdaptedPosition)
        return (WidePosition() if placed else WideClassifier(target="column")).fit(X)

    def _by_skin(self, X, ask):
        check_is_fitted(self)
        X = validate_data(self, X, reset=False)
        return self._by_curve(X, X, ask)


class DoubledClassifier(_Doubled, AdaptedClassifier):
    pass


class DoubledPosition(_Doubled, AdaptedPosition):
    pass


def failing(estimator):
    """Checks that cannot hold, with the reason."""
    return FAILING | (dict.fromkeys(SCORED, PLACES) if is_regressor(estimator) else {})


@parametrize_with_checks(
    [WideClassifier(target="column"), WidePosition(), DoubledClassifier()],
    expected_failed_checks=failing,
)
def test_it_keeps_the_conventions_of_scikit_learn(estimator, check):
    check(estimator)


@pytest.mark.slow
@parametrize_with_checks([DoubledPosition()], expected_failed_checks=failing)
def test_places_on_the_skin_at_hand_keep_them_too(estimator, check):
    check(estimator)
