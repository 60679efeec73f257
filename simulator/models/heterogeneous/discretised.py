"""One press on one mesh, in trial functions of two orders: the answer and its error estimate.

The error is a ratio k times the difference of two orders, estimated from a sequence of meshes.
Where the field is smooth, the next order removes nearly all of the error. Where the field varies as
r^(1/2), at the end of a foil, the next order removes only 40 % of the error, on any mesh. Z of
order p has the error E = k D, with D its difference from order p + 1. k hardly changes from mesh to
mesh, so two meshes give k; on one mesh lower orders give it.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ...arrays import Complex, Integer, Real
from ...fem.circuit import Circuit
from ...fem.error_estimate import (
    FIRST_MESH,
    KRYLOV_SHARE,
    MAX_FACTOR,
    MAX_FACTOR_BY_ORDERS,
    MIN_DECREASE,
    MIN_FACTOR,
    PARITY,
    PREDICTED,
    ROUNDING,
    VARIED,
    Swept,
    both,
    frequencies_around,
)
from ...fem.factors import one_blas_thread
from ...fem.galerkin import Galerkin
from ...fem.lanczos import CachedSteps
from ...fem.quadrature import interpolated
from ...fem.sweep import swept_with_air
from ...fem.terminals import Excitation
from ...fem.unknowns import on_cells
from ...mesh.refinement import fewest
from ...scene.frequency import Loss
from ..solution import ModelResult
from .coefficients import NEGLIGIBLE, PressCoefficients, Raised, missed, raised_by_rule
from .elements import Elements, raising
from .pressed_system import (
    PressedSystem,
    describe_accuracy,
    energy_to_earth,
    masses_of,
    pressed_system,
)

Admittances = Complex


def smoothed(difference: Real) -> Real:
    """Difference at the first third of `frequencies_around`, smoothed over its neighbours.

    difference: shape (..., 3 f). Returns (..., f). A difference that changes sign vanishes at one
    of the three frequencies; the result is then its geometric mean with its neighbours. A
    difference that is a power of frequency stays as it is.
    """
    here, below, above = np.split(difference, 3, axis=-1)
    return np.sqrt(here * np.maximum(here, np.sqrt(below * above)))


class ErrorHistory:
    """Estimated errors of one press on one mesh after the other, and the k that follow from
    them."""

    def __init__(self) -> None:
        self._recorded = dict[float, float]()
        self._frequency = np.empty(0)
        self._Y: tuple[Admittances, Admittances] | None = None
        self._largest = 0.0
        self._errors: list[float] = []
        self._unseen, self._most = FIRST_MESH, MAX_FACTOR
        self._foreseen = np.ones(1), np.full(1, np.inf)

    def predict(self, frequency: Real, k: Real) -> None:
        """Set the predicted k of the next mesh at some frequencies in Hz, ascending."""
        self._foreseen = frequency, k

    def account_for_corners(self, exponents: Real, order: int) -> None:
        """Raise the bounds of k for corners with these exponents."""
        slowest = float(at_corners(exponents.min(initial=np.inf), order))
        self._unseen, self._most = max(FIRST_MESH, slowest), max(MAX_FACTOR, slowest)

    def relative_error(self, rtol: float) -> float:
        """Latest error over the tolerance; 1 before the first error."""
        return self._errors[-1] / rtol if self._errors else 1.0

    def will_reach(self, rtol: float, meshes: int) -> bool:
        """True if `meshes` more meshes reach the tolerance, each with the gain of the latest."""
        if len(self._errors) < 2:
            return True
        before, now = self._errors[-2:]
        return now * min(now / before, 1.0) ** meshes <= rtol

    def for_other_depth(self) -> ErrorHistory:
        """New history for another depth at the same place, which keeps the estimated k."""
        other = ErrorHistory()
        other._largest, other._unseen, other._most = self._largest, self._unseen, self._most
        return other

    def record(self, frequency: Real, error: Real) -> None:
        """Add the relative error of the latest mesh, shape (..., frequency), at frequencies in
        Hz."""
        largest = error.reshape(-1, len(frequency)).max(axis=0)
        self._recorded = dict(zip(frequency.tolist(), largest.tolist(), strict=True))
        self._errors.append(float(largest.max()))

    def expected_at(self, frequency: Real, likely: float) -> Real:
        """Latest estimated error at the given frequencies; the maximum over all where one is
        missing.

        likely: predicted k of the next mesh; it corrects the error of a first mesh.
        """
        largest = max(self._recorded.values())
        error = np.array([self._recorded.get(each, largest) for each in frequency.tolist()])
        return (
            error
            if self._largest
            else error * np.clip(likely, MIN_FACTOR, self._unseen) / self._unseen
        )

    def effect(self, frequency: Real, Z: Admittances, finer: Admittances) -> Real:
        """k of this mesh, shape (frequency,).

        Z, finer: ohm, of two orders, at all `frequencies_around` the frequencies in Hz.
        """
        now = (1 / Z, 1 / finer)
        if self._Y is not None and np.isin(frequency, self._frequency).all():
            kept = np.flatnonzero(np.isin(self._frequency, frequency))
            before = (_in_thirds(each)[:, :, kept] for each in self._Y)
            self._largest = max(self._largest, _largest_ratio(*before, *map(_in_thirds, now)))
        self._frequency, self._Y = frequency, now
        if not self._largest:
            return np.full(len(frequency), self._unseen)
        at, k = self._foreseen
        foreseen = PREDICTED * np.interp(np.log(frequency), np.log(at), k)
        return np.clip(np.minimum(self._largest, foreseen), MIN_FACTOR, self._most)


def at_corners(exponents: Real | np.float64, order: int) -> Real:
    """k where the field varies as a power of the distance: D falls as order^(-4 power)."""
    return 1 / (1 - (order / (order + 1)) ** (4 * exponents))


def _in_thirds(Y: Admittances) -> Admittances:
    return Y.reshape(len(Y), 3, -1)


def _largest_ratio(
    coarse: Admittances, fine: Admittances, next_coarse: Admittances, next_fine: Admittances
) -> float:
    """Largest k of all interfaces and frequencies; 0 if none can be estimated. Y of two meshes,
    S."""
    shown = np.abs((coarse - fine) - (next_coarse - next_fine))
    usable = shown > MIN_DECREASE * np.abs(coarse - fine)
    k = np.abs(coarse - next_coarse) / np.where(usable, shown, np.inf)
    return float(np.median(k, axis=1).max(initial=0.0))


def by_orders(order: int, steps: list[Real]) -> Real:
    """Relative errors of Rs and Cp, shape (2, interface, frequency), without safety factor.

    steps: differences between neighbouring orders on one mesh: of `order` and order + 1, of order -
    1 and `order` and, optionally, of order - 2 and order - 1. They fall at least as a power of the
    order.
    """
    latest, before, *first = (step.max(axis=0) for step in steps)
    gained = _ratio(before, latest)
    power = np.log(gained) / math.log(order / (order - 1)) - 1
    left = (order / (order + 1)) ** np.maximum(power, 0.0)
    k = np.minimum(1 / np.maximum(1 - left, 1 / MAX_FACTOR_BY_ORDERS), MAX_FACTOR_BY_ORDERS)
    if not first:
        return k * steps[0]
    odd = np.minimum(PARITY, 1 / _ratio(first[0], before))
    return np.maximum(k * steps[0], odd * steps[1] / VARIED)


def _ratio(a: Real, b: Real) -> Real:
    """a / b, at least 1; 1 where b is 0."""
    return np.maximum(np.divide(a, b, out=np.ones_like(a), where=b > 0), 1.0)


@dataclass(frozen=True)
class SolvedLevel:
    """Trial functions of one order, and the system that their space is taken from."""

    space: Galerkin
    system: PressedSystem
    elements: Elements
    kept: CachedSteps = dataclasses.field(default_factory=CachedSteps)

    def under(self, circuit: Circuit, coefficients: PressCoefficients) -> SolvedLevel:
        """Level of another press on the same mesh; only the capacitance changes unless sheets are
        piezoresistive."""
        if coefficients.gauged:
            system = pressed_system(circuit, self.elements, coefficients, self.system.unknowns)
            space = Galerkin(system, circuit, self.elements.order)
            return SolvedLevel(space, system, self.elements)
        foam, air = masses_of(circuit, self.elements, coefficients, self.system.unknowns)
        system = replace(self.system, foam=foam, air=air)
        return replace(self, system=system, kept=CachedSteps())

    def swept(
        self, excitations: Sequence[Excitation], frequency: Real, loss: Loss, rtol: float
    ) -> Swept:
        """Forms of excitations at frequencies in Hz, see `lanczos.swept`."""
        system = self.system
        given = excitations, frequency, loss, system.any_air, rtol
        return swept_with_air(self.space, system.mass_with, *given, self.kept)


@dataclass(frozen=True)
class Discretised:
    """One press on one mesh with the levels that give its answer and error.

    description: the mesh in words. error: relative error of Rs and Cp by approximated geometry.
    lower: levels of one and of two orders less than `coarse`, if the error estimate needs them.
    history: errors of the previous meshes. deflection_error: relative error of Rs and Cp by the
    error of mechanics, shape (2, interface, frequency).
    """

    circuit: Circuit
    loss: Loss
    coefficients: PressCoefficients
    coarse: SolvedLevel
    fine: SolvedLevel
    description: str
    error: float = 0.0
    lower: tuple[SolvedLevel, ...] = ()
    history: ErrorHistory = dataclasses.field(default_factory=ErrorHistory)
    deflection_error: Real | float = 0.0

    def result(self, frequency: Real, rtol: float) -> ModelResult:
        """Impedance at these frequencies in Hz, and its estimated error."""
        around = frequencies_around(frequency)
        (Q, change), (finer, _), *lower = self._swept(around, KRYLOV_SHARE * rtol)
        combined = self.circuit.combination
        Z, steps = combined.impedance(Q), [combined.relative_change(Q, finer)]
        if lower:
            each = [Q, *(of_lower for of_lower, _ in lower)]
            steps += [combined.relative_change(low, high) for high, low in pairwise(each)]
            off = by_orders(self.coarse.space.order, [smoothed(step) for step in steps])
        else:
            off = self.history.effect(frequency, Z, combined.impedance(finer)) * smoothed(steps[0])
        here = np.s_[:, : len(frequency)]
        error = VARIED * both(off) + change[here] + ROUNDING
        error = error + self.error + self.deflection_error
        if self.missed.max() > NEGLIGIBLE * rtol:
            error += self.changes(raised_by_rule(self.coefficients, self.missed), frequency, rtol)
        self.history.record(frequency, error)
        return ModelResult(
            self.description + describe_accuracy(self.coefficients.materials),
            self.coarse.space.inner,
            Z[here],
            error,
        )

    def _swept(self, frequency: Real, rtol: float) -> list[Swept]:
        given = self.circuit.excitations, frequency, self.loss, rtol
        with one_blas_thread():
            return [each.swept(*given) for each in (self.coarse, self.fine, *self.lower)]

    def changes(self, raised: Raised, frequency: Real, rtol: float) -> Real:
        """Relative changes of Rs and Cp by raised coefficients, shape (2, interface, frequency)."""
        own, given = self.coarse, (self.circuit.excitations, frequency, self.loss)
        other = own.under(self.circuit, raised)
        with one_blas_thread():
            Q, moved = (each.swept(*given, KRYLOV_SHARE * rtol)[0] for each in (own, other))
        return both(self.circuit.combination.relative_change(Q, moved))

    @cached_property
    def missed(self) -> Real:
        """Relative error of each cell's capacitance by the quadrature rule, shape (cell,)."""
        return missed(self.coarse.elements, self.coefficients)

    def coefficients_of(
        self, solved: SolvedLevel, excitation: int, s: complex, air: complex = 1.0
    ) -> NDArray:
        """Potentials of an excitation at s in rad/s, real or complex, shape (field, function,
        cell).

        air: factor on the capacitance in air, see `scene.air_nodes`.
        """
        mass = solved.system.mass_with(air)
        with one_blas_thread():
            v = solved.space.potentials(mass, self.circuit.excitations[excitation], s)
        return on_cells(solved.system.unknowns, solved.elements.trial, v)

    def coefficients_at(self, solved: SolvedLevel, excitation: int, s: Real) -> list[Real]:
        """Potentials at real s >= 0, from the Lanczos steps of a sweep if they are accurate there.

        Otherwise each s is solved.
        """
        own, mass = self.circuit.excitations[excitation], solved.system.mass
        steps = solved.kept.of(own, s)
        if steps is None:
            return [self.coefficients_of(solved, excitation, each) for each in s.tolist()]
        with one_blas_thread():
            V = solved.space.potentials_by(steps, mass, own, s)
        return [on_cells(solved.system.unknowns, solved.elements.trial, v) for v in V.T]


MIN_REFINED_ENERGY = 0.1
"""Smallest energy that meshes are refined for, over that of all excitations of an interface."""
KEPT = 0.7
"""Share of the whole error in the marked cells."""


def indicators(discretised: Discretised, frequency: Real) -> Real:
    """Share of each cell in the error of Rs and Cp at frequencies in Hz, shape (frequency, cell).

    Potentials are computed at s = omega instead of j omega: they are real and decay over the same
    length. The energy of the part that the next order adds is the change of Y. Relative to the
    power in the sheets it is the error of Rs, relative to the energy in the foam that of Cp.
    Quadrature errors of the foam are included.
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
    discretised: Discretised, s: float, weights: Real, of_drives: Sequence[tuple[Real, Real]]
) -> Real:
    """Share of each cell in the error of one interface; the errors of its excitations add."""
    added = [np.add(*_energies(discretised, s, added_w)) for _, added_w in of_drives]
    heat, stored = zip(*(_energies(discretised, s, w) for w, _ in of_drives), strict=True)
    missed = [each + discretised.missed * own for each, own in zip(added, stored, strict=True)]
    return _over_all(weights, added, heat) + _over_all(weights, missed, stored)


def _over_all(weights: Real, part: Sequence[Real], whole: Sequence[Real]) -> Real:
    """Parts over the sum of the whole; 0 if that sum is 0.

    The sum is 0 behind foils that insulate, where heat in the sheet is below double precision. The
    parts of all excitations add; the whole counts as at least MIN_REFINED_ENERGY of its absolute
    sum, though excitations are subtracted.
    """
    parts, signed, unsigned = (
        sum(w * each for w, each in zip(signs, of_each, strict=True))
        for signs, of_each in ((abs(weights), part), (weights, whole), (abs(weights), whole))
    )
    total = max(np.sum(signed), MIN_REFINED_ENERGY * np.sum(unsigned))
    return parts / total if total > 0 else np.zeros_like(parts)


def marked_cells(parts: Real) -> Integer:
    """Smallest set of cells with the share KEPT of the error (Doerfler marking).

    Source: W. Doerfler, SINUM 33 (1996) 1106.
    """
    return fewest(parts, KEPT * float(parts.sum()))


def _potentials(discretised: Discretised, excitation: int, s: Real) -> list[tuple[Real, Real]]:
    """Potentials of the finer order, and the part that it adds, at each s.

    As coefficients, shape (field, function, cell).
    """
    coarse, fine = (
        discretised.coefficients_at(each, excitation, s)
        for each in (discretised.coarse, discretised.fine)
    )
    raised = raising(discretised.coarse.elements.order)
    return [(w, w - raised @ v) for v, w in zip(coarse, fine, strict=True)]


def _energies(discretised: Discretised, s: float, of_fields: Real) -> tuple[Real, Real]:
    """Energies of potentials at s in the sheets and in the foam, W, both of shape (cell,).

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
