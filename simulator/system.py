"""The discretised skin: K and M(c) over inner unknowns and terminals, in one sparsity pattern."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix
from skfem.assembly import Dofs

from simulator.assembly import (
    Group,
    element_pairs,
    fill,
    groups,
    quadrilateral,
    reference_matrices,
)
from simulator.circuit import Circuit, Terminal
from simulator.mesh import PixelMesh, Resolution, pixel_mesh
from simulator.pattern import DROPPED, Pattern, pattern_of_pairs
from simulator.scene import Contact, Scene


@dataclass(frozen=True)
class Films:
    """Contact resistance: each foil's film conducts in proportion to V - U, sheet over foil.

    With V = w + at_foils U the current of all films is B w + C U, and their power w'Bw + 2 w'CU +
    U'DU. C and D are zero but where foils meet, so that a thin film is no small difference of large
    numbers.

    stiffness: B in S, sparse, in K's pattern. current: C in S, shape (inner + terminals,
    terminals). conductance: D in S, shape (terminals, terminals).
    """

    stiffness: csc_matrix
    current: NDArray[np.float64]
    conductance: NDArray[np.float64]


@dataclass(frozen=True)
class System:
    """(K + B + s M(c)) u = b, with each terminal's potential as one unknown.

    Unknowns are the inner ones, 0 .. inner - 1, then one per terminal of the circuit.

    one: inner coefficients of 1 V all over a field, shape (inner, field). at_foils: coefficients of
    1 V under the foils of each terminal, 0 V elsewhere, shape (inner + terminals, terminals).
    sheets: K in S, the sheets' conductance, shape (inner + terminals, inner + terminals). degree:
    the order from which on elements have each inner unknown, shape (inner,); the bases of orders
    above two are nested. slots: where in the pattern's values each pair of a cell's unknowns goes,
    shape (cell, pair). coupling: how s c enters between fields, shape (field, field).
    """

    inner: int
    one: NDArray[np.float64]
    at_foils: NDArray[np.float64]
    sheets: csc_matrix
    films: Films
    pattern: Pattern
    slots: NDArray[np.int64]
    degree: NDArray[np.int64]
    coupling: NDArray[np.float64]
    groups: list[Group]
    element_pixel: NDArray[np.int64]

    @cached_property
    def stiffness(self) -> csc_matrix:
        """K + B in S, in the pattern of K."""
        return self.pattern.matrix(self.sheets.data + self.films.stiffness.data)

    def mass(self, c: NDArray[np.float64]) -> csc_matrix:
        """M(c) in F, in the pattern of K. c: F/m², shape (row, column)."""
        values = np.zeros(len(self.pattern.indices))
        c_of_cell = c.ravel()[self.element_pixel]
        for group in self.groups:
            weights = (group.mass_weights * c_of_cell[group.cells])[:, None]
            fill(values, self.slots[group.cells], weights, _both(self.coupling, group.mass))
        return self.pattern.matrix(values)


def build_system(scene: Scene, circuit: Circuit, resolution: Resolution) -> System:
    """The system of a scene's circuit at a resolution: all that does not depend on the press."""
    contacts = [contact for terminal in circuit.terminals for contact in terminal.contacts]
    pixels = pixel_mesh(scene, contacts, resolution)
    dofs = Dofs(pixels.mesh, quadrilateral(resolution.order))
    one = _constant(dofs, resolution.order)
    unknown, inner, degree = _number(circuit, pixels, dofs, one)
    pairs = element_pairs(np.concatenate([field[dofs.element_dofs] for field in unknown]))
    pattern, slots = pattern_of_pairs(*pairs, size=inner + len(circuit.terminals))
    cells = groups(pixels.cells, resolution.order)
    under = _under_terminals(circuit, pixels, dofs, one, unknown, pattern.size)
    at_foils = _at_foils(under, inner)
    return System(
        inner=inner,
        one=_on_fields(one, unknown, inner),
        at_foils=at_foils,
        sheets=conducting(circuit.conductance, pattern, slots, cells),
        films=_films(circuit, pixels, pattern, slots, resolution.order, under, at_foils),
        pattern=pattern,
        slots=slots,
        degree=degree,
        coupling=circuit.coupling,
        groups=cells,
        element_pixel=pixels.pixel,
    )


def _both(fields: NDArray[np.float64], *matrices: NDArray[np.float64]) -> NDArray[np.float64]:
    """Matrices of one field spread over all fields, one row each, shape (matrix, local²)."""
    local = np.stack(matrices)[:, None, :, None, :]
    return (fields[:, None, :, None] * local).reshape(len(matrices), -1)


def _constant(dofs: Dofs, order: int) -> NDArray[np.float64]:
    """Coefficients of the function 1: nodal up to order 2, hierarchical from order 3."""
    if order <= 2:
        return np.ones(dofs.N)
    one = np.zeros(dofs.N)
    one[_vertices(dofs)] = 1.0
    return one


def _vertices(dofs: Dofs) -> NDArray[np.int64]:
    return np.asarray(dofs.nodal_dofs).ravel()


def _number(
    circuit: Circuit, pixels: PixelMesh, dofs: Dofs, one: NDArray[np.float64]
) -> tuple[NDArray[np.int64], int, NDArray[np.int64]]:
    """The unknown of each field's coefficients, shape (field, coefficient); how many are inner, and
    from which order on elements have each of those.

    Under an ideal foil the trace is constant: coefficients of 1 are the terminal's unknown, the
    others vanish and are dropped.
    """
    free = DROPPED - 1
    unknown = np.full((circuit.fields, dofs.N), free, dtype=np.int64)
    owner = np.full_like(unknown, DROPPED)
    for index, terminal in enumerate(circuit.terminals):
        held = _held(terminal, pixels, dofs)
        unknown[terminal.field, held] = DROPPED
        owner[terminal.field, held[one[held] == 1]] = index
    degree = np.tile(_degree(dofs), (circuit.fields, 1))[unknown == free]
    inner = len(degree)
    unknown[unknown == free] = np.arange(inner)
    unknown[owner != DROPPED] = inner + owner[owner != DROPPED]
    return unknown, inner, degree


def _degree(dofs: Dofs) -> NDArray[np.int64]:
    degree = np.ones(dofs.N, dtype=np.int64)
    along_edge = np.asarray(dofs.facet_dofs)
    inside = np.asarray(dofs.interior_dofs)
    per_edge = np.arange(len(along_edge)) + 2
    degree[along_edge] = per_edge[:, None]
    degree[inside] = np.maximum.outer(per_edge, per_edge).reshape(-1, 1)[: len(inside)]
    return degree


def _held(terminal: Terminal, pixels: PixelMesh, dofs: Dofs) -> NDArray[np.int64]:
    if not terminal.contacts:
        return _vertices(dofs)[:1]
    ideal = [contact for contact in terminal.contacts if contact.ideal]
    return _under(ideal, pixels, dofs)


def _under(contacts: list[Contact], pixels: PixelMesh, dofs: Dofs) -> NDArray[np.int64]:
    """Coefficients of a field that are not zero under some foil."""
    if not contacts:
        return np.empty(0, dtype=np.int64)
    facets = np.concatenate([pixels.facets(contact) for contact in contacts])
    return dofs.get_facet_dofs(facets).flatten()


def _on_fields(
    one: NDArray[np.float64], unknown: NDArray[np.int64], inner: int
) -> NDArray[np.float64]:
    spread = np.zeros((inner, len(unknown)))
    for field, indices in enumerate(unknown):
        is_inner = (indices >= 0) & (indices < inner)
        spread[indices[is_inner], field] = one[is_inner]
    return spread


def _under_terminals(
    circuit: Circuit,
    pixels: PixelMesh,
    dofs: Dofs,
    one: NDArray[np.float64],
    unknown: NDArray[np.int64],
    size: int,
) -> NDArray[np.float64]:
    """1 V under the resistive foils of each terminal, whosever unknown that is there."""
    under = np.zeros((size, len(circuit.terminals)))
    for index, terminal in enumerate(circuit.terminals):
        resistive = [contact for contact in terminal.contacts if not contact.ideal]
        coefficients = _under(resistive, pixels, dofs)
        indices = unknown[terminal.field, coefficients]
        under[indices[indices != DROPPED], index] = one[coefficients[indices != DROPPED]]
    return under


def _at_foils(under: NDArray[np.float64], inner: int) -> NDArray[np.float64]:
    """Where foils meet the sheet is lifted to the first of them; terminals are at their own 1 V."""
    first = np.cumsum(under != 0, axis=1) == 1
    at_foils = np.where(first, under, 0.0)
    at_foils[inner:] = np.eye(under.shape[1])
    return at_foils


def conducting(
    conductance: Sequence[float], pattern: Pattern, slots: NDArray[np.int64], cells: list[Group]
) -> csc_matrix:
    """K in S of sheets of such conductances in S, one for each field."""
    values = np.zeros(len(pattern.indices))
    for group in cells:
        reference = _both(np.diag(conductance), *group.stiffness)
        fill(values, slots[group.cells], group.stiffness_weights, reference)
    return pattern.matrix(values)


def _films(
    circuit: Circuit,
    pixels: PixelMesh,
    pattern: Pattern,
    slots: NDArray[np.int64],
    order: int,
    under: NDArray[np.float64],
    at_foils: NDArray[np.float64],
) -> Films:
    stiffness = np.zeros(len(pattern.indices))
    current, conductance = np.zeros_like(at_foils), np.zeros((at_foils.shape[1],) * 2)
    for index, terminal in enumerate(circuit.terminals):
        if all(contact.ideal for contact in terminal.contacts):
            continue
        film = _film(terminal, circuit, pixels, pattern, slots, order)
        step = at_foils.copy()
        step[:, index] -= under[:, index]
        stiffness += film.data
        current += film @ step
        conductance += step.T @ (film @ step)
    return Films(pattern.matrix(stiffness), current, conductance)


def _film(
    terminal: Terminal,
    circuit: Circuit,
    pixels: PixelMesh,
    pattern: Pattern,
    slots: NDArray[np.int64],
    order: int,
) -> csc_matrix:
    """The form of (V - U)² / r_c along the foils of one terminal."""
    on_field = np.zeros((circuit.fields, circuit.fields))
    on_field[terminal.field, terminal.field] = 1.0
    of_fields = _both(on_field, *reference_matrices(order).edge_mass)
    values = np.zeros(len(pattern.indices))
    for contact in terminal.contacts:
        if not contact.ideal:
            element, lengths = pixels.edges(pixels.facets(contact))
            fill(values, slots[element], lengths / contact.resistance, of_fields)
    return pattern.matrix(values)
