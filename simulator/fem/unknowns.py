"""Numbering of the degrees of freedom: free, tied to a terminal, or eliminated.

Under an ideal foil the trace is constant: coefficients of the function 1 become the terminal's
unknown, the others vanish and are dropped.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from skfem import ElementTriP1, ElementTriP2, ElementTriP3, ElementTriP4, MeshQuad, MeshTri
from skfem.assembly import Dofs

from ..arrays import Integer, Real
from ..scene.contacts import Contact
from .assembly import DROPPED, Pattern, element_pairs, pattern_of_pairs, quadrilateral
from .circuit import Circuit, Terminal

TRIANGLES = (ElementTriP1, ElementTriP2, ElementTriP3, ElementTriP4)


@dataclass(frozen=True)
class TrialSpace:
    """Trial functions of one field.

    one: coefficients of the function 1, shape (coefficient,). degree: the lowest order whose
    elements have each coefficient, shape (coefficient,); 1 everywhere for bases of a single order.
    """

    dofs: Dofs
    one: Real
    degree: Integer

    @property
    def vertices(self) -> Integer:
        """Coefficients of the vertices."""
        return np.asarray(self.dofs.nodal_dofs).ravel()

    def on(self, facets: Integer) -> Integer:
        """Coefficients whose functions are not zero on some of the facets."""
        return self.dofs.get_facet_dofs(facets).flatten()


@dataclass(frozen=True)
class Unknowns:
    """All fields' coefficients numbered: inner ones 0 .. inner - 1, then one per terminal.

    number: DROPPED for none, shape (field, coefficient). degree: of each inner one, shape (inner,).
    one: inner coefficients of 1 V all over a field, shape (inner, field). under: 1 V under the
    resistive foils of each terminal, whichever unknown is there; at_foils: coefficients of 1 V
    under the foils of each terminal, 0 V elsewhere; both of shape (inner + terminals, terminals).
    pattern: of matrices of all unknowns. slots: slot in its values of each pair of a cell's
    coefficients, shape (cell, pair). facing: slots that couple each conductor with a cell's
    coefficients of the field in front of it and back, shape (conductor, 2, cell, local), and its
    own diagonal slot, (conductor,).
    """

    inner: int
    number: Integer
    degree: Integer
    one: Real
    under: Real
    at_foils: Real
    pattern: Pattern
    slots: Integer
    facing: tuple[Integer, Integer]


def quadrilateral_trial(mesh: MeshQuad, order: int) -> TrialSpace:
    """Trial functions on quadrilaterals: nodal up to order 2, hierarchical (nested) from order
    3."""
    dofs = Dofs(mesh, quadrilateral(order))
    one = np.ones(dofs.N)
    if order > 2:
        one = np.zeros(dofs.N)
        one[np.asarray(dofs.nodal_dofs).ravel()] = 1.0
    return TrialSpace(dofs, one, _degree(dofs))


def triangle_trial(mesh: MeshTri, order: int) -> TrialSpace:
    """Nodal trial functions on triangles, of orders 1 to 4."""
    dofs = Dofs(mesh, TRIANGLES[order - 1]())
    return TrialSpace(dofs, np.ones(dofs.N), np.ones(dofs.N, dtype=np.int64))


def number_unknowns(
    circuit: Circuit,
    trial: TrialSpace,
    facets: Callable[[Contact], Integer],
    inside: Callable[[Contact], Integer] | None = None,
) -> Unknowns:
    """Number the unknowns of a circuit.

    facets: those under a foil. inside: the cells under a foil that has a width; without it no foil
    has one.
    """

    def under_all(contacts: Sequence[Contact]) -> Integer:
        if not contacts:
            return np.empty(0, dtype=np.int64)
        found = trial.on(np.concatenate([facets(contact) for contact in contacts]))
        if inside is None or not any(contact.width for contact in contacts):
            return found
        cells = np.concatenate([inside(contact) for contact in contacts])
        return np.union1d(found, trial.dofs.element_dofs[:, cells])

    number, inner, degree = _numbers(circuit, trial, under_all)
    of_cells = np.concatenate([field[trial.dofs.element_dofs] for field in number])
    pairs, own = element_pairs(of_cells), _facing(circuit, trial, number, inner)
    size = inner + len(circuit.terminals)
    pattern, of_pairs = pattern_of_pairs(
        *(np.concatenate([a.ravel(), b]) for a, b in zip(pairs, own, strict=True)), size=size
    )
    slots, facing = np.split(of_pairs, [pairs[0].size])
    conductors, of_cell = len(circuit.conductors), trial.dofs.element_dofs.T.shape
    coefficients, themselves = np.split(facing, [facing.size - conductors])
    under = _under_terminals(circuit, trial, number, pattern.size, under_all)
    return Unknowns(
        inner=inner,
        number=number,
        degree=degree,
        one=_on_fields(trial.one, number, inner),
        under=under,
        at_foils=_at_foils(under, inner),
        pattern=pattern,
        slots=slots.reshape(pairs[0].shape),
        facing=(coefficients.reshape(conductors, 2, *of_cell), themselves),
    )


def on_cells(unknowns: Unknowns, trial: TrialSpace, u: NDArray) -> NDArray:
    """Coefficients of each field in each cell, shape (field, function, cell).

    u: of the unknowns, shape (inner + terminals,).
    """
    values = np.append(u, 0.0)
    return values[unknowns.number][:, trial.dofs.element_dofs]


def _degree(dofs: Dofs) -> Integer:
    degree = np.ones(dofs.N, dtype=np.int64)
    along_edge = np.asarray(dofs.facet_dofs)
    inside = np.asarray(dofs.interior_dofs)
    per_edge = np.arange(len(along_edge)) + 2
    degree[along_edge] = per_edge[:, None]
    degree[inside] = np.maximum.outer(per_edge, per_edge).reshape(-1, 1)[: len(inside)]
    return degree


def _numbers(
    circuit: Circuit, trial: TrialSpace, under_all: Callable[[Sequence[Contact]], Integer]
) -> tuple[Integer, int, Integer]:
    """Unknown of each field's coefficients, the number of inner ones, and the degree of those."""
    free = DROPPED - 1
    number = np.full((circuit.fields, len(trial.one)), free, dtype=np.int64)
    owner = np.full_like(number, DROPPED)
    for index, terminal in enumerate(circuit.terminals):
        if terminal.faces is not None:
            continue
        fixed = _fixed_coefficients(terminal, trial, under_all)
        number[terminal.field, fixed] = DROPPED
        owner[terminal.field, fixed[trial.one[fixed] == 1]] = index
    degree = np.tile(trial.degree, (circuit.fields, 1))[number == free]
    inner = len(degree)
    number[number == free] = np.arange(inner)
    number[owner != DROPPED] = inner + owner[owner != DROPPED]
    return number, inner, degree


def _facing(
    circuit: Circuit, trial: TrialSpace, number: Integer, inner: int
) -> tuple[Integer, Integer]:
    """Rows and columns that couple conductors with the fields in front of them, then their
    diagonals."""
    rows, columns = [], []
    for conductor in circuit.conductors:
        faces = circuit.terminals[conductor].faces
        own = number[faces][trial.dofs.element_dofs].T.ravel()
        itself = np.full(own.shape, inner + conductor)
        rows += [own, itself]
        columns += [itself, own]
    themselves = inner + np.array(circuit.conductors, dtype=np.int64)
    return np.concatenate([*rows, themselves]), np.concatenate([*columns, themselves])


def _fixed_coefficients(
    terminal: Terminal, trial: TrialSpace, under_all: Callable[[Sequence[Contact]], Integer]
) -> Integer:
    if not terminal.contacts:
        return trial.vertices[:1]
    return under_all([contact for contact in terminal.contacts if contact.ideal])


def _on_fields(one: Real, number: Integer, inner: int) -> Real:
    spread = np.zeros((inner, len(number)))
    for field, indices in enumerate(number):
        is_inner = (indices >= 0) & (indices < inner)
        spread[indices[is_inner], field] = one[is_inner]
    return spread


def _under_terminals(
    circuit: Circuit,
    trial: TrialSpace,
    number: Integer,
    size: int,
    under_all: Callable[[Sequence[Contact]], Integer],
) -> Real:
    under = np.zeros((size, len(circuit.terminals)))
    for index, terminal in enumerate(circuit.terminals):
        coefficients = under_all([contact for contact in terminal.contacts if not contact.ideal])
        if not coefficients.size:
            continue
        indices = number[terminal.field, coefficients]
        under[indices[indices != DROPPED], index] = trial.one[coefficients[indices != DROPPED]]
    return under


def _at_foils(under: Real, inner: int) -> Real:
    """Lift of the sheet at foils: where foils meet, to the first of them; terminals at their own 1
    V."""
    first = np.cumsum(under != 0, axis=1) == 1
    at_foils = np.where(first, under, 0.0)
    at_foils[inner:] = np.eye(under.shape[1])
    return at_foils
