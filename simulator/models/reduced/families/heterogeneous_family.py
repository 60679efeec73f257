"""Families of a heterogeneous scene: any outline on triangles, or a torn rectangle on squares."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import repeat

import numpy as np
from scipy.sparse import csc_matrix

from ....arrays import Integer, Mask, Real
from ....fem.circuit import Circuit
from ....fem.error_estimate import SINGULAR, both
from ....fem.system import Films, films
from ....fem.unknowns import Unknowns
from ....mesh.domain import Domain
from ....mesh.quadrilaterals import PixelMesh, Resolution, pixel_mesh
from ....press.parts import Parts, foam_parts, parts_of
from ....press.pixels import pixel_lines
from ....surroundings.rim import rim_densities
from ...heterogeneous.coefficients import ELECTRODES, PressCoefficients
from ...heterogeneous.elements import Elements, squares, triangles
from ...heterogeneous.materials import Materials, gauged
from ...heterogeneous.pressed_system import (
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
from ...parameters import mode_values
from .family import Checking, Family, Mesh, Triangulation, Weights, resistive
from .masses import Masses, Part, taken

Cells = Sequence[Mask]
"""Masks of the cells in each part of the foam, each of shape (cell,)."""


def around(
    parts: Parts,
    cells: Cells,
    circuit: Circuit,
    elements: Elements,
    unknowns: Unknowns,
    coefficients: PressCoefficients,
) -> Iterator[Part]:
    """Parts of M around an unpressed skin.

    A finger's part is for each F, a wall's for an excess of 1, all others are the scene's own.
    """
    values = np.zeros(len(unknowns.pattern.indices))
    for add in _each(parts, cells, circuit, elements, unknowns, coefficients):
        add(values)
        slots = np.flatnonzero(values)
        yield slots, values[slots]
        values[slots] = 0.0


def _each(
    parts: Parts,
    cells: Cells,
    circuit: Circuit,
    elements: Elements,
    unknowns: Unknowns,
    coefficients: PressCoefficients,
) -> Iterator[Callable[[Real], None]]:
    """Functions that add each part to values in the pattern."""
    materials = coefficients.materials
    skin, where = materials.skin, (elements, unknowns, materials)
    surroundings = skin.around
    if surroundings is None:
        return
    touched = circuit.field_alone(ELECTRODES.index(surroundings.touched))
    for share in (within.astype(float) for within in cells[: parts.fingers]):
        if share.any():
            yield lambda M, share=share: add_finger(M, touched, 1.0, share, *where)
        else:
            yield lambda M: None
    along = coefficients.along(elements.surface.x)
    for within in cells[: parts.thickness]:
        yield lambda M, within=within: add_thickness(M, along, *where, within)
    for facets in _between(parts, cells, elements):
        yield lambda M, facets=facets: add_wall(M, facets, 1.0, *where)
    for body in surroundings.body:
        yield lambda M, body=body: add_body(M, circuit, body, *where)
    if surroundings.rim is not False:
        rim = rim_densities(skin)
        yield lambda M: add_rim(M, rim, *where)
    if surroundings.solved:  # `Family.far`, which has no place in the pattern
        yield lambda M: None


def _between(parts: Parts, cells: Cells, elements: Elements) -> Iterator[Integer]:
    """Facets of each wall."""
    if not parts.walls.count:
        return
    facets, one, other = elements.across(np.argmax(cells, axis=0))
    ends = np.stack([np.minimum(one, other), np.maximum(one, other)], axis=1)
    for pair in parts.walls.pairs:
        yield facets[(ends == pair).all(axis=1)]


NOTHING: Part = (np.zeros(0, dtype=np.int64), np.zeros(0))
"""M of a part that does not exist."""


class HeterogeneousFamily(Family):
    """Family on triangles, checked by other elements of one order more on the same triangles."""

    mesh: Mesh
    system: PressedSystem

    def _built(self) -> tuple[PressedSystem, int]:
        elements = self.elements
        return pressed_system(self.circuit, elements, self._coefficients), elements.order

    @property
    def domain(self) -> Domain:
        """The triangles."""
        assert isinstance(self.mesh, Triangulation)
        return self.mesh.domain

    @cached_property
    def elements(self) -> Elements:
        """Elements of the discretisation."""
        return triangles(self.domain, self.mesh.order, self.skin)

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
        """Estimated error from the difference of two orders, with a safety factor for
        singularities."""
        return SINGULAR * both(difference)

    @cached_property
    def masses(self) -> Masses:
        """M of each unpressed part."""
        return self.masses_in(0)

    def masses_in(self, mode: int) -> Masses:
        """M of each part if c of its foam follows one of HALF_WAVES."""
        mode_at_points = mode_values(self.skin, self.elements.surface.x, mode + 1)[mode]
        return Masses(self.system, self.order, [*self._parts(mode_at_points), *self._around(mode)])

    @cached_property
    def sheet_terms(self) -> list[csc_matrix]:
        """K in S of each field's sheet in each mode.

        If presses change the sheets, each part of the foam has terms of its own.
        """
        x = self.elements.surface.x
        modes = mode_values(self.skin, x, self.modes)
        parts = self._cells_of_parts if gauged(self.skin) else [None]
        return [
            self._sheet_term(field, self._coefficients.conductance(field, x) * mode, within)
            for field in range(self.circuit.fields)
            for mode in modes
            for within in parts
        ]

    @cached_property
    def film_terms(self) -> list[Films]:
        """Term that each contact resistance adds to the films."""
        unknowns, known = self.system.unknowns, (self.circuit, self.elements, self._coefficients)
        return [
            films(self.circuit, unknowns, film_of(*known, unknowns, only=contact))
            for contact in resistive(self.circuit)
        ]

    @cached_property
    def _finer(self) -> HeterogeneousFamily:
        return type(self)(self.skin, self.circuit, self._finer_mesh, self.modes)

    @property
    def _finer_mesh(self) -> Mesh:
        """The mesh with elements of one order more."""
        return replace(self.mesh, order=self.mesh.order + 1)

    def _sheet_term(self, field: int, S: Real, within: Mask | None) -> csc_matrix:
        values, alone = np.zeros(len(self.system.pattern.indices)), self.circuit.field_alone(field)
        add_sheet(values, alone, self.elements, self.system.unknowns, S, within)
        return self.system.pattern.matrix(values)

    @property
    def _cells_of_parts(self) -> list[Mask]:
        pixel, (rows, columns) = self._pixel_of_cell, self.skin.pixels.shape
        part_of = np.where(pixel < 0, rows * columns, pixel)
        return [part_of == part for part in range(foam_parts(self.skin))]

    @property
    def _pixel_of_cell(self) -> Integer:
        """Number of the pixel of each cell, negative beyond all pixels."""
        return self.domain.pixel

    def _around(self, mode: int) -> Iterator[Part]:
        """Parts around the foam; in cosine modes of the foam other than the mean they are empty."""
        parts, unknowns = parts_of(self.skin), self.system.unknowns
        if mode:
            return repeat(NOTHING, parts.count - parts.foam)
        where = self.circuit, self.elements, unknowns, self._coefficients
        return around(parts, self._cells_of_parts, *where)

    def _parts(self, mode_at_points: Real) -> Iterator[Part]:
        elements, unknowns = self.elements, self.system.unknowns
        c = self._coefficients.capacitance(elements.surface.x) * mode_at_points
        values = np.zeros(len(self.system.pattern.indices))
        for within in self._cells_of_parts:
            add_foam(values, self.circuit.coupling, elements, unknowns, c, within)
            yield taken(values, unknowns.slots[within])


class SquaresFamily(HeterogeneousFamily):
    """Family of a heterogeneous rectangle on quadrilaterals that conform to lines of its maps.

    The order of its mesh is that of the elements. Cells narrow towards tears, where triangles
    would be too many.
    """

    mesh: Resolution

    @cached_property
    def elements(self) -> Elements:
        """Elements of the discretisation."""
        return squares(self._squares, self.mesh.order)

    def estimated(self, difference: Real) -> Real:
        """Estimated error from the difference of two orders."""
        return both(difference)

    @cached_property
    def _squares(self) -> PixelMesh:
        return pixel_mesh(self.skin, self.circuit.contacts, self.mesh)

    @property
    def _pixel_of_cell(self) -> Integer:
        cells = self._squares.cells
        x, y = cells.p[:, cells.t].mean(axis=1)
        lines = [pixel_lines(self.skin, axis)[1:-1] for axis in (0, 1)]
        column, row = np.searchsorted(lines[0], x), np.searchsorted(lines[1], y)
        return row * self.skin.pixels.columns + column
