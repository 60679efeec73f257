"""Where on a mesh the answer is least certain: how much the next order changes the potentials."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simulator.quadrature import interpolated, rule_at
from simulator.varied.discretised import Discretised

KEPT = 0.7
"""Of the whole error: what lies in the cells that are marked."""

Potentials = tuple[NDArray[np.float64], NDArray[np.float64]]
"""V, shape (field, cell, point), and its slope in V/m, shape (field, 2, cell, point)."""


def indicators(discretised: Discretised, frequency: NDArray[np.float64]) -> NDArray[np.float64]:
    """Part of each cell in the error of Rs and Cp, shape (cell,). frequency: Hz.

    At s = omega instead of j omega potentials are real and reach as far. There the energy of what
    the next order adds is what it takes off Y. Beside the heat in the sheets it tells on Rs, beside
    the energy in the foam on Cp, and so does what is missed of the foam.
    """
    parts = np.zeros(discretised.fine.elements.cells)
    for s in (2 * np.pi * frequency).tolist():
        for drive in range(len(discretised.circuit.drives)):
            (v, slope), (w, steeper) = _potentials(discretised, drive, s)
            added = sum(_energies(discretised, s, w - v, steeper - slope))
            heat, stored = _energies(discretised, s, w, steeper)
            parts += added / heat.sum() + (added + discretised.missed * stored) / stored.sum()
    return parts


def most(parts: NDArray[np.float64]) -> NDArray[np.int64]:
    """The fewest cells that hold KEPT of the whole. Source: W. Doerfler, SINUM 33 (1996) 1106."""
    order = np.argsort(-parts, kind="stable")
    held = np.cumsum(parts[order])
    return np.sort(order[: int(np.searchsorted(held, KEPT * held[-1])) + 1])


def _potentials(discretised: Discretised, drive: int, s: float) -> list[Potentials]:
    """Of both orders at the points of the finer one's rule."""
    rule, at = discretised.fine.elements.rule, discretised.fine.elements.surface
    found = []
    for each in (discretised.coarse, discretised.fine):
        known = rule_at(each.elements.element, rule.points, rule.weights)
        fields = [interpolated(known, at, u) for u in discretised.coefficients_of(each, drive, s)]
        found.append(tuple(np.stack(part) for part in zip(*fields, strict=True)))
    return found


def _energies(
    discretised: Discretised, s: float, u: NDArray[np.float64], slope: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Of potentials at s: in the sheets and in the foam, W, both of shape (cell,)."""
    elements, coefficients = discretised.fine.elements, discretised.coefficients
    weights = elements.surface.area * elements.rule.weights
    heat = np.zeros_like(weights)
    for field, (dx, dy) in enumerate(slope):
        xx, yy, xy = coefficients.conductance(field, elements.surface.x)
        heat += xx * dx**2 + yy * dy**2 + 2 * xy * dx * dy
    across = np.einsum("fg,fcp,gcp->cp", discretised.circuit.coupling, u, u)
    stored = s * coefficients.capacitance(elements.surface.x) * across
    return (weights * heat).sum(axis=1), (weights * stored).sum(axis=1)
