"""Posterior probability of answers to a reading, from templates of expected readings.

Errors of readings are independent and normal with standard deviation 1.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Integer, Mask

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


SIDE = 8
"""Number of strengths of each touch in a tile."""
NEGLIGIBLE = 1e-12
"""Largest relative likelihood of a skipped tile."""


class Balls(NamedTuple):
    """Balls around tiles: middle (ball, number), radius, and prior of all templates (ball,)."""

    middle: Array
    radius: Array
    chance: Array


def in_tiles(counts: tuple[int, ...]) -> tuple[Integer, Integer]:
    """Order of all combinations of strengths by tile, and the start of each tile in it.

    The combinations are numbered with the last touch's strength changing first.
    """
    each = np.indices(counts).reshape(len(counts), -1)
    tile = np.ravel_multi_index(tuple(each // SIDE), tuple(-(-n // SIDE) for n in counts))
    order = np.argsort(tile, kind="stable")
    starts = np.flatnonzero(np.diff(tile[order], prepend=-1))
    return order, starts


def posterior_of_tiles(known: Templates, tiles: Integer, measured: Array) -> Array:
    """Result of `posterior` with a relative error of NEGLIGIBLE times the number of tiles.

    tiles: index of the first template of each, ascending; each tile has one answer.
    """
    balls = _balls(known, tiles)
    step = max(1, AT_ONCE // len(tiles))
    parts = [measured[k : k + step] for k in range(0, len(measured), step)]
    return np.concatenate([_posterior_of_tiles(known, tiles, balls, part) for part in parts])


def _balls(known: Templates, tiles: Integer) -> Balls:
    ends = np.append(tiles[1:], len(known.chance))
    middle = known.readings[(tiles + ends) // 2]
    away = known.readings - np.repeat(middle, ends - tiles, axis=0)
    radius = np.sqrt(np.maximum.reduceat((away**2).sum(axis=1), tiles))
    return Balls(middle, radius, np.add.reduceat(known.chance, tiles))


def _posterior_of_tiles(known: Templates, tiles: Integer, balls: Balls, measured: Array) -> Array:
    near, lower_bound = _near(known, tiles, balls, measured)
    ends = np.append(tiles[1:], len(known.chance))
    answers = np.searchsorted(known.starts, tiles, side="right") - 1
    prior = known.prior
    own = (measured**2).sum(axis=1) / 2 + lower_bound
    total = np.zeros((len(known.starts), len(measured)))
    for tile in np.flatnonzero(near.any(axis=1)).tolist():
        rows, part = np.flatnonzero(near[tile]), slice(tiles[tile], ends[tile])
        likely = measured[rows] @ known.readings[part].T + prior[part] - own[rows, None]
        total[answers[tile], rows] += np.exp(likely).sum(axis=1)
    return (total / total.sum(axis=0)).T


def _near(known: Templates, tiles: Integer, balls: Balls, measured: Array) -> tuple[Mask, Array]:
    """Tiles to evaluate, shape (tile, reading), and a lower bound of the log likelihood."""
    ends = np.append(tiles[1:], len(known.chance))
    squared = (balls.middle**2).sum(axis=1)[:, None] + (measured**2).sum(axis=1)
    squared -= 2 * balls.middle @ measured.T
    np.maximum(squared, 0.0, out=squared)
    with np.errstate(divide="ignore"):
        middle, whole = np.log(known.chance[(tiles + ends) // 2]), np.log(balls.chance)
    lower_bound = (middle[:, None] - squared / 2).max(axis=0)
    gap = np.maximum(np.sqrt(squared) - balls.radius[:, None], 0.0)
    return whole[:, None] - gap**2 / 2 > lower_bound + math.log(NEGLIGIBLE), lower_bound
