"""Walls around the touches of a reduced skin, and their slopes by the adjacent factors."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...arrays import Complex, Integer, Real
from ...press.walls import NO_WALL
from .reduced_skin import ReducedSkin


class TouchedWalls(NamedTuple):
    """Walls around each touch of presses with equally many touches, shape (press, touch, most).

    parts: of M, an arbitrary one if a touch has fewer walls. rises: 0 there, and if another touch
    of the press has the same wall. slopes: derivative of its rise by that of the touch, over the
    unpressed c there.
    """

    parts: Integer
    rises: Real
    slopes: Real


def walls_around(skin: ReducedSkin, cells: Integer, rises: Real) -> TouchedWalls | None:
    """Walls around touches of shape (press, touch); None if the scene has none."""
    parts, walls, rest = skin.parts, skin.parts.walls, skin.unpressed_factors
    if not walls.count:
        return None
    factor = np.ones((len(cells), parts.touched))
    np.add.at(factor, (np.arange(len(cells))[:, None], cells), rises)
    own = np.where((cells < parts.foam)[..., None], walls.of(cells), NO_WALL)
    wall, there = np.maximum(own, 0), own != NO_WALL
    one, other = np.moveaxis(walls.pairs[wall], -1, 0)
    adjacent = np.where(one == cells[..., None], other, one)
    press = np.arange(len(cells))[:, None, None]
    here = np.where(there, factor[press, cells[..., None]], 1.0)
    over = np.where(there, factor[press, adjacent], 1.0)
    each = own.reshape(len(cells), -1)
    again = np.tril(each[:, :, None] == each[:, None, :], -1).any(axis=2).reshape(own.shape)
    number = parts.kind[3].start + wall
    unpressed = rest[number] / rest[np.minimum(cells, parts.foam - 1)][..., None]
    return TouchedWalls(
        number,
        np.where(there & ~again, parts.wall(here, over), 0.0),
        np.where(there, parts.wall_slope(here, over) * unpressed, 0.0),
    )


def with_walls(cells: Integer, rises: Real, walls: TouchedWalls | None) -> tuple[Integer, Real]:
    """Touches, followed by the walls around them."""
    if walls is None:
        return cells, rises
    own, weights = walls.parts.reshape(len(cells), -1), walls.rises.reshape(len(cells), -1)
    return np.hstack([cells, own]), np.hstack([rises, weights])


def by_walls(skin: ReducedSkin, factor: Real, squares: Complex) -> Complex:
    """Share of all walls in the derivatives of u'Mu by each part of the foam, (s, part).

    The derivatives are over the unpressed c of the part. factor: of each part of the foam. squares:
    u'Mu by each wall, shape (s, wall).
    """
    parts, rest = skin.parts, skin.unpressed_factors
    pairs, found = parts.walls.pairs, np.zeros((parts.foam, len(squares)), dtype=np.complex128)
    slopes = parts.wall_slopes(factor) * rest[parts.kind[3], None] / rest[pairs]
    for own, slope in zip(pairs.T, slopes.T, strict=True):
        np.add.at(found, own, slope[:, None] * squares.T)
    return found.T
