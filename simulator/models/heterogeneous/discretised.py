"""One press on one mesh, in trial functions of two orders: the answer, and what checks it."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ...fem.circuit import Circuit
from ...fem.error_estimate import (
    KRYLOV_SHARE,
    ROUNDING,
    Swept,
    both,
    frequencies_around,
)
from ...fem.factors import one_blas_thread
from ...fem.galerkin import Galerkin, swept
from ...fem.lanczos import CachedSteps
from ...fem.quadrature import interpolated
from ...fem.safety_factors import VARIED
from ...fem.unknowns import on_cells
from ...mesh.refining.graded import fewest
from ...scene.frequency import Loss, laplace_variable
from ..solution import ModelResult
from .coefficients import PressCoefficients
from .deflection_error import NEGLIGIBLE, Raised, missed, raised_by_rule
from .elements import Elements, raising
from .error_history import ErrorHistory, by_orders, smoothed
from .low_rank_terms import describe_accuracy
from .pressed_system import PressedSystem, mass_of, pressed_system
from .surroundings_terms import energy_to_earth


@dataclass(frozen=True)
class SolvedLevel:
    """Trial functions of one order, and the system that their space is taken from."""

    space: Galerkin
    system: PressedSystem
    elements: Elements
    kept: CachedSteps = dataclasses.field(default_factory=CachedSteps)

    def under(self, circuit: Circuit, coefficients: PressCoefficients) -> SolvedLevel:
        """Of another press on the same mesh: but for gauges only the capacitance is another."""
        if coefficients.gauged:
            system = pressed_system(circuit, self.elements, coefficients, self.system.unknowns)
            space = Galerkin(system, circuit, self.elements.order)
            return SolvedLevel(space, system, self.elements)
        mass = mass_of(circuit, self.elements, coefficients, self.system.unknowns, self.system.far)
        return replace(self, system=replace(self.system, mass=mass), kept=CachedSteps())


@dataclass(frozen=True)
class Discretised:
    """told: the mesh in words. error: relative, of Rs and Cp, by what is not quite as asked.

    lower: of one and of two orders less than `coarse`, where they tell how much `fine` shows.
    course: of the meshes before. felt: what Rs and Cp feel of the error of mechanics, relative,
    shape (2, interface, frequency).
    """

    circuit: Circuit
    loss: Loss
    coefficients: PressCoefficients
    coarse: SolvedLevel
    fine: SolvedLevel
    told: str
    error: float = 0.0
    lower: tuple[SolvedLevel, ...] = ()
    course: ErrorHistory = dataclasses.field(default_factory=ErrorHistory)
    deflection_error: NDArray[np.float64] | float = 0.0

    def result(self, frequency: NDArray[np.float64], rtol: float) -> ModelResult:
        """The answer at these frequencies in Hz, and its error."""
        around = frequencies_around(frequency)
        (Q, change), (finer, _), *lower = self._swept(around, KRYLOV_SHARE * rtol)
        combined = self.circuit.combination
        Z, steps = combined.impedance(Q), [combined.relative_change(Q, finer)]
        if lower:
            each = [Q, *(of_lower for of_lower, _ in lower)]
            steps += [combined.relative_change(low, high) for high, low in pairwise(each)]
            off = by_orders(self.coarse.space.order, [smoothed(step) for step in steps])
        else:
            off = self.course.effect(frequency, Z, combined.impedance(finer)) * smoothed(steps[0])
        here = np.s_[:, : len(frequency)]
        told = VARIED * both(off) + change[here] + ROUNDING
        told = told + self.error + self.deflection_error
        if self.missed.max() > NEGLIGIBLE * rtol:
            told += self.changes(raised_by_rule(self.coefficients, self.missed), frequency, rtol)
        self.course.record(frequency, told)
        return ModelResult(
            self.told + describe_accuracy(self.coefficients.materials),
            self.coarse.space.inner,
            Z[here],
            told,
        )

    def _swept(self, frequency: NDArray[np.float64], rtol: float) -> list[Swept]:
        s, excitations = laplace_variable(frequency, self.loss), self.circuit.excitations
        with one_blas_thread():
            return [
                swept(each.space, each.system.mass, excitations, s, rtol, each.kept)
                for each in (self.coarse, self.fine, *self.lower)
            ]

    def changes(
        self, raised: Raised, frequency: NDArray[np.float64], rtol: float
    ) -> NDArray[np.float64]:
        """Of Rs and Cp, relatively, by raised coefficients, shape (2, interface, frequency)."""
        own = self.coarse
        s, excitations = laplace_variable(frequency, self.loss), self.circuit.excitations
        other = own.under(self.circuit, raised)
        with one_blas_thread():
            Q, moved = (
                swept(each.space, each.system.mass, excitations, s, KRYLOV_SHARE * rtol)[0]
                for each in (own, other)
            )
        return both(self.circuit.combination.relative_change(Q, moved))

    @cached_property
    def missed(self) -> NDArray[np.float64]:
        """Part of each cell's capacitance that the rule is off by, shape (cell,)."""
        return missed(self.coarse.elements, self.coefficients)

    def coefficients_of(self, solved: SolvedLevel, excitation: int, s: complex) -> NDArray:
        """Potentials of an excitation at s in rad/s, real or complex, shape (field, function,
        cell)."""
        with one_blas_thread():
            v = solved.space.potentials(solved.system.mass, self.circuit.excitations[excitation], s)
        return on_cells(solved.system.unknowns, solved.elements.trial, v)

    def coefficients_at(
        self, solved: SolvedLevel, excitation: int, s: NDArray[np.float64]
    ) -> list[NDArray[np.float64]]:
        """The same at real s >= 0 as closely as the sweep was solved, if it was; else exactly."""
        own, mass = self.circuit.excitations[excitation], solved.system.mass
        steps = solved.kept.of(own, s)
        if steps is None:
            return [self.coefficients_of(solved, excitation, each) for each in s.tolist()]
        with one_blas_thread():
            V = solved.space.potentials_by(steps, mass, own, s)
        return [on_cells(solved.system.unknowns, solved.elements.trial, v) for v in V.T]


LEAST_LEFT = 0.1
"""Of the energy of all excitations of an interface: what meshes are refined for at least."""
KEPT = 0.7
"""Of the whole error: what lies in the cells that are marked."""


def indicators(discretised: Discretised, frequency: NDArray[np.float64]) -> NDArray[np.float64]:
    """Part of each cell in the error of Rs and Cp at frequencies in Hz, shape (frequency, cell).

    At s = omega instead of j omega potentials are real and reach as far. There the energy of what
    the next order adds is what it takes off Y. Beside the heat in the sheets it tells on Rs, beside
    the energy in the foam on Cp, and so does what is missed of the foam.
    """
    parts = np.zeros((len(frequency), discretised.fine.elements.cells))
    combined, s = discretised.circuit.combination, 2 * np.pi * frequency
    for weights, group in zip(combined.weights, combined.groups, strict=True):
        at_each = zip(
            *(_potentials(discretised, excitation, s) for excitation in group), strict=True
        )
        for part, each, of_drives in zip(parts, s.tolist(), at_each, strict=True):
            part += _of_interface(discretised, each, weights[group], of_drives)
    return parts


def _of_interface(
    discretised: Discretised,
    s: float,
    weights: NDArray[np.float64],
    of_drives: Sequence[tuple[NDArray[np.float64], NDArray[np.float64]]],
) -> NDArray[np.float64]:
    """Part of each cell in the error of one interface, whose excitations' errors add."""
    added = [np.add(*_energies(discretised, s, added_w)) for _, added_w in of_drives]
    heat, stored = zip(*(_energies(discretised, s, w) for w, _ in of_drives), strict=True)
    missed = [each + discretised.missed * own for each, own in zip(added, stored, strict=True)]
    return _over_all(weights, added, heat) + _over_all(weights, missed, stored)


def _over_all(
    weights: NDArray[np.float64],
    part: Sequence[NDArray[np.float64]],
    whole: Sequence[NDArray[np.float64]],
) -> NDArray[np.float64]:
    """Over the sum of the whole; 0 where that is 0: behind foils that insulate no sheet is heated
    by as much as double precision holds, and what is there is none of the error.

    All of each excitation; LEAST_LEFT of the whole is what their difference is at least.
    """
    parts, signed, unsigned = (
        sum(w * each for w, each in zip(signs, of_each, strict=True))
        for signs, of_each in ((abs(weights), part), (weights, whole), (abs(weights), whole))
    )
    total = max(np.sum(signed), LEAST_LEFT * np.sum(unsigned))
    return parts / total if total > 0 else np.zeros_like(parts)


def most(parts: NDArray[np.float64]) -> NDArray[np.int64]:
    """The fewest cells that hold KEPT of the whole. Source: W. Doerfler, SINUM 33 (1996) 1106."""
    return fewest(parts, KEPT * float(parts.sum()))


def _potentials(
    discretised: Discretised, excitation: int, s: NDArray[np.float64]
) -> list[tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Of the finer order, and what it adds, by its coefficients, shape (field, function, cell).

    At each s.
    """
    coarse, fine = (
        discretised.coefficients_at(each, excitation, s)
        for each in (discretised.coarse, discretised.fine)
    )
    raised = raising(discretised.coarse.elements.order)
    return [(w, w - raised @ v) for v, w in zip(coarse, fine, strict=True)]


def _energies(
    discretised: Discretised, s: float, of_fields: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Of potentials at s: in the sheets and in the foam, W, both of shape (cell,).

    of_fields: coefficients of the finer order, shape (field, function, cell).
    """
    elements, coefficients = discretised.fine.elements, discretised.coefficients
    at = [interpolated(elements.rule, elements.surface, each) for each in of_fields]
    u, slope = (np.stack(part) for part in zip(*at, strict=True))
    weights = elements.surface.area * elements.rule.weights
    heat = np.zeros_like(weights)
    for field, (dx, dy) in enumerate(slope):
        xx, yy, xy = coefficients.conductance(field, elements.surface.x)
        heat += xx * dx**2 + yy * dy**2 + 2 * xy * dx * dy
    across = np.einsum("fg,fcp,gcp->cp", discretised.circuit.coupling, u, u)
    stored = coefficients.capacitance(elements.surface.x) * across
    stored = s * (stored + energy_to_earth(coefficients, elements.surface.x, u))
    return (weights * heat).sum(axis=1), (weights * stored).sum(axis=1)
