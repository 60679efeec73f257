"""Full model of a family: one discretisation for all its skins and presses on its foam.

K is an affine sum of fixed matrices: those of each sheet's conductance in each of its modes, and
those of each film of contact resistance. A skin of the family gives their weights. M is a sum over
parts of the foam: each pixel, and the foam beyond all pixels.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix, csr_matrix

from ...arrays import Complex, Integer, Real
from ...fem.assembly import DROPPED
from ...fem.circuit import Circuit
from ...fem.error_estimate import Swept
from ...fem.factors import LowRankMass, Mass, without_zeros
from ...fem.galerkin import Galerkin
from ...fem.sweep import swept_with_air
from ...fem.system import Films, System
from ...fem.terminals import Excitation, impedance_with_error
from ...mesh.domain import Domain
from ...mesh.quadrilaterals import Resolution
from ...press.parts import Parts, parts_of
from ...scene.contacts import Contact
from ...scene.frequency import Loss
from ...scene.parts import Skin
from ...sweeps import InputError
from ..heterogeneous.materials import gauged, gauges
from ..parameters import HALF_WAVES, Variation, foam_parts, nominal, sheet_weights
from .cases import Case
from .touches import FACTORS, Touches

if TYPE_CHECKING:
    from .depth_touches import MeshRises

Weights = Real | None
"""Weights of the terms of K, see `weights_of`; None for the scene's own skin."""
Checking = tuple[Galerkin, Callable[[NDArray], Mass]]
"""Space, and M in F in the pattern of its system, see `Family.mass`."""
Part = tuple[Integer, Real]
"""Slots in a system's pattern, and values of M there in F."""


@dataclass(frozen=True)
class Triangulation:
    """Triangles that conform to pixels and foils, and the order of the elements on them.

    Elements of one order more check the result.
    """

    domain: Domain
    order: int


Mesh = Resolution | Triangulation
"""The order of a resolution is one more than that of the space."""


class Family(ABC):
    """One mesh, the space of the scene's own skin, and the terms of K and M of every skin.

    rises: rises of c by touches that spread, if there are such.
    """

    rises: MeshRises

    def __init__(
        self, skin: Skin, circuit: Circuit, mesh: Mesh, modes: int, touches: Touches = FACTORS
    ) -> None:
        """modes: number of modes of each sheet's conductance, see `parameters.HALF_WAVES`.

        touches: how touches change M.
        """
        self.skin, self.circuit, self.mesh, self.modes = skin, circuit, mesh, modes
        self.touches, self.parts = touches, parts_of(skin)
        self.system, self.order = self._built()
        self.space = Galerkin(self.system, circuit, self.order)

    @abstractmethod
    def _built(self) -> tuple[System, int]:
        """The system of the scene's own skin, and the order of the space, see `Galerkin`."""

    @abstractmethod
    def _sheet_terms(self, field: int) -> Iterable[csc_matrix]:
        """`sheet_terms` of one field."""

    @abstractmethod
    def _film_term(self, contact: Contact) -> Films:
        """Term that a contact resistance adds to the films."""

    @abstractmethod
    def _masses_of_parts(self, mode: int) -> Iterable[Part]:
        """M of each part, see `masses_in`."""

    @cached_property
    def sheet_terms(self) -> list[csc_matrix]:
        """K in S of each field's sheet in each mode, in the system's pattern.

        If presses change the sheets, each part of the foam has terms of its own.
        """
        return [term for field in range(self.circuit.fields) for term in self._sheet_terms(field)]

    @cached_property
    def film_terms(self) -> list[Films]:
        """Term that each contact resistance adds to the films."""
        return [self._film_term(contact) for contact in resistive(self.circuit)]

    @cached_property
    def masses(self) -> Masses:
        """M of each unpressed part."""
        return self.masses_in(0)

    def masses_in(self, mode: int) -> Masses:
        """M of each part if c of its foam follows one of HALF_WAVES; the first gives `masses`."""
        return Masses(self.system, self.order, self._masses_of_parts(mode))

    @cached_property
    def foam_modes(self) -> list[Masses]:
        """M of each part if c of its foam follows each cosine mode but the mean."""
        return [self.masses_in(mode) for mode in range(1, len(HALF_WAVES))]

    @abstractmethod
    def finer(self, weights: Weights) -> Checking:
        """Space of one order more that checks this one, and its M."""

    def estimated(self, difference: Real) -> Real:
        """Estimated error from the difference of two orders, shape (2, interface, frequency)."""
        return difference

    def space_of(self, weights: Weights) -> Galerkin:
        """Space of one skin."""
        if weights is None:
            return self.space
        return Galerkin(self.varied_system(weights), self.circuit, self.order)

    def solved(
        self,
        weights: Weights,
        loss: Loss,
        amounts: Real,
        rtol: float,
        frequency: Real,
        drives: Sequence[Excitation],
    ) -> tuple[Complex, float]:
        """Z in ohm at frequencies in Hz, shape (interface, frequency), and its estimated error.

        amounts: see `Touches.amounts`. The error is the largest relative one of Rs and Cp,
        estimated by elements of one order more, see `impedance_with_error`.
        """
        spaces = (self.space_of(weights), self.mass), self.finer(weights)
        in_air = np.flatnonzero(self.parts.in_air)

        def with_air(factor: complex) -> NDArray:
            found = amounts.astype(type(factor))
            found[in_air] *= factor
            return found

        def sweep(around: Real, tolerance: float) -> list[Swept]:
            given = drives, around, loss, bool(amounts[in_air].any()), tolerance
            return [
                swept_with_air(space, lambda p, mass=mass: mass(with_air(p)), *given)
                for space, mass in spaces
            ]

        Z, error = impedance_with_error(sweep, drives, frequency, rtol)
        return Z, float(self.estimated(error).max())

    def varied_system(self, weights: Real) -> System:
        """System of one skin."""
        sheets, films = np.split(weights, [len(self.sheet_terms)])
        return replace(
            self.system,
            sheets=self.system.pattern.matrix(sheets @ self._sheet_values),
            films=self._films(films),
        )

    def currents(self, weights: Weights, u: Real) -> Real:
        """K u of one skin at the space's inner unknowns, A. u: V, shape (unknown, k)."""
        if weights is None:
            sheets = self.space.restricted(self.system.sheets)
            return self.space.currents(u, sheets, self.system.films)
        of_sheets, of_films = np.split(weights, [len(self.sheet_terms)])
        pattern, values = self._sheets_inside
        sheets = copy(pattern)
        sheets.data = of_sheets @ values
        return self.space.currents(u, sheets, self._films(of_films))

    def amounts(self, case: Case) -> Real:
        """Amount of each part in a case over the scene's own, see `Touches.amounts`."""
        unpressed = 1.0 if case.variation is None else case.variation.factors(self.skin)
        return self.touches.amounts(self.parts, unpressed, case.cells, case.rises)

    @property
    def far(self) -> Real | None:
        """Low-rank factor of M by solved surroundings, see `LowRankMass`; None without these."""
        return None

    def mass(self, amounts: NDArray) -> Mass:
        """M in F, in the system's pattern. amounts: see `Touches.amounts`."""
        near = self.masses.mass(amounts[: self.parts.count])
        added = self.touches.added(self, amounts)
        if added is not None:
            near = self.system.pattern.matrix(near.data + added.data)
        return self._with_far(near, self.far, amounts)

    def mass_inside(self, amounts: Real) -> Mass:
        """M in F of the space alone. amounts: see `mass`."""
        if self.touches.spread:
            return self.space.restricted(self.mass(amounts))
        near = self.space.matrix(self._masses_inside @ amounts)
        return self._with_far(near, self.far_inside, amounts)

    def added_inside(self, amounts: Real) -> csc_matrix | None:
        """What touches add to the parts in `mass_inside`, F; None for nothing."""
        added = self.touches.added(self, amounts)
        return None if added is None else self.space.restricted(added)

    def _with_far(self, near: csc_matrix, far: Real | None, amounts: NDArray) -> Mass:
        """M with the charges by solved surroundings, which are the last part."""
        last = self.parts.count - 1
        return near if far is None else LowRankMass(near, amounts[last] ** 0.5 * far)

    @cached_property
    def far_inside(self) -> Real | None:
        """`far` of the space alone."""
        return None if self.far is None else self.space.own(self.far)

    def _films(self, weights: Real) -> Films:
        """Films of one skin, from the weights of `film_terms`."""
        films = self.system.films
        stiffness, current, conductance = films.stiffness.data, films.current, films.conductance
        for weight, term in zip(weights - 1, self.film_terms, strict=True):
            stiffness = stiffness + weight * term.stiffness.data
            current = current + weight * term.current
            conductance = conductance + weight * term.conductance
        return Films(self.system.pattern.matrix(stiffness), current, conductance)

    @cached_property
    def _sheets_inside(self) -> tuple[csc_matrix, Real]:
        """Matrix of all entries that K of any skin's sheets has in the space, and the terms
        there."""
        values = self._sheet_values[:, self.space.entries]
        there = values.any(axis=0)
        return without_zeros(self.space.matrix(there.astype(float))), values[:, there]

    @cached_property
    def _masses_inside(self) -> csr_matrix:
        return self.masses.at(self.space.entries)

    @cached_property
    def _sheet_values(self) -> Real:
        return np.stack([term.data for term in self.sheet_terms]).astype(np.float64)


def weights_under(
    variation: Variation | None, skin: Skin, circuit: Circuit, modes: int, pressed: Real
) -> Weights:
    """Weights of the terms of K of a skin under touches.

    modes: number of modes of each sheet, see `parameters.HALF_WAVES`. pressed: factors on c by
    touches, shape (part,). Raises InputError as `weights_of` does.
    """
    if not gauged(skin):
        return None if variation is None else weights_of(variation, skin, circuit)
    return weights_of(variation or nominal(skin, modes), skin, circuit, pressed)


def weights_of(
    variation: Variation, skin: Skin, circuit: Circuit, pressed: Real | None = None
) -> Real:
    """Weights of the terms of K: each field's sheet in its modes, then the films.

    The scene's own skin has 1 for the mean and for films, 0 for other modes. pressed: see
    `weights_under`. Raises InputError if sheets vary in different ways and the circuit has one
    field.
    """
    names = [contact.name for contact in skin.contacts]
    films = [variation.films[names.index(contact.name)] for contact in resistive(circuit)]
    if circuit.fields == 1 and not variation.same_sheets:
        raise InputError("sheets that vary over the skin in different ways need two fields")
    of_each = variation.top, variation.bottom
    sheets = sheet_weights(*of_each, *skin.sheet_resistances, circuit.fields)
    if gauged(skin):
        factors = np.ones(foam_parts(skin)) if pressed is None else pressed
        of_parts = gauges(skin, factors)
        sheets = [np.outer(*each).ravel() for each in zip(sheets, of_parts, strict=False)]
    return np.concatenate([*sheets, films])


def changes(
    weights: Weights, skin: Skin, circuit: Circuit, modes: int
) -> tuple[NDArray[np.intp], Real]:
    """Indices of the terms of K whose weights differ from the scene's own, and the differences.

    Without piezoresistance all terms of a varied skin are listed.
    """
    if weights is None:
        return np.zeros(0, dtype=np.intp), np.zeros(0)
    change = weights - weights_of(nominal(skin, modes), skin, circuit)
    changed = np.flatnonzero(change) if gauged(skin) else np.arange(change.size)
    return changed, change[changed]


def resistive(circuit: Circuit) -> list[Contact]:
    """Contacts that have a film."""
    return [contact for contact in circuit.contacts if not contact.ideal]


ROUNDING = 1e-14


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

        W: V, shape (inner + terminals of the space, k). size, share: see `compressed_factors`.
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
