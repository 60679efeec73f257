"""The matrices of a varied skin: what coefficients at the points of its elements give."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix

from ...fem.assembly import add_terms
from ...fem.circuit import Circuit, Terminal
from ...fem.dropped import DROPPED
from ...fem.factors import one_blas_thread
from ...fem.quadrature import Terms, mass_terms, stiffness_terms
from ...fem.system import System, films
from ...fem.unknowns import Unknowns, numbered
from ...scene.contacts import Contact
from .coefficients import Coefficients
from .elements import Elements


@dataclass(frozen=True)
class PressedSystem(System):
    """With the capacitance of one press: mass is M in F."""

    fields_apart: ClassVar[bool] = True
    mass: csc_matrix


def pressed_system(
    circuit: Circuit,
    elements: Elements,
    coefficients: Coefficients,
    known: Unknowns | None = None,
) -> PressedSystem:
    """The matrices of one press on one mesh. known: its unknowns, where they are numbered yet."""
    unknowns = known or numbered(circuit, elements.trial, elements.facets)
    return PressedSystem(
        unknowns=unknowns,
        sheets=_sheets(circuit, elements, coefficients, unknowns),
        films=films(circuit, unknowns, film_of(circuit, elements, coefficients, unknowns)),
        mass=foam(circuit, elements, coefficients, unknowns),
    )


def _sheets(
    circuit: Circuit, elements: Elements, coefficients: Coefficients, unknowns: Unknowns
) -> csc_matrix:
    values = np.zeros(len(unknowns.pattern.indices))
    for field in range(circuit.fields):
        S = coefficients.conductance(field, elements.surface.x)
        add_sheet(values, circuit.field_alone(field), elements, unknowns, S)
    return unknowns.pattern.matrix(values)


def add_sheet(
    values: NDArray[np.float64],
    alone: NDArray[np.float64],
    elements: Elements,
    unknowns: Unknowns,
    S: NDArray[np.float64],
    within: NDArray[np.bool_] | None = None,
) -> None:
    """K of one field, in the pattern. S: by its xx, yy and xy in S, shape (3, cell, point).

    alone: what picks the field, shape (field, field). within: the cells that are meant.
    """
    for cells in _groups(elements, within):
        terms = stiffness_terms(elements.rule, elements.surface.some(cells), S[:, cells])
        _add_between_fields(values, unknowns.slots[cells], alone, terms)


def foam(
    circuit: Circuit, elements: Elements, coefficients: Coefficients, unknowns: Unknowns
) -> csc_matrix:
    """M in F of one press."""
    values = np.zeros(len(unknowns.pattern.indices))
    c = coefficients.capacitance(elements.surface.x)
    add_foam(values, circuit.coupling, elements, unknowns, c)
    return unknowns.pattern.matrix(values)


def add_foam(
    values: NDArray[np.float64],
    coupling: NDArray[np.float64],
    elements: Elements,
    unknowns: Unknowns,
    c: NDArray[np.float64],
    within: NDArray[np.bool_] | None = None,
) -> None:
    """M in the pattern. c: F/m², shape (cell, point). within: the cells that are meant."""
    for cells in _groups(elements, within):
        terms = mass_terms(elements.rule, elements.surface.some(cells), c[cells])
        _add_between_fields(values, unknowns.slots[cells], coupling, terms)


def _add_between_fields(
    values: NDArray[np.float64],
    slots: NDArray[np.int64],
    fields: NDArray[np.float64],
    terms: Iterable[Terms],
) -> None:
    """Matrices of cells in one field, in the pattern wherever `fields` are not zero, as often.

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


def _groups(
    elements: Elements, within: NDArray[np.bool_] | None
) -> Iterable[NDArray[np.int64] | slice]:
    """Straight cells, then bent ones; those that are meant."""
    if within is None:
        return elements.groups
    every = np.arange(elements.cells)
    meant = [each[within[each]] for each in (every[group] for group in elements.groups)]
    return [each for each in meant if len(each)]


def film_of(
    circuit: Circuit,
    elements: Elements,
    coefficients: Coefficients,
    unknowns: Unknowns,
    only: Contact | None = None,
) -> Callable[[Terminal], csc_matrix]:
    """The form of (V - U)² / r_c along the foils of a terminal; only: along this one alone."""

    def film(terminal: Terminal) -> csc_matrix:
        values = np.zeros(len(unknowns.pattern.indices))
        alone = circuit.field_alone(terminal.field)
        for contact in terminal.contacts:
            if contact.ideal or (only is not None and contact is not only):
                continue
            cells, edges = elements.beside(elements.facets(contact))
            for edge in np.unique(edges):
                own = cells[edges == edge]
                rule, direction = elements.edge_rule(int(edge))
                at = elements.surface_at(rule, own)
                tangent = at.along * direction[0] + at.across * direction[1]
                density = coefficients.line_stretch(at.x, tangent) / contact.resistance
                length = np.linalg.norm(tangent, axis=0)
                along_edge = _edge_terms(rule.values, rule.weights * length * density, alone)
                add_terms(values, unknowns.slots[own], [along_edge])
        return unknowns.pattern.matrix(values)

    return film


def _edge_terms(
    u: NDArray[np.float64], weights: NDArray[np.float64], fields: NDArray[np.float64]
) -> Terms:
    """Of the form u v along an edge. u: functions at points of it; weights: (cell, point)."""
    matrices = np.einsum("fg,ip,jp->pfigj", fields, u, u)
    return weights, matrices.reshape(len(matrices), -1)
