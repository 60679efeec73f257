"""The discretised skin: K and M(c) over inner unknowns and terminals, in one sparsity pattern."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix, csc_matrix
from skfem import BilinearForm, LinearForm
from skfem.assembly import Dofs, FacetBasis

from simulator.assembly import (
    DROPPED,
    Pattern,
    areas,
    element_pairs,
    fill,
    quadrilateral,
    reference_matrices,
    stiffness_weights,
)
from simulator.circuit import Circuit, Terminal
from simulator.mesh import PixelMesh, Resolution, pixel_mesh
from simulator.scene import Scene


@dataclass(frozen=True)
class System:
    """(K + s M(c)) u = b, with each terminal's potential as one unknown.

    Unknowns are the inner ones, 0 .. inner - 1, then one per terminal of the circuit.

    one: inner coefficients of 1 V all over a field, shape (inner, field). stiffness: K in S,
    sparse, shape (inner + terminals, inner + terminals).
    """

    inner: int
    one: NDArray[np.float64]
    stiffness: csc_matrix
    pattern: Pattern
    element_slots: NDArray[np.int64]
    element_pixel: NDArray[np.int64]
    element_area: NDArray[np.float64]
    mass_reference: NDArray[np.float64]

    def mass(self, c: NDArray[np.float64]) -> csc_matrix:
        """M(c) in F, in the pattern of K. c: F/m², shape (row, column)."""
        values = np.zeros(len(self.pattern.indices))
        weights = (self.element_area * c.ravel()[self.element_pixel])[:, None]
        fill(values, self.element_slots, weights, self.mass_reference)
        return self.pattern.matrix(values)


def build_system(scene: Scene, circuit: Circuit, resolution: Resolution) -> System:
    """The system of a scene's circuit at a resolution: all that does not depend on the press."""
    contacts = [contact for terminal in circuit.terminals for contact in terminal.contacts]
    pixels = pixel_mesh(scene, contacts, resolution)
    mesh, order = pixels.mesh, resolution.order
    dofs = Dofs(mesh, quadrilateral(order))
    one = _constant(dofs, order)
    unknown, inner = _number(circuit, pixels, dofs, one)
    films = _films(circuit, pixels, order, unknown, inner)

    rows, columns = element_pairs(np.concatenate([field[dofs.element_dofs] for field in unknown]))
    pattern = Pattern.of_pairs(
        np.concatenate([rows.ravel(), films.rows]),
        np.concatenate([columns.ravel(), films.columns]),
        size=inner + len(circuit.terminals),
    )
    element_slots = pattern.slots[: rows.size].reshape(rows.shape)
    film_slots = pattern.slots[rows.size :]

    reference = reference_matrices(order)
    conductance = np.diag(circuit.conductance)
    stiffness_reference = np.stack([np.kron(conductance, k).ravel() for k in reference.stiffness])
    values = np.zeros(len(pattern.indices))
    fill(values, element_slots, stiffness_weights(mesh), stiffness_reference)
    kept = film_slots != DROPPED
    np.add.at(values, film_slots[kept], films.values[kept])
    return System(
        inner=inner,
        one=_spread(one, unknown, inner),
        stiffness=pattern.matrix(values),
        pattern=pattern,
        element_slots=element_slots,
        element_pixel=pixels.pixel,
        element_area=areas(mesh),
        mass_reference=np.kron(circuit.coupling, reference.mass).reshape(1, -1).astype(float),
    )


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
) -> tuple[NDArray[np.int64], int]:
    """The unknown of each field's coefficients, shape (field, coefficient), and how many are inner.

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
    inner = int(np.count_nonzero(unknown == free))
    unknown[unknown == free] = np.arange(inner)
    unknown[owner != DROPPED] = inner + owner[owner != DROPPED]
    return unknown, inner


def _held(terminal: Terminal, pixels: PixelMesh, dofs: Dofs) -> NDArray[np.int64]:
    if not terminal.contacts:
        return _vertices(dofs)[:1]
    facets = [pixels.facets(contact) for contact in terminal.contacts if contact.ideal]
    if not facets:
        return np.empty(0, dtype=np.int64)
    return dofs.get_facet_dofs(np.concatenate(facets)).flatten()


@dataclass(frozen=True)
class _Entries:
    rows: NDArray[np.int64]
    columns: NDArray[np.int64]
    values: NDArray[np.float64]


def _films(
    circuit: Circuit,
    pixels: PixelMesh,
    order: int,
    unknown: NDArray[np.int64],
    inner: int,
) -> _Entries:
    """Entries of K from contact resistance: the energy of (U - V)² / r_c along each foil."""
    parts = [_Entries(np.empty(0, np.int64), np.empty(0, np.int64), np.empty(0))]
    for index, terminal in enumerate(circuit.terminals):
        for contact in terminal.contacts:
            if not contact.ideal:
                facets = pixels.facets(contact)
                foil = FacetBasis(
                    pixels.mesh, quadrilateral(order), facets=facets, intorder=2 * order
                )
                film = _film(foil, unknown[terminal.field], inner + index)
                parts.append(_Entries(film.rows, film.columns, film.values / contact.resistance))
    return _Entries(
        np.concatenate([part.rows for part in parts]),
        np.concatenate([part.columns for part in parts]),
        np.concatenate([part.values for part in parts]),
    )


def _film(foil: FacetBasis, unknown: NDArray[np.int64], terminal: int) -> _Entries:
    """Entries of the form (U - V)² integrated along a foil, in m."""
    trace = coo_matrix(BilinearForm(lambda u, v, _: u * v).assemble(foil))
    weight = np.asarray(LinearForm(lambda v, _: v).assemble(foil))
    touched = np.flatnonzero(weight)
    at_terminal = np.full(len(touched), terminal)
    return _Entries(
        np.concatenate([unknown[trace.row], unknown[touched], at_terminal, [terminal]]),
        np.concatenate([unknown[trace.col], at_terminal, unknown[touched], [terminal]]),
        np.concatenate([trace.data, -weight[touched], -weight[touched], [foil.dx.sum()]]),
    )


def _spread(
    one: NDArray[np.float64], unknown: NDArray[np.int64], inner: int
) -> NDArray[np.float64]:
    spread = np.zeros((inner, len(unknown)))
    for field, indices in enumerate(unknown):
        is_inner = (indices >= 0) & (indices < inner)
        spread[indices[is_inner], field] = one[is_inner]
    return spread
