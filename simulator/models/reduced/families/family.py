"""Full model of a family: one discretisation for all its skins and presses on its foam.

K is an affine sum of fixed matrices: those of each sheet's conductance in each of its modes, and
those of each film of contact resistance. A skin of the family gives their weights. M is a sum over
parts of the foam: each pixel, and the foam beyond all pixels.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix, csr_matrix

from ....arrays import Complex, Real
from ....fem.circuit import Circuit
from ....fem.error_estimate import Swept
from ....fem.factors import LowRankMass, Mass, without_zeros
from ....fem.galerkin import Galerkin
from ....fem.sweep import swept_with_air
from ....fem.system import Films, System
from ....fem.terminals import Excitation, impedance_with_error
from ....mesh.domain import Domain
from ....mesh.quadrilaterals import Resolution
from ....press.parts import parts_of
from ....scene.contacts import Contact
from ....scene.frequency import Loss
from ....scene.parts import Skin
from ....sweeps import InputError
from ...heterogeneous.materials import gauged, gauges
from ...parameters import HALF_WAVES, Variation, foam_parts, nominal
from ..cases import Case
from .masses import Masses

Weights = Real | None
"""Weights of the terms of K, see `weights_of`; None for the scene's own skin."""
Checking = tuple[Galerkin, Callable[[NDArray], Mass]]
"""Space, and M in F in the pattern of its system, see `Family.mass`."""


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
    """One mesh, the space of the scene's own skin, and the terms of K and M of every skin."""

    def __init__(self, skin: Skin, circuit: Circuit, mesh: Mesh, modes: int) -> None:
        """modes: number of modes of each sheet's conductance, see `parameters.HALF_WAVES`."""
        self.skin, self.circuit, self.mesh, self.modes = skin, circuit, mesh, modes
        self.system, self.order = self._built()
        self.space = Galerkin(self.system, circuit, self.order)

    @abstractmethod
    def _built(self) -> tuple[System, int]:
        """The system of the scene's own skin, and the order of the space, see `Galerkin`."""

    @cached_property
    @abstractmethod
    def sheet_terms(self) -> list[csc_matrix]:
        """K in S of each field's sheet in each mode, in the system's pattern.

        If presses change the sheets, each part of the foam has terms of its own.
        """

    @cached_property
    @abstractmethod
    def film_terms(self) -> list[Films]:
        """Term that each contact resistance adds to the films."""

    @cached_property
    @abstractmethod
    def masses(self) -> Masses:
        """M of each unpressed part of the foam."""

    @abstractmethod
    def masses_in(self, mode: int) -> Masses:
        """M of each part if c of its foam follows one of HALF_WAVES; the first gives `masses`."""

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
        factors: Real,
        rtol: float,
        frequency: Real,
        drives: Sequence[Excitation],
    ) -> tuple[Complex, float]:
        """Z in ohm at frequencies in Hz, shape (interface, frequency), and its estimated error.

        factors: c over the scene's unpressed c, shape (part,). The error is the largest relative
        one of Rs and Cp, estimated by elements of one order more, see `impedance_with_error`.
        """
        spaces = (self.space_of(weights), self.mass), self.finer(weights)
        in_air = np.flatnonzero(parts_of(self.skin).in_air)

        def with_air(factor: complex) -> NDArray:
            found = factors.astype(type(factor))
            found[in_air] *= factor
            return found

        def sweep(around: Real, tolerance: float) -> list[Swept]:
            given = drives, around, loss, bool(factors[in_air].any()), tolerance
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

    def foam_of(self, case: Case) -> Real:
        """Factors of a case's foam, as `mass` takes them."""
        return case.map_on(self.skin)

    @property
    def far(self) -> Real | None:
        """Low-rank factor of M by solved surroundings, see `LowRankMass`; None without these."""
        return None

    def mass(self, factors: NDArray) -> Mass:
        """M in F, in the system's pattern. factors: amount of each part, shape (part,)."""
        return _with_far(self.masses.mass(factors), self.far, factors)

    def mass_inside(self, factors: Real) -> Mass:
        """M in F of the space alone. factors: see `mass`."""
        near = self.space.matrix(self._masses_inside @ factors)
        return _with_far(near, self.far_inside, factors)

    def applied_inside(self, factors: Real) -> csc_matrix | None:
        """What applicators add to `mass_inside`, F; None without any. factors: see `mass`."""
        return None

    @cached_property
    def far_inside(self) -> Real | None:
        """`far` of the space alone."""
        return None if self.far is None else self.space.own(self.far)

    def with_films(self, films: Films, weights: Real, terms: Sequence[Films]) -> Films:
        """Films plus the sum of weights times terms."""
        stiffness, current, conductance = films.stiffness.data, films.current, films.conductance
        for weight, term in zip(weights, terms, strict=True):
            stiffness = stiffness + weight * term.stiffness.data
            current = current + weight * term.current
            conductance = conductance + weight * term.conductance
        return Films(self.system.pattern.matrix(stiffness), current, conductance)

    def _films(self, weights: Real) -> Films:
        return self.with_films(self.system.films, weights - 1, self.film_terms)

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


def _with_far(near: csc_matrix, far: Real | None, factors: NDArray) -> Mass:
    """M with the charges by solved surroundings, whose factor is the last."""
    return near if far is None else LowRankMass(near, factors[-1] ** 0.5 * far)


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
    sheets = _conductances(variation, skin, circuit)
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


def _conductances(variation: Variation, skin: Skin, circuit: Circuit) -> list[Real]:
    top, bottom = variation.top, variation.bottom
    if circuit.fields == 2:
        return [top, bottom]
    if not variation.same_sheets:
        raise InputError("sheets that vary over the skin in different ways need two fields")
    R = np.array(skin.sheet_resistances)
    mean = R.sum() / (R / [top[0], bottom[0]]).sum()
    return [mean * top / top[0]]


def resistive(circuit: Circuit) -> list[Contact]:
    """Contacts that have a film."""
    return [contact for contact in circuit.contacts if not contact.ideal]
