"""K and M of one press on a skin whose coefficients are known at any point."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix

from simulator.assembly import fill
from simulator.circuit import Circuit, Terminal
from simulator.quadrature import Terms, mass_terms, stiffness_terms
from simulator.system import System, films
from simulator.unknowns import Unknowns, numbered
from simulator.varied.coefficients import Coefficients
from simulator.varied.elements import Elements


@dataclass(frozen=True)
class PressedSystem(System):
    """With the capacitance of one press: mass is M in F."""

    mass: csc_matrix


def pressed_system(
    circuit: Circuit, elements: Elements, coefficients: Coefficients
) -> PressedSystem:
    """The matrices of one press on one mesh."""
    unknowns = numbered(circuit, elements.trial, elements.facets)
    return PressedSystem(
        unknowns=unknowns,
        sheets=_sheets(circuit, elements, coefficients, unknowns),
        films=films(circuit, unknowns, _film_of(circuit, elements, coefficients, unknowns)),
        mass=_mass(circuit, elements, coefficients, unknowns),
    )


def _sheets(
    circuit: Circuit, elements: Elements, coefficients: Coefficients, unknowns: Unknowns
) -> csc_matrix:
    values, at = np.zeros(len(unknowns.pattern.indices)), elements.surface
    for field in range(circuit.fields):
        S = coefficients.conductance(field, at.x)
        alone = circuit.field_alone(field)
        for cells in elements.groups:
            terms = stiffness_terms(elements.rule, at.some(cells), S[:, cells], alone)
            _add(values, unknowns.slots[cells], terms)
    return unknowns.pattern.matrix(values)


def _mass(
    circuit: Circuit, elements: Elements, coefficients: Coefficients, unknowns: Unknowns
) -> csc_matrix:
    values, at = np.zeros(len(unknowns.pattern.indices)), elements.surface
    c = coefficients.capacitance(at.x)
    for cells in elements.groups:
        terms = mass_terms(elements.rule, at.some(cells), c[cells], circuit.coupling)
        _add(values, unknowns.slots[cells], terms)
    return unknowns.pattern.matrix(values)


def _film_of(circuit: Circuit, elements: Elements, coefficients: Coefficients, unknowns: Unknowns):
    """The form of (V - U)² / r_c along the foils of a terminal."""

    def film(terminal: Terminal) -> csc_matrix:
        values = np.zeros(len(unknowns.pattern.indices))
        alone = circuit.field_alone(terminal.field)
        for contact in terminal.contacts:
            if contact.ideal:
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
                _add(values, unknowns.slots[own], [along_edge])
        return unknowns.pattern.matrix(values)

    return film


def _edge_terms(
    u: NDArray[np.float64], weights: NDArray[np.float64], fields: NDArray[np.float64]
) -> Terms:
    """Of the form u v along an edge. u: functions at points of it; weights: (cell, point)."""
    matrices = np.einsum("fg,ip,jp->pfigj", fields, u, u)
    return weights, matrices.reshape(len(matrices), -1)


def _add(values: NDArray[np.float64], slots: NDArray[np.int64], terms: Iterable[Terms]) -> None:
    for weights, matrices in terms:
        fill(values, slots, np.ascontiguousarray(weights), matrices)
