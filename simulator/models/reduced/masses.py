"""M of a skin as a sum over its pixels, each weighed by its capacitance over that at rest."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix

from ...fem.assembly import fill
from ...fem.pattern import DROPPED
from ...fem.system import PixelSystem
from ...scene.scene import Scene

ROUNDING = 1e-14


class PixelMasses:
    """M of each pixel at rest, in the pattern of a system and among the unknowns of a space."""

    def __init__(self, system: PixelSystem, order: int, scene: Scene) -> None:
        """order: of the space, see `Galerkin`."""
        self._system, self._order = system, order
        pixels, c = scene.pixels, scene.skin.foam.rest_capacitance_per_area
        parts = list(_parts(system, c, pixels.rows * pixels.columns))
        slots, values = ([part[k] for part in parts] for k in (0, 1))
        self._values = csc_matrix(
            (
                np.concatenate(values),
                np.concatenate(slots),
                np.cumsum([0, *(len(each) for each in slots)]),
            ),
            shape=(len(system.pattern.indices), len(parts)),
        )

    def mass(self, factors: NDArray[np.float64]) -> csc_matrix:
        """M in F, in the system's pattern. factors: c over that at rest, shape (row, column)."""
        return self._system.pattern.matrix(self._values @ factors.ravel())

    def factors(self, W: NDArray[np.float64]) -> NDArray[np.float64]:
        """F of each pixel, W'MW = F'F in F, shape (pixel, rank, k), filled up with zeros.

        W: V, shape (inner + terminals of the space, k).
        """
        found = [pixel.factor(W) for pixel in self._pixels]
        rank = max(len(F) for F in found)
        return np.stack([np.pad(F, ((0, rank - len(F)), (0, 0))) for F in found])

    @cached_property
    def _pixels(self) -> list[_Pixel]:
        system, values = self._system, self._values
        terminals = system.pattern.size - system.unknowns.inner
        kept = np.append(system.unknowns.degree <= self._order, np.ones(terminals, dtype=bool))
        number = np.where(kept, np.cumsum(kept) - 1, DROPPED)
        rows = number[system.pattern.indices]
        columns = number[np.repeat(np.arange(system.pattern.size), np.diff(system.pattern.indptr))]
        ends = values.indptr
        slots = [values.indices[a:b] for a, b in zip(ends[:-1], ends[1:], strict=True)]
        entries = [
            np.asarray(values.data[a:b], dtype=np.float64)
            for a, b in zip(ends[:-1], ends[1:], strict=True)
        ]
        return [
            _pixel(rows[each], columns[each], value)
            for each, value in zip(slots, entries, strict=True)
        ]


@dataclass(frozen=True)
class _Pixel:
    """own: the space's unknowns that a pixel has. mass: M of those in F, shape (own, own)."""

    own: NDArray[np.int64]
    mass: csc_matrix

    def factor(self, W: NDArray[np.float64]) -> NDArray[np.float64]:
        """F with W'MW = F'F, of no more rows than columns."""
        W = W[self.own]
        if len(W) <= W.shape[1]:
            return self._root @ W
        return _root(W.T @ (self.mass @ W))

    @cached_property
    def _root(self) -> NDArray[np.float64]:
        return _root(self.mass.toarray())


def _pixel(
    rows: NDArray[np.int64], columns: NDArray[np.int64], values: NDArray[np.float64]
) -> _Pixel:
    """Of values at rows and columns of a space, DROPPED where they are not in it."""
    kept = (rows != DROPPED) & (columns != DROPPED)
    own, place = np.unique(np.stack([rows[kept], columns[kept]]), return_inverse=True)
    mass = csc_matrix((values[kept], tuple(place.reshape(2, -1))), shape=(len(own), len(own)))
    return _Pixel(own.astype(np.int64), mass)


def _root(M: NDArray[np.float64]) -> NDArray[np.float64]:
    """F with M = F'F to rounding, of as few rows as that needs."""
    power, turn = np.linalg.eigh(M)
    kept = power > ROUNDING * power[-1]
    return np.sqrt(power[kept])[:, None] * turn[:, kept].T


def _parts(
    system: PixelSystem, capacitance: float, pixels: int
) -> Iterator[tuple[NDArray[np.int64], NDArray[np.float64]]]:
    """Slots of each pixel in the system's pattern, and values of M there. capacitance: F/m²."""
    cells = len(system.element_pixel)
    group_of, weights = np.empty(cells, dtype=np.int64), np.empty(cells)
    for number, group in enumerate(system.groups):
        group_of[group.cells], weights[group.cells] = number, capacitance * group.mass_weights
    of_cell = [np.kron(system.coupling, group.mass).reshape(1, -1) for group in system.groups]
    values = np.zeros(len(system.pattern.indices))
    for pixel in range(pixels):
        own = np.flatnonzero(system.element_pixel == pixel)
        for number in np.unique(group_of[own]):
            here = own[group_of[own] == number]
            fill(values, system.slots[here], weights[here][:, None], of_cell[number])
        slots = np.unique(system.slots[own])
        slots = slots[slots != DROPPED]
        yield slots, values[slots]
        values[slots] = 0.0
