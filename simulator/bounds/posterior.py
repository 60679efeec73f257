"""How likely each answer is to a reading, by all readings that answers let expect.

All errors of readings are independent and normal with deviation 1.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
"""Of float64, or of float32 where that is enough."""

AT_ONCE = 20_000_000
"""Numbers that are held at once."""


class Axes(NamedTuple):
    """From readings to few numbers: orthogonal axes, shape (number, axis), from an origin."""

    origin: Array
    turn: Array

    def of(self, readings: Array) -> Array:
        """Shape (..., number) to (..., axis)."""
        return (readings - self.origin) @ self.turn


def axes_of(readings: Array, left_out: float = 0.0, most: int | None = None) -> Axes:
    """Along which readings differ, until none lies further off than `left_out`; `most` of these."""
    origin = readings.mean(axis=0)
    centred = readings - origin
    _, turn = np.linalg.eigh(centred.T @ centred)
    turn = turn[:, ::-1]
    left = ((centred @ turn)[:, ::-1] ** 2).cumsum(axis=1)[:, ::-1].max(axis=0)
    return Axes(origin, turn[:, : max(1, int((left > left_out**2).sum()))][:, :most])


class Templates(NamedTuple):
    """Readings to expect, those of each answer together.

    readings: shape (template, number). chance: of each, shape (template,). starts: of the templates
    of each answer.
    """

    readings: Array
    chance: Array
    starts: NDArray[np.int64]

    @property
    def prior(self) -> Array:
        """ln of how likely a template is to no reading at all, but for a constant, (template,)."""
        with np.errstate(divide="ignore"):
            return np.log(self.chance) - (self.readings**2).sum(axis=1) / 2


def starts_of(answers: Sequence[object], counts: Sequence[int]) -> NDArray[np.int64]:
    """Where each answer's templates begin. answers: of hypotheses, the same ones side by side.
    counts: templates of each hypothesis."""
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
