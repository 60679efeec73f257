"""Posterior probability of answers to a reading, from templates of expected readings.

Errors of readings are independent and normal with standard deviation 1.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Integer

Array = NDArray[Any]
"""Array of float64, or of float32 where that precision is enough."""

AT_ONCE = 20_000_000
"""Largest number of values in memory at once."""


class Axes(NamedTuple):
    """Projection of readings on few orthogonal axes (`turn`), shape (number, axis)."""

    origin: Array
    turn: Array

    def of(self, readings: Array) -> Array:
        """Coordinates of readings, shape (..., number) to (..., axis)."""
        return (readings - self.origin) @ self.turn


def axes_of(readings: Array, left_out: float = 0.0, most: int | None = None) -> Axes:
    """Principal axes of readings, until no residual exceeds `left_out`; at most `most` axes."""
    origin = readings.mean(axis=0)
    centred = readings - origin
    _, turn = np.linalg.eigh(centred.T @ centred)
    turn = turn[:, ::-1]
    left = ((centred @ turn)[:, ::-1] ** 2).cumsum(axis=1)[:, ::-1].max(axis=0)
    return Axes(origin, turn[:, : max(1, int((left > left_out**2).sum()))][:, :most])


class Templates(NamedTuple):
    """Expected readings, grouped by answer.

    readings: shape (template, number). chance: prior of each, shape (template,). starts: index of
    the first template of each answer.
    """

    readings: Array
    chance: Array
    starts: Integer

    @property
    def prior(self) -> Array:
        """Logarithm of the part of the likelihood without the reading, shape (template,)."""
        with np.errstate(divide="ignore"):
            return np.log(self.chance) - (self.readings**2).sum(axis=1) / 2


def starts_of(answers: Sequence[object], counts: Sequence[int]) -> Integer:
    """Index of the first template of each answer.

    answers: of the hypotheses, equal ones next to each other. counts: templates of each hypothesis.
    """
    begun = [k for k in range(len(answers)) if k == 0 or answers[k] != answers[k - 1]]
    return np.cumsum([0, *counts])[begun]


def posterior(known: Templates, measured: Array) -> Array:
    """Probability of each answer to each reading, shape (reading, answer)."""
    chunk, prior = max(1, AT_ONCE // len(known.chance)), known.prior
    parts = [measured[k : k + chunk] for k in range(0, len(measured), chunk)]
    return np.concatenate([_posterior(known, prior, part) for part in parts])


def _posterior(known: Templates, prior: Array, measured: Array) -> Array:
    likely = measured @ known.readings.T
    likely += prior
    likely -= likely.max(axis=1, keepdims=True)
    found = np.add.reduceat(np.exp(likely, out=likely), known.starts, axis=1)
    return found / found.sum(axis=1, keepdims=True)
