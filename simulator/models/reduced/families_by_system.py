"""The two kinds of families: of uniform skins, and of all others.

Uniform skins have quadrilaterals that conform to pixels. Others have triangles for any outline, or
quadrilaterals for a torn rectangle.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cached_property
from itertools import repeat
from typing import NamedTuple

import numpy as np
from scipy.sparse import csc_matrix

from ...arrays import Integer, Mask, Real
from ...fem.assembly import EXTRA_ORDER, add_terms, fill, quadrilateral
from ...fem.circuit import Circuit
from ...fem.error_estimate import SINGULAR, both
from ...fem.galerkin import Galerkin
from ...fem.quadrature import CellGeometry, Rule, gauss_rule, mass_terms, stiffness_terms, surface
from ...fem.system import Films, PixelSystem, build_system, conducting, films, pixel_films
from ...mesh.domain import Domain
from ...mesh.quadrilaterals import Resolution, pixel_mesh
from ...press.parts import foam_parts
from ...press.pixels import pixel_lines
from ...scene.contacts import Contact
from ...scene.parts import Skin
from ...surroundings.rim import rim_densities
from ..heterogeneous.coefficients import ELECTRODES, PressCoefficients
from ..heterogeneous.elements import Elements, squares, triangles
from ..heterogeneous.materials import Materials, gauged
from ..heterogeneous.pressed_system import (
    PressedSystem,
    add_body,
    add_finger,
    add_foam,
    add_rim,
    add_sheet,
    add_thickness,
    add_wall,
    film_of,
    pressed_system,
)
from ..parameters import mode_values
from .depth_touches import MeshRises
from .family import Checking, Family, Mesh, Part, Triangulation, Weights, taken

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

    def _sheet_terms(self, field: int) -> Iterator[csc_matrix]:
        alone, system = np.diag(self.circuit.conductance)[field], self.system
        yield conducting(alone.tolist(), system.pattern, system.slots, system.groups)
        for mode in range(1, self.modes):
            yield self._mode_term(alone, mode)

    def _film_term(self, contact: Contact) -> Films:
        system = self.system
        return pixel_films(self.circuit, system.pixels, system.unknowns, self.mesh.order, contact)

    def _mode_term(self, conductance: Real, mode: int) -> csc_matrix:
        rule, points, values_of_mode = self._mode_at_points(mode)
        values = np.zeros(len(self.system.pattern.indices))
        terms = stiffness_terms(rule, points, values_of_mode, np.diag(conductance))
        add_terms(values, self.system.slots, terms)
        return self.system.pattern.matrix(values)

    def _masses_of_parts(self, mode: int) -> Iterator[Part]:
        system, c = self.system, self.skin.foam.unpressed_capacitance_per_area
        pixels = self.skin.pixels.rows * self.skin.pixels.columns
        if not mode:
            yield from _uniform_masses(system, c, pixels)
            return
        rule, points, values_of_mode = self._mode_at_points(mode)
        c = c * values_of_mode
        values = np.zeros(len(system.pattern.indices))
        for pixel in range(pixels):
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


def _uniform_masses(system: PixelSystem, capacitance: float, pixels: int) -> Iterator[Part]:
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


NOTHING: Part = (np.zeros(0, dtype=np.int64), np.zeros(0))
"""M of a part that does not exist."""


class HeterogeneousFamily(Family):
    """Family whose coefficients vary in the cells, checked by elements of one order more.

    Its cells are triangles, or quadrilaterals that conform to lines of the maps, which narrow
    towards tears: there triangles would be too many. The order of either mesh is that of the
    elements.
    """

    system: PressedSystem

    def _built(self) -> tuple[PressedSystem, int]:
        elements = self.elements
        return pressed_system(self.circuit, elements, self._coefficients), elements.order

    @property
    def domain(self) -> Domain:
        """The triangles."""
        assert isinstance(self.mesh, Triangulation)
        return self.mesh.domain

    @property
    def elements(self) -> Elements:
        """Elements of the discretisation."""
        return self._cells.elements

    @cached_property
    def rises(self) -> MeshRises:
        """Rises of c by touches that spread, at the points of the elements."""
        c = self._coefficients.capacitance(self.elements.surface.x)
        return MeshRises(self.touches, self.elements, self.domain, self._part_of, c)

    @cached_property
    def _cells(self) -> _Cells:
        return _cells_of(self.skin, self.circuit, self.mesh)

    @cached_property
    def _coefficients(self) -> PressCoefficients:
        unpressed = np.ones(self.elements.cells)
        return PressCoefficients(Materials(self.skin), unpressed, None, self.circuit.fields)

    @property
    def far(self) -> Real | None:
        """Low-rank factor of M by solved surroundings, see `LowRankMass`; None without these."""
        return self.system.far

    def finer(self, weights: Weights) -> Checking:
        """Space of one order more on the same mesh, and its M."""
        return self._finer.space_of(weights), self._finer.mass

    def estimated(self, difference: Real) -> Real:
        """Estimated error from the difference of two orders, safe for singularities."""
        return self._cells.safety * both(difference)

    def _sheet_terms(self, field: int) -> Iterator[csc_matrix]:
        x = self.elements.surface.x
        S = self._coefficients.conductance(field, x)
        for mode in mode_values(self.skin, x, self.modes):
            for within in self._cells_of_parts if gauged(self.skin) else [None]:
                yield self._sheet_term(field, S * mode, within)

    def _film_term(self, contact: Contact) -> Films:
        unknowns, known = self.system.unknowns, (self.circuit, self.elements, self._coefficients)
        return films(self.circuit, unknowns, film_of(*known, unknowns, only=contact))

    @cached_property
    def _finer(self) -> HeterogeneousFamily:
        mesh = replace(self.mesh, order=self.mesh.order + 1)
        return HeterogeneousFamily(self.skin, self.circuit, mesh, self.modes, self.touches)

    def _sheet_term(self, field: int, S: Real, within: Mask | None) -> csc_matrix:
        values, alone = np.zeros(len(self.system.pattern.indices)), self.circuit.field_alone(field)
        add_sheet(values, alone, self.elements, self.system.unknowns, S, within)
        return self.system.pattern.matrix(values)

    @property
    def _cells_of_parts(self) -> list[Mask]:
        return [self._part_of == part for part in range(foam_parts(self.skin))]

    @cached_property
    def _part_of(self) -> Integer:
        """Part of the foam that each cell belongs to, shape (cell,)."""
        pixel, (rows, columns) = self._cells.pixel, self.skin.pixels.shape
        return np.where(pixel < 0, rows * columns, pixel)

    def _masses_of_parts(self, mode: int) -> Iterator[Part]:
        """M of each part; around the foam parts have no modes but the mean.

        A finger's part is for each F, a wall's for an excess of 1, all others are the scene's own.
        """
        x, unknowns, parts = self.elements.surface.x, self.system.unknowns, self.parts
        c = self._coefficients.capacitance(x) * mode_values(self.skin, x, mode + 1)[mode]
        values = np.zeros(len(self.system.pattern.indices))
        for within in self._cells_of_parts:
            add_foam(values, self.circuit.coupling, self.elements, unknowns, c, within)
            yield taken(values, unknowns.slots[within])
        if mode:
            yield from repeat(NOTHING, parts.count - parts.foam)
            return
        for add in self._around():
            add(values)
            slots = np.flatnonzero(values)
            yield slots, values[slots]
            values[slots] = 0.0

    def _around(self) -> Iterator[Callable[[Real], None]]:
        """Functions that add each part around the foam to values in the pattern."""
        surroundings, parts, cells = self.skin.around, self.parts, self._cells_of_parts
        where = self.elements, self.system.unknowns, self._coefficients.materials
        if surroundings is None:
            return
        touched = self.circuit.field_alone(ELECTRODES.index(surroundings.touched))
        for share in (within.astype(float) for within in cells[: parts.fingers]):
            if share.any():
                yield lambda M, share=share: add_finger(M, touched, 1.0, share, *where)
            else:
                yield lambda M: None
        along = self._coefficients.along(self.elements.surface.x)
        for within in cells[: parts.thickness]:
            yield lambda M, within=within: add_thickness(M, along, *where, within)
        if parts.walls.count:
            facets, one, other = self.elements.across(self._part_of)
            ends = np.stack([np.minimum(one, other), np.maximum(one, other)], axis=1)
            for own in (facets[(ends == pair).all(axis=1)] for pair in parts.walls.pairs):
                yield lambda M, own=own: add_wall(M, own, 1.0, *where)
        for body in surroundings.body:
            yield lambda M, body=body: add_body(M, self.circuit, body, *where)
        if surroundings.rim is not False:
            rim = rim_densities(self.skin)
            yield lambda M: add_rim(M, rim, *where)
        if surroundings.solved:  # `Family.far`, which has no place in the pattern
            yield lambda M: None


class _Cells(NamedTuple):
    """Cells of a mesh.

    pixel: number of each cell's pixel, negative beyond all pixels, shape (cell,). safety: factor on
    the estimated error.
    """

    elements: Elements
    pixel: Integer
    safety: float


def _cells_of(skin: Skin, circuit: Circuit, mesh: Mesh) -> _Cells:
    if isinstance(mesh, Triangulation):
        return _Cells(triangles(mesh.domain, mesh.order, skin), mesh.domain.pixel, SINGULAR)
    pixels = pixel_mesh(skin, circuit.contacts, mesh)
    x, y = pixels.cells.p[:, pixels.cells.t].mean(axis=1)
    lines = [pixel_lines(skin, axis)[1:-1] for axis in (0, 1)]
    column, row = np.searchsorted(lines[0], x), np.searchsorted(lines[1], y)
    return _Cells(squares(pixels, mesh.order), row * skin.pixels.columns + column, 1.0)
