"""Walls between parts of the foam that are pressed to different thickness.

The step between two plates has a capacitance along its wall in addition to straight fields. It
depends on the permittivity and on the thickness on either side.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from ..arrays import Integer, Real
from ..scene.parts import Skin

NO_WALL = -1


@dataclass(frozen=True, eq=False)
class Walls:
    """Pairs of adjacent parts of the foam, the lower number first, shape (wall, 2)."""

    pairs: Integer

    @property
    def count(self) -> int:
        """Number of walls."""
        return len(self.pairs)

    @cached_property
    def around(self) -> Integer:
        """Walls of each part, shape (part, most), padded with NO_WALL."""
        part, wall = self.pairs.ravel(), np.repeat(np.arange(self.count), 2)
        order = np.argsort(part, kind="stable")
        part, wall = part[order], wall[order]
        counts = np.bincount(part)
        place = np.arange(len(part)) - np.repeat(np.cumsum(counts) - counts, counts)
        found = np.full((len(counts), counts.max(initial=0)), NO_WALL)
        found[part, place] = wall
        return found

    def of(self, parts: Integer) -> Integer:
        """Walls of some parts, shape (..., most)."""
        if not self.count:
            return np.zeros((*parts.shape, 0), dtype=np.int64)
        known = np.minimum(parts, len(self.around) - 1)
        return np.where((parts < len(self.around))[..., None], self.around[known], NO_WALL)


NO_WALLS = Walls(np.zeros((0, 2), dtype=np.int64))


def walls_of(skin: Skin, grid: tuple[int, int]) -> Walls:
    """Walls between the parts of a scene's foam on a grid of rows and columns."""
    groups, mesh = skin.pixels.groups, skin.mesh
    if groups is None or mesh is None:
        return _on_grid(*grid)
    return _between_groups(skin)  # pyright: ignore[reportArgumentType]


@lru_cache(maxsize=64)
def _on_grid(rows: int, columns: int) -> Walls:
    cells = np.arange(rows * columns).reshape(rows, columns)
    along = np.stack([cells[:, :-1].ravel(), cells[:, 1:].ravel()], axis=1)
    across = np.stack([cells[:-1].ravel(), cells[1:].ravel()], axis=1)
    return Walls(np.concatenate([along, across]))


@lru_cache(maxsize=16)
def _between_groups(skin: Skin) -> Walls:
    """Walls between pixels that are groups of a mesh's triangles; the part outside all groups is
    last."""
    groups, mesh = skin.pixels.groups, skin.mesh
    assert groups is not None and mesh is not None
    surface = mesh.surface
    names = [name for row in groups for name in row]
    part = np.full(surface.t.shape[1], len(names))
    for number, name in enumerate(names):
        part[surface.triangle_groups.get(name, part[:0])] = number
    edges = np.concatenate([surface.t[[0, 1]], surface.t[[0, 2]], surface.t[[1, 2]]], axis=1)
    _, first, edge = np.unique(edges, axis=1, return_index=True, return_inverse=True)
    own = np.tile(part, 3)
    met = np.sort(np.stack([own[first][edge.ravel()], own], axis=1), axis=1)
    return Walls(np.unique(met[met[:, 0] < met[:, 1]], axis=0).astype(np.int64))


def step_capacitance(ratio: Real | float) -> Real:
    """Capacitance of a step in the gap between two plates beyond straight fields, over eps, per
    metre.

    ratio: of the smaller gap to the larger one, above 0 and up to 1. E = 1/pi [(1 + a²)/a ln((1 +
    a)/(1 - a)) - 2 ln(4 a / (1 - a²))]: 0.2498 for a = 1/2, and 0 for a = 1. Without cancellation
    it is 1/pi [2 ln(1 + b²/(4 a)) + b²/a ln((1 + a)/b)], b = 1 - a. Source: by a conformal map, J.
    R. Whinnery and H. W. Jamieson, Proc. IRE 32 (1944) 98.
    """
    a = np.asarray(ratio, dtype=np.float64)
    b = 1 - a
    walls = np.where(b > 0, b**2 / a * np.log((1 + a) / np.where(b > 0, b, 1.0)), 0.0)
    return (2 * np.log1p(b**2 / (4 * a)) + walls) / np.pi


def step_capacitance_slope(ratio: Real) -> Real:
    """Derivative of `step_capacitance` by the ratio: -(1 - a²)/(pi a²) ln((1 + a)/(1 - a))."""
    a = np.asarray(ratio, dtype=np.float64)
    there = a < 1
    own = np.where(there, a, 0.5)
    slope = -(1 - own**2) / (np.pi * own**2) * np.log((1 + own) / (1 - own))
    return np.where(there, slope, 0.0)
