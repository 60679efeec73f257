"""Fine-tuning of the skin's parameters or of the model's error by labelled touches.

In both modes the probabilities of strengths follow the observed ones.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.special import softmax

from ...simulator.arrays import Mask, Real
from .hypotheses import NONE, Hypotheses

Mode = Literal["nothing", "skin", "error"]
PRIOR_STRENGTHS = 20.0
"""Weight of the prior of strengths, as a number of touches."""
PRIOR_ERRORS = 10.0
"""Weight of the prior of no model error, as a number of touches."""


def fine_tuned(known: Hypotheses, X: Real, possible: Mask, mode: Mode) -> Hypotheses:
    """Hypotheses after labelled sweeps. X: in units of noise, shape (sweep, number).

    possible: entries that agree with each label, shape (sweep, entry). Sweeps of the unpressed skin
    are not used. mode: "skin": all touches are of one skin, whose parameters are estimated;
    "error": touches are of any skins, and give a bias and further spread of the model.
    """
    pressed = ~possible[:, (known.place == NONE).all(axis=1)].any(axis=1)
    X, possible = X[pressed], possible[pressed]
    if not len(X):
        return known
    mixture = known.mixture()
    joint = np.where(possible, mixture.log_joint(mixture.distances(X)), -np.inf)
    shares = softmax(joint, axis=1)
    fit = _with_fitted_skin if mode == "skin" else _with_fitted_error
    fitted = fit(known, X, shares.argmax(axis=1))
    return replace(fitted, strengths=_strengths(known, shares.sum(axis=0)))


def _with_fitted_skin(known: Hypotheses, X: Real, entry: NDArray[np.intp]) -> Hypotheses:
    """Update the normal unknowns z of the skin; a sweep of strength t is m + J t + A z."""
    unknowns = known.skin.shape[-1]
    precision, pull = np.eye(unknowns), np.zeros(unknowns)
    for x, e in zip(X, entry, strict=True):
        J, A = np.split(known.spread(np.array([e]))[0], [known.slope.shape[2]], axis=1)
        off, inner = x - known.means(np.array([e]))[0], np.eye(J.shape[1]) + J.T @ J
        left = A - J @ np.linalg.solve(inner, J.T @ A)
        precision += A.T @ left
        pull += left.T @ off
    covariance = np.linalg.inv(precision)
    return replace(
        known,
        shift=known.shift + known.skin @ (covariance @ pull),
        skin=known.skin @ np.linalg.cholesky((covariance + covariance.T) / 2),
    )


def _with_fitted_error(known: Hypotheses, X: Real, entry: NDArray[np.intp]) -> Hypotheses:
    """Add a bias and further directions from the residuals of the best fits, if above noise."""
    left = np.array([_residual(known, x, e) for x, e in zip(X, entry, strict=True)])
    count, numbers = len(left), X.shape[1]
    bias = left.sum(axis=0) / (count + PRIOR_ERRORS)
    scatter = (left - bias).T @ (left - bias) / (count + PRIOR_ERRORS)
    power, turn = np.linalg.eigh(scatter)
    by_chance = (1 + np.sqrt(numbers / count)) ** 2
    found = power > by_chance
    columns = turn[:, found] * np.sqrt(power[found] - 1)
    further = np.broadcast_to(columns, (*known.skin.shape[:3], columns.shape[1]))
    return replace(
        known,
        shift=known.shift + bias,
        skin=np.concatenate([known.skin, further], axis=3),
    )


def _residual(known: Hypotheses, x: Real, entry: int) -> Real:
    """Residual of a sweep after strength and skin are fitted."""
    one = np.array([entry])
    B, off = known.spread(one)[0], x - known.means(one)[0]
    return off - B @ np.linalg.solve(np.eye(B.shape[1]) + B.T @ B, B.T @ off)


def _strengths(known: Hypotheses, met: Real) -> Real:
    """Probabilities of strengths. met: number of touches of each entry, shape (entry,)."""
    there = known.strength != NONE
    counts = np.bincount(
        known.strength[there],
        np.broadcast_to(met[:, None], there.shape)[there],
        minlength=known.strengths.size,
    )
    return (PRIOR_STRENGTHS * known.strengths + counts) / (PRIOR_STRENGTHS + counts.sum())
