"""Posterior of answers with very many strengths of two touches, without negligible templates.

Templates of neighbouring strengths form tiles. A tile is inside a ball, and the distance of the
ball bounds the likelihood of its templates. A tile whose bound is less than NEGLIGIBLE of the
likelihood of some template is skipped.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..arrays import Integer, Mask
from .posterior import AT_ONCE, Array, Templates

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
    return np.concatenate([_posterior(known, tiles, balls, part) for part in parts])


def _balls(known: Templates, tiles: Integer) -> Balls:
    ends = np.append(tiles[1:], len(known.chance))
    middle = known.readings[(tiles + ends) // 2]
    away = known.readings - np.repeat(middle, ends - tiles, axis=0)
    radius = np.sqrt(np.maximum.reduceat((away**2).sum(axis=1), tiles))
    return Balls(middle, radius, np.add.reduceat(known.chance, tiles))


def _posterior(known: Templates, tiles: Integer, balls: Balls, measured: Array) -> Array:
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
