"""The likeliest answer among so many strengths of two touches that most are not worth a look.

Templates of neighbouring strengths form tiles. A tile lies within a ball, so that what its
templates can add to a likelihood is bounded by the distance of the ball; where that is less than
NEGLIGIBLE of what some template adds, none of them is looked at.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .posterior import AT_ONCE, Array, Templates

SIDE = 8
"""Strengths of each touch in a tile."""
NEGLIGIBLE = 1e-12
"""Of a likelihood: what each tile may add that is left out."""


class Balls(NamedTuple):
    """One about each tile: middle (ball, number), radius and all its templates' chance, (ball,)."""

    middle: Array
    radius: Array
    chance: Array


def in_tiles(counts: tuple[int, ...]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Of strengths in all ways, the last touch's changing first: an order in which tiles lie
    together, and where in it each begins."""
    each = np.indices(counts).reshape(len(counts), -1)
    tile = np.ravel_multi_index(tuple(each // SIDE), tuple(-(-n // SIDE) for n in counts))
    order = np.argsort(tile, kind="stable")
    starts = np.flatnonzero(np.diff(tile[order], prepend=-1))
    return order, starts


def posterior_of_tiles(known: Templates, tiles: NDArray[np.int64], measured: Array) -> Array:
    """As `posterior`, to NEGLIGIBLE times the number of tiles. tiles: their first templates,
    ascending, each of one answer."""
    balls = _balls(known, tiles)
    step = max(1, AT_ONCE // len(tiles))
    parts = [measured[k : k + step] for k in range(0, len(measured), step)]
    return np.concatenate([_posterior(known, tiles, balls, part) for part in parts])


def _balls(known: Templates, tiles: NDArray[np.int64]) -> Balls:
    ends = np.append(tiles[1:], len(known.chance))
    middle = known.readings[(tiles + ends) // 2]
    away = known.readings - np.repeat(middle, ends - tiles, axis=0)
    radius = np.sqrt(np.maximum.reduceat((away**2).sum(axis=1), tiles))
    return Balls(middle, radius, np.add.reduceat(known.chance, tiles))


def _posterior(known: Templates, tiles: NDArray[np.int64], balls: Balls, measured: Array) -> Array:
    near, least = _near(known, tiles, balls, measured)
    ends = np.append(tiles[1:], len(known.chance))
    answers = np.searchsorted(known.starts, tiles, side="right") - 1
    prior = known.prior
    own = (measured**2).sum(axis=1) / 2 + least
    total = np.zeros((len(known.starts), len(measured)))
    for tile in np.flatnonzero(near.any(axis=1)).tolist():
        asked, part = np.flatnonzero(near[tile]), slice(tiles[tile], ends[tile])
        likely = measured[asked] @ known.readings[part].T + prior[part] - own[asked, None]
        total[answers[tile], asked] += np.exp(likely).sum(axis=1)
    return (total / total.sum(axis=0)).T


def _near(
    known: Templates, tiles: NDArray[np.int64], balls: Balls, measured: Array
) -> tuple[NDArray[np.bool_], Array]:
    """Tiles that count, shape (tile, reading), and ln of what some template at least adds."""
    ends = np.append(tiles[1:], len(known.chance))
    squared = (balls.middle**2).sum(axis=1)[:, None] + (measured**2).sum(axis=1)
    squared -= 2 * balls.middle @ measured.T
    np.maximum(squared, 0.0, out=squared)
    with np.errstate(divide="ignore"):
        middle, whole = np.log(known.chance[(tiles + ends) // 2]), np.log(balls.chance)
    least = (middle[:, None] - squared / 2).max(axis=0)
    gap = np.maximum(np.sqrt(squared) - balls.radius[:, None], 0.0)
    return whole[:, None] - gap**2 / 2 > least + math.log(NEGLIGIBLE), least
