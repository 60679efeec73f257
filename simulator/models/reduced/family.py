"""A scene discretised once for all skins of a family, and for presses on any of its pixels.

K is a sum of matrices that do not change: of each sheet's conductance in each of its modes, and of
each film of contact resistance; a skin of the family only weighs them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix

from ...fem.assembly import EXTRA_ORDER, fill, quadrilateral
from ...fem.circuit import Circuit
from ...fem.estimate import Swept, checked
from ...fem.galerkin import Galerkin, swept
from ...fem.quadrature import gauss_rule, stiffness_terms, surface
from ...fem.system import Films, PixelSystem, build_system, conducting
from ...mesh.quadrilaterals import Resolution, pixel_mesh
from ...scene.contacts import Contact
from ...scene.frequency import laplace_variable
from ...scene.scene import Scene
from ...sweeps import InputError
from ..parameters import Variation, mode_values
from .masses import PixelMasses

MODE_DEGREE = 6
"""Of the polynomial that half a cosine over the skin is in one of its cells."""


class Family:
    """One mesh, the scene's own space, and the terms that K of every skin is a sum of."""

    def __init__(self, scene: Scene, circuit: Circuit, resolution: Resolution, modes: int) -> None:
        """resolution: its order is one more than that of the space, to check it by.

        modes: of each sheet's conductance, see `variation.WAVES`.
        """
        self.scene, self.circuit, self.resolution, self.modes = scene, circuit, resolution, modes
        self.system = build_system(scene, circuit, resolution)
        self.order = resolution.order - 1
        self.space = Galerkin(self.system, circuit, self.order)

    def skin(self, variation: Variation | None) -> Galerkin:
        """The space of one skin, with factors of its own; of the scene's for None."""
        if variation is None:
            return self.space
        return Galerkin(self.varied(variation), self.circuit, self.order)

    def solved(
        self, variation: Variation | None, factors: NDArray[np.float64], rtol: float
    ) -> tuple[NDArray[np.complex128], float]:
        """Z in ohm at the scene's frequencies, shape (interface, frequency), and its error.

        factors: c over the scene's own at rest, shape (row, column). The error is the largest of Rs
        and Cp, relatively, estimated by elements of one order more as `fidelity` does.
        """
        loss = (variation or self.scene.skin.foam).loss
        frequency = self.scene.frequencies
        system = self.system if variation is None else self.varied(variation)
        spaces = self.skin(variation), Galerkin(system, self.circuit, self.order + 1)
        mass, drives = self.mass(factors), self.circuit.drives

        def sweep(around: NDArray[np.float64], tolerance: float) -> list[Swept]:
            s = laplace_variable(around, loss)
            return [swept(space, mass, drives, s, tolerance) for space in spaces]

        Z, error = checked(sweep, frequency, rtol)
        return Z, float(error.max())

    def varied(self, variation: Variation) -> PixelSystem:
        """The system of one skin."""
        weights = weights_of(variation, self.scene, self.circuit)
        sheets, films = np.split(weights, [len(self.sheet_terms)])
        return replace(
            self.system,
            sheets=self.system.pattern.matrix(sheets @ self._sheet_values),
            films=self._changed(self.system.films, films - 1, self.film_terms),
        )

    def mass(self, factors: NDArray[np.float64]) -> csc_matrix:
        """M in F, in the system's pattern. factors: c over that at rest, shape (row, column)."""
        return self.pixels.mass(factors)

    @cached_property
    def pixels(self) -> PixelMasses:
        """M of each pixel at rest."""
        return PixelMasses(self.system, self.order, self.scene)

    @cached_property
    def sheet_terms(self) -> list[csc_matrix]:
        """K in S of each field's sheet in each mode, in the system's pattern."""
        alone = np.diag(self.circuit.conductance)
        means = [
            conducting(each.tolist(), self.system.pattern, self.system.slots, self.system.groups)
            for each in alone
        ]
        return [
            term
            for field, mean in enumerate(means)
            for term in [mean, *(self._mode_term(alone[field], k) for k in range(1, self.modes))]
        ]

    @cached_property
    def film_terms(self) -> list[Films]:
        """What each contact resistance adds to the films."""
        halved = [self._films_with_half(contact) for contact in self._resistive]
        return [self._changed(films, -np.ones(1), [self.system.films]) for films in halved]

    @cached_property
    def _sheet_values(self) -> NDArray[np.float64]:
        return np.stack([term.data for term in self.sheet_terms]).astype(np.float64)

    @property
    def _resistive(self) -> list[Contact]:
        return _resistive(self.circuit)

    def _mode_term(self, conductance: NDArray[np.float64], mode: int) -> csc_matrix:
        cells = pixel_mesh(self.scene, self.circuit.contacts, self.resolution).cells
        order = self.resolution.order
        more = EXTRA_ORDER if cells.twist.any() else MODE_DEGREE
        rule = gauss_rule(quadrilateral(order), 2 * order + more)
        points = surface(cells, rule)
        wave = mode_values(self.scene, points.x, self.modes)[mode]
        values = np.zeros(len(self.system.pattern.indices))
        for terms in stiffness_terms(rule, points, wave, np.diag(conductance)):
            fill(values, self.system.slots, *terms)
        return self.system.pattern.matrix(values)

    def _films_with_half(self, contact: Contact) -> Films:
        """The films where one contact resistance is half of what it is."""
        half = contact.model_copy(update={"resistance": contact.resistance / 2})
        terminals = tuple(
            replace(
                terminal, contacts=tuple(half if c is contact else c for c in terminal.contacts)
            )
            for terminal in self.circuit.terminals
        )
        circuit = replace(self.circuit, terminals=terminals)
        return build_system(self.scene, circuit, self.resolution).films

    def _changed(self, films: Films, weights: NDArray[np.float64], terms: Sequence[Films]) -> Films:
        """films + sum of weights times terms."""
        stiffness, current, conductance = films.stiffness.data, films.current, films.conductance
        for weight, term in zip(weights, terms, strict=True):
            stiffness = stiffness + weight * term.stiffness.data
            current = current + weight * term.current
            conductance = conductance + weight * term.conductance
        return Films(self.system.pattern.matrix(stiffness), current, conductance)


def weights_of(variation: Variation, scene: Scene, circuit: Circuit) -> NDArray[np.float64]:
    """Of the terms of K: each field's sheet in its modes, then the films; of the scene's own skin
    1 in the mean and for films, 0 in other modes.

    Raises InputError where sheets that vary in different ways are asked of one field.
    """
    names = [contact.name for contact in scene.contacts]
    films = [variation.films[names.index(contact.name)] for contact in _resistive(circuit)]
    return np.concatenate([*_conductances(variation, scene, circuit), films])


def _conductances(
    variation: Variation, scene: Scene, circuit: Circuit
) -> list[NDArray[np.float64]]:
    top, bottom = variation.top, variation.bottom
    if circuit.fields == 2:
        return [top, bottom]
    if not variation.alike:
        raise InputError("sheets that vary over the skin in different ways need two fields")
    R = np.array([scene.skin.top.sheet_resistance, scene.skin.bottom.sheet_resistance])
    mean = R.sum() / (R / [top[0], bottom[0]]).sum()
    return [mean * top / top[0]]


def _resistive(circuit: Circuit) -> list[Contact]:
    return [contact for contact in circuit.contacts if not contact.ideal]
