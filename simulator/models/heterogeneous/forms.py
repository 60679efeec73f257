"""Quadratic forms on the elements of a heterogeneous skin, added to the values of a pattern."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable

import numpy as np

from ...arrays import Integer, Mask, Real
from ...fem.assembly import DROPPED, add_terms
from ...fem.factors import one_blas_thread
from ...fem.quadrature import Terms, mass_terms, stiffness_terms
from ...fem.unknowns import Unknowns
from .elements import Elements

Density = Callable[[Real, Real], Real]
"""Density per m of the flat skin, from positions on a line and its direction there, both (2, ...).
"""


def add_sheet(
    values: Real,
    alone: Real,
    elements: Elements,
    unknowns: Unknowns,
    S: Real,
    within: Mask | None = None,
) -> None:
    """Add K of one field. S: by its xx, yy and xy in S, shape (3, cell, point).

    alone: selects the field, shape (field, field). within: restricts the form to these cells.
    """
    for cells in _groups(elements, within):
        terms = stiffness_terms(elements.rule, elements.surface.some(cells), S[:, cells])
        _add_between_fields(values, unknowns.slots[cells], alone, terms)


def add_foam(
    values: Real,
    coupling: Real,
    elements: Elements,
    unknowns: Unknowns,
    c: Real,
    within: Mask | None = None,
) -> None:
    """Add M. c: F/m², shape (cell, point). within: restricts the form to these cells."""
    for cells in _groups(elements, within):
        terms = mass_terms(elements.rule, elements.surface.some(cells), c[cells])
        _add_between_fields(values, unknowns.slots[cells], coupling, terms)


def _add_between_fields(values: Real, slots: Integer, fields: Real, terms: Iterable[Terms]) -> None:
    """Add matrices of cells in one field to all pairs of fields, times the entry of `fields`.

    slots: shape (cell, pair). fields: shape (field, field).
    """
    with one_blas_thread():
        matrices = sum(weights @ reference for weights, reference in terms)
    assert isinstance(matrices, np.ndarray)
    local = math.isqrt(matrices.shape[1])
    between = slots.reshape(-1, len(fields), local, len(fields), local) - DROPPED
    for f, g in np.argwhere(fields).tolist():
        own = between[:, f, :, g].ravel()
        added = np.bincount(own, matrices.ravel(), len(values) - DROPPED)
        values += fields[f, g] * added[-DROPPED:]


def _groups(elements: Elements, within: Mask | None) -> Iterable[Integer | slice]:
    """Straight cells, then curved ones; restricted to `within`."""
    if within is None:
        return elements.groups
    every = np.arange(elements.cells)
    kept = [each[within[each]] for each in (every[group] for group in elements.groups)]
    return [each for each in kept if len(each)]


def add_along(
    values: Real,
    fields: Real,
    elements: Elements,
    unknowns: Unknowns,
    facets: Integer,
    density: Density,
) -> None:
    """Add the form density u v along facets, between `fields`, shape (field, field)."""
    cells, edges = elements.cells_at_facets(facets)
    for edge in np.unique(edges):
        own = cells[edges == edge]
        rule, direction = elements.edge_rule(int(edge))
        at = elements.surface_at(rule, own)
        tangent = at.along * direction[0] + at.across * direction[1]
        length = np.linalg.norm(tangent, axis=0)
        weights = rule.weights * length * density(at.x, tangent)
        add_terms(values, unknowns.slots[own], [_edge_terms(rule.values, weights, fields)])


def add_at(values: Real, slots: Integer, added: Real) -> None:
    """Add numbers to the values at their slots; numbers of DROPPED slots are ignored."""
    found = np.bincount(slots.ravel() - DROPPED, added.ravel(), len(values) - DROPPED)
    values += found[-DROPPED:]


def _edge_terms(u: Real, weights: Real, fields: Real) -> Terms:
    """Terms of the form u v along an edge. u: functions at its points; weights: (cell, point)."""
    matrices = np.einsum("fg,ip,jp->pfigj", fields, u, u)
    return weights, matrices.reshape(len(matrices), -1)
