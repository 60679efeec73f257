"""Family of a uniform scene: quadrilaterals that conform to pixels, uniform sheets and foam."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

import numpy as np
from scipy.sparse import csc_matrix

from ....arrays import Real
from ....fem.assembly import EXTRA_ORDER, add_terms, fill, quadrilateral
from ....fem.galerkin import Galerkin
from ....fem.quadrature import CellGeometry, Rule, gauss_rule, mass_terms, stiffness_terms, surface
from ....fem.system import Films, PixelSystem, build_system, conducting, pixel_films
from ....mesh.quadrilaterals import Resolution
from ...parameters import mode_values
from .family import Checking, Family, Weights, resistive
from .masses import Masses, Part, taken

MODE_DEGREE = 6
"""Degree of the polynomial that stands for half a cosine over the skin in one of its cells."""


class UniformFamily(Family):
    """Family on the mesh of a resolution, whose system contains elements of one order more.

    It is separate from `HeterogeneousFamily`, which checks its elements by other ones and
    integrates all terms at the points of a rule. On the trapezoids around ends of foils that would
    cost digits or time.
    """

    mesh: Resolution
    system: PixelSystem

    def _built(self) -> tuple[PixelSystem, int]:
        return build_system(self.skin, self.circuit, self.mesh), self.mesh.order - 1

    def finer(self, weights: Weights) -> Checking:
        """Space of one order more in the same system, and its M."""
        system = self.system if weights is None else self.varied_system(weights)
        return Galerkin(system, self.circuit, self.order + 1), self.mass

    @cached_property
    def masses(self) -> Masses:
        """M of each unpressed part of the foam."""
        pixels, c = self.skin.pixels, self.skin.foam.unpressed_capacitance_per_area
        return Masses(self.system, self.order, _parts(self.system, c, pixels.rows * pixels.columns))

    def masses_in(self, mode: int) -> Masses:
        """M of each part if c of its foam follows one of HALF_WAVES."""
        return Masses(self.system, self.order, self._parts_in(mode)) if mode else self.masses

    @cached_property
    def sheet_terms(self) -> list[csc_matrix]:
        """K in S of each field's sheet in each mode."""
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
        """Term that each contact resistance adds to the films."""
        known = self.circuit, self.system.pixels, self.system.unknowns, self.mesh.order
        return [pixel_films(*known, only=contact) for contact in resistive(self.circuit)]

    def _mode_term(self, conductance: Real, mode: int) -> csc_matrix:
        rule, points, values_of_mode = self._mode_at_points(mode)
        values = np.zeros(len(self.system.pattern.indices))
        terms = stiffness_terms(rule, points, values_of_mode, np.diag(conductance))
        add_terms(values, self.system.slots, terms)
        return self.system.pattern.matrix(values)

    def _parts_in(self, mode: int) -> Iterator[Part]:
        rule, points, values_of_mode = self._mode_at_points(mode)
        system, c = self.system, self.skin.foam.unpressed_capacitance_per_area * values_of_mode
        values = np.zeros(len(system.pattern.indices))
        for pixel in range(self.skin.pixels.rows * self.skin.pixels.columns):
            own = np.flatnonzero(system.pixels.pixel == pixel)
            terms = mass_terms(rule, points.some(own), c[own], system.coupling)
            add_terms(values, system.slots[own], terms)
            yield taken(values, system.slots[own])

    def _mode_at_points(self, mode: int) -> tuple[Rule, CellGeometry, Real]:
        """Mode at the points of a rule that is exact for it, shape (cell, point)."""
        cells, order = self.system.pixels.cells, self.mesh.order
        more = EXTRA_ORDER if cells.twist.any() else MODE_DEGREE
        rule = gauss_rule(quadrilateral(order), 2 * order + more)
        points = surface(cells, rule)
        return rule, points, mode_values(self.skin, points.x, mode + 1)[mode]


def _parts(system: PixelSystem, capacitance: float, pixels: int) -> Iterator[Part]:
    """M of each pixel. capacitance: F/m²."""
    cells = len(system.pixels.pixel)
    group_of, weights = np.empty(cells, dtype=np.int64), np.empty(cells)
    for number, group in enumerate(system.groups):
        group_of[group.cells], weights[group.cells] = number, capacitance * group.mass_weights
    of_cell = [np.kron(system.coupling, group.mass).reshape(1, -1) for group in system.groups]
    values = np.zeros(len(system.pattern.indices))
    for pixel in range(pixels):
        own = np.flatnonzero(system.pixels.pixel == pixel)
        for number in np.unique(group_of[own]):
            here = own[group_of[own] == number]
            fill(values, system.slots[here], weights[here][:, None], of_cell[number])
        yield taken(values, system.slots[own])
