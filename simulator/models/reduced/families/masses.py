"""M of a skin as a sum over parts of the foam and of what surrounds it, see `Parts`."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from copy import copy
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix, csr_matrix

from ....arrays import Integer, Real
from ....fem.assembly import DROPPED
from ....fem.system import System
from ....press.parts import Parts

ROUNDING = 1e-14
Part = tuple[Integer, Real]
"""Slots in a system's pattern, and values of M there in F."""


def taken(values: Real, slots: Integer) -> Part:
    """Values that were added at slots; they are reset to 0."""
    own = np.unique(slots)
    own = own[own != DROPPED]
    added = values[own]
    values[own] = 0.0
    return own, added


class Masses:
    """M of each unpressed part, in a system's pattern and for the unknowns of a space."""

    def __init__(self, system: System, order: int, parts: Iterable[Part]) -> None:
        """order: order of the space, see `Galerkin`."""
        self._system, self._order = system, order
        slots, values = map(list, zip(*parts, strict=True))
        self._values = csc_matrix(
            (
                np.concatenate(values),
                np.concatenate(slots),
                np.cumsum([0, *(len(each) for each in slots)]),
            ),
            shape=(len(system.pattern.indices), len(slots)),
        )
        self._by_slot = self._values.tocsr()

    def mass(self, factors: NDArray) -> csc_matrix:
        """M in F, in the system's pattern. factors: amount of each part, shape (part,)."""
        return self._system.pattern.matrix(self._by_slot @ factors)

    def at(self, entries: Integer | slice) -> csr_matrix:
        """Values of M at some entries of the system's pattern, F, shape (entry, part)."""
        return self._by_slot[entries]

    def factors(self, W: Real, size: Real, share: float, parts: Parts) -> Real:
        """F of each part that a press may change, W'MW = F'F in F, shape (part, rank, k).

        W: V, shape (inner + terminals of the space, k). size, share: see `thinned`.
        """
        touched = self._parts[: parts.touched]
        return compressed_factors([part.factor(W) for part in touched], size, share, parts)

    def energies(self, W: Real, which: slice = slice(None)) -> Iterator[Real]:
        """W'MW in F of some parts, shape (k, k); it may be indefinite. W: see `factors`."""
        return (W[part.own].T @ (part.mass @ W[part.own]) for part in self._parts[which])

    def plus(self, weights: Real, others: Sequence[Masses]) -> Masses:
        """Sum of these and of others, each by its weight, in each part."""
        found = copy(self)
        found.__dict__.pop("_parts", None)
        for weight, other in zip(weights, others, strict=True):
            found._values = csc_matrix(found._values + weight * other._values)
        found._by_slot = found._values.tocsr()
        return found

    @cached_property
    def _parts(self) -> list[_Part]:
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
            _part(rows[each], columns[each], value)
            for each, value in zip(slots, entries, strict=True)
        ]


def compressed_factors(
    factors: Sequence[Real] | Real, size: Real, share: float, parts: Parts
) -> Real:
    """Factors of as few rows as a share of their energy allows, padded with zeros.

    size: of the potentials in each column, V; it scales energies. share: directions with less than
    this share of a factor's largest energy are left out. For the field across a part of the foam,
    and for walls, that is at least the largest energy of the parts of the foam that they belong to.
    """
    each = [_energies(F * size) for F in factors]
    most = np.array([power.max(initial=0.0) for power, _ in each])
    foam, _, across, walls = parts.kind
    if parts.thickness:
        most[across] = np.maximum(most[across], most[foam])
    if parts.walls.count:
        most[walls] = np.maximum(most[walls], most[parts.walls.pairs].max(axis=1))
    found = [
        turn[:, power > share * own].T @ F
        for F, (power, turn), own in zip(factors, each, most, strict=True)
    ]
    rank = max(len(F) for F in found)
    return np.stack([np.pad(F, ((0, rank - len(F)), (0, 0))) for F in found])


def _energies(F: Real) -> tuple[Real, Real]:
    """Energies of a factor's own directions, and these directions."""
    power, turn = np.linalg.eigh(F @ F.T)
    return power, turn


@dataclass(frozen=True)
class _Part:
    """M of one part.

    own: unknowns of the space that the part has. mass: M of those in F, shape (own, own).
    """

    own: Integer
    mass: csc_matrix

    def factor(self, W: Real) -> Real:
        """F with W'MW = F'F, of no more rows than columns."""
        W = W[self.own]
        if len(W) <= W.shape[1]:
            return self._root @ W
        return _root(W.T @ (self.mass @ W))

    @cached_property
    def _root(self) -> Real:
        return _root(self.mass.toarray())


def _part(rows: Integer, columns: Integer, values: Real) -> _Part:
    """Part from values at rows and columns of a space, which are DROPPED outside it."""
    kept = (rows != DROPPED) & (columns != DROPPED)
    own, place = np.unique(np.stack([rows[kept], columns[kept]]), return_inverse=True)
    mass = csc_matrix((values[kept], tuple(place.reshape(2, -1))), shape=(len(own), len(own)))
    return _Part(own.astype(np.int64), mass)


def _root(M: Real) -> Real:
    """F with M = F'F to rounding, of as few rows as that needs; none for a part without skin."""
    power, turn = np.linalg.eigh(M)
    kept = power > ROUNDING * power.max(initial=0.0)
    return np.sqrt(power[kept])[:, None] * turn[:, kept].T
