"""A whole sweep from a few real solves: Lanczos for (K + sigma M)^-1 M, and a continued fraction.

With A = K + sigma M, the driven potentials g of s = sigma (A g = 0 inside) and t = s - sigma,
Y(s) = Y(sigma) + t g'Mg - t² (Mg)'(A + t M)^-1 (Mg), and the last product is
b_0² e1'(I + t T)^-1 e1 = b_0² / (1 + t a_1 - t² b_1² / (1 + t a_2 - ...)): Galerkin's method in the
real space that Lanczos' method spans, so all poles are real and negative at any step.

Excitations of one interface are solved to the accuracy that their sum needs: the error is measured
at the interface, so an excitation that contributes little there takes few steps.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Complex, Integer, Real
from .error_estimate import LOST_SUSCEPTANCE, Swept, lost_digits, rounded
from .lazy_kernel import LazyKernel

if TYPE_CHECKING:
    from .terminals import Combination, Excitation

MAX_LANCZOS_STEPS = 60
MIN_LANCZOS_STEPS = 3


def last_change_readable(
    s: Complex, shift: float, at_once: Complex, diagonal: Real, squared: Real, steps: int
) -> tuple[Complex, Real]:
    """Do what `last_change` does with Python's numbers, which divide as numba does."""
    a, b = diagonal[:steps].tolist(), squared[:steps].tolist()

    def fraction(t: complex, steps: int) -> complex:
        value = 1.0 / (1.0 + t * a[steps - 1])
        for step in range(steps - 2, -1, -1):
            value = 1.0 / (1.0 + t * a[step] - t * t * b[step + 1] * value)
        return value

    Y, change = np.empty_like(s), np.empty(len(s))
    for k, (each, first) in enumerate(zip(s.tolist(), at_once.tolist(), strict=True)):
        t = each - float(shift)
        scale = t * t * b[0]
        before, now = first, first - scale * fraction(t, steps)
        if steps > 1:
            before -= scale * fraction(t, steps - 1)
        B = max(abs(now.imag), LOST_SUSCEPTANCE * abs(now))
        Rs = abs((1.0 / before).real / (1.0 / now).real - 1.0)
        Y[k], change[k] = now, max(Rs, abs(before.imag - now.imag) / B)
    return Y, change


last_change = LazyKernel(
    lambda kernels: kernels.last_change,
    last_change_readable,
    lambda s, *others: 6e-7 * len(s) * (4 + others[-1]),
)


@dataclass(frozen=True)
class Pencil:
    """K + s M of one excitation, as Lanczos' method needs it.

    start: M g, the charge of the driven potentials. mass: v to M v. inverse: y to (K + sigma M)^-1
    y. admittance: Y(sigma) in S. capacitance: g'Mg in F. shift: sigma in 1/s.
    """

    start: Real
    mass: Callable[[Real], Real]
    inverse: Callable[[Real], Real]
    admittance: float
    capacitance: float
    shift: float


def respond(
    pencil: Pencil,
    s: Complex,
    rtol: float,
    most_steps: int = MAX_LANCZOS_STEPS,
    kept: Steps | None = None,
) -> tuple[Complex, Real]:
    """Y(s) in S, and its relative error in Rs and Cp; both of shape (s,). kept: the steps are added
    to it.

    The error is the change by the last steps, plus rounding. Ends when the change is within rtol
    everywhere, when the space is exhausted, or after most_steps. While the frequency farthest from
    the shift still changes more, the others are not evaluated.
    """
    at_once = pencil.admittance + (s - pencil.shift) * pencil.capacitance
    diagonal, squared = np.empty(most_steps), np.empty(most_steps)
    farthest = [int(np.abs(s - pencil.shift).argmax())]

    def changed(steps: int) -> tuple[Complex, Real]:
        return last_change(s, pencil.shift, at_once, diagonal, squared, steps)

    def settled(steps: int) -> bool:
        some = s[farthest], pencil.shift, at_once[farthest]
        return last_change(*some, diagonal, squared, steps)[1][0] <= rtol

    unknown = np.full(len(s), np.inf)
    steps, Y, change, before, quiet = 0, at_once, unknown, unknown, False
    for step in itertools.islice(coefficients(pencil), most_steps):
        squared[steps], diagonal[steps], _ = step
        steps += 1
        if kept is not None:
            kept.add(*step)
        if steps < most_steps and (steps < MIN_LANCZOS_STEPS or not settled(steps)):
            change = unknown
            continue
        skipped = change is unknown and steps == most_steps > MIN_LANCZOS_STEPS
        before = changed(steps - 1)[1] if skipped else change
        Y, change = changed(steps)
        quiet = max(before.max(), change.max()) <= rtol
        if quiet:
            break
    if steps < most_steps and not quiet:
        before = change = np.zeros(len(s))
        if steps:
            Y, _ = changed(steps)
    return Y, np.maximum(before, change) + lost_digits(Y, at_once)


def potentials(
    pencil: Pencil, shifts: Real, rtol: float, most_steps: int = MAX_LANCZOS_STEPS
) -> Real:
    """u(s) - u(0) in V at real s >= 0 of an unshifted pencil, shape (unknown, s).

    Ends when the last step adds less than rtol at every s, in the norm of K.
    """
    found = _Spanned(shifts)
    for step in itertools.islice(coefficients(pencil), most_steps):
        if found.settled(*step, rtol):
            break
    return found.potentials if found.steps.basis else np.zeros((len(pencil.start), len(shifts)))


@dataclass(frozen=True)
class Pencils:
    """Unshifted pencils of one K that are solved together.

    start: M g of each, shape (pencil, unknown). mass, inverse: called with vectors, shape (some,
    unknown), and the indices of their pencils; return M v and K^-1 y.
    """

    start: Real
    mass: Callable[[Real, Integer], Real]
    inverse: Callable[[Real, Integer], Real]


def potentials_of_all(
    pencils: Pencils, shifts: Real, rtol: float, most_steps: int = MAX_LANCZOS_STEPS
) -> list[Real]:
    """`potentials` of each pencil, all advanced step by step together."""
    found = [_Spanned(shifts) for _ in pencils.start]
    going, residual = np.arange(len(found)), pencils.start
    beta, w = np.zeros(len(found)), np.zeros_like(residual)
    for _ in range(most_steps):
        solution = pencils.inverse(residual, going)
        squared = (residual * solution).sum(axis=1)
        live = squared > 0
        going, squared, w_before = going[live], squared[live], w[live]
        beta = np.sqrt(squared)[:, None]
        q, w = solution[live] / beta, residual[live] / beta
        product = pencils.mass(q, going)
        diagonal = (q * product).sum(axis=1)
        settled = [
            found[k].settled(*each, rtol)
            for k, *each in zip(going, squared, diagonal, q, strict=True)
        ]
        left = ~np.array(settled, dtype=bool)
        if not left.any():
            break
        residual = (product - diagonal[:, None] * w - beta * w_before)[left]
        going, w = going[left], w[left]
    nothing = np.zeros((pencils.start.shape[1], len(shifts)))
    return [each.potentials if each.steps.basis else nothing for each in found]


class Steps:
    """Steps of Lanczos' method for one unshifted pencil, and the potentials that follow from
    them."""

    def __init__(self) -> None:
        self.basis: list[Real] = []
        self.squared: list[float] = []
        self._diagonal: list[float] = []

    def add(self, squared: float, diagonal: float, q: Real) -> None:
        """Append one step."""
        self.squared.append(squared)
        self._diagonal.append(diagonal)
        self.basis.append(q)

    @property
    def coefficients(self) -> list[tuple[float, float]]:
        """b_0² and a_1, b_1² and a_2, ..."""
        return list(zip(self.squared, self._diagonal, strict=True))

    def potentials(self, shifts: Real) -> Real:
        """u(s) - u(0) in V at real s >= 0, shape (unknown, s)."""
        return np.array(self.basis).T @ self.parts(shifts)

    def parts(self, shifts: Real) -> Real:
        """Coefficient of each basis vector, shape (step, s): -s (1 + s T)^-1 e1 b_0."""
        beta = np.sqrt(self.squared[1:])
        T = np.diag(self._diagonal) + np.diag(beta, 1) + np.diag(beta, -1)
        start = np.eye(len(T), 1) * np.sqrt(self.squared[0])
        solved = np.linalg.solve(np.eye(len(T)) + shifts[:, None, None] * T, start)[:, :, 0]
        return np.ascontiguousarray((-shifts[:, None] * solved).T)


class CachedSteps:
    """Lanczos steps about zero of a sweep's excitations, and the |s| in rad/s up to which they are
    accurate."""

    def __init__(self) -> None:
        self.steps: dict[Excitation, tuple[Steps, float]] = {}

    def of(self, excitation: Excitation, s: Real) -> Steps | None:
        """Steps of an excitation, or None unless they are accurate at all s."""
        steps, reach = self.steps.get(excitation, (None, 0.0))
        return steps if s.max() <= reach else None


class _Spanned:
    """Lanczos steps for one pencil, until its potentials at the shifts are accurate."""

    def __init__(self, shifts: Real) -> None:
        self.shifts = shifts
        self.steps = Steps()
        self._pivot = self._last = np.ones(len(shifts))

    def settled(self, squared: float, diagonal: float, q: Real, rtol: float) -> bool:
        """Take one step; True if it adds less than rtol at every s, in the norm of K.

        That norm is at most |s| b_0, which shows without a solve that most steps still matter.
        """
        t = self.shifts
        self._pivot = 1 + t * diagonal - (t**2 * squared / self._pivot if self.steps.basis else 0.0)
        self._last = -t * np.sqrt(squared) * self._last / self._pivot
        self.steps.add(squared, diagonal, q)
        if (np.abs(self._last) > rtol * np.abs(t) * np.sqrt(self.steps.squared[0])).any():
            return False
        parts = self.steps.parts(t)
        return bool((np.abs(parts[-1]) <= rtol * np.linalg.norm(parts, axis=0)).all())

    @property
    def potentials(self) -> Real:
        """u(s) - u(0) in V at the shifts, shape (unknown, s)."""
        return self.steps.potentials(self.shifts)


def coefficients(pencil: Pencil) -> Iterator[tuple[float, float, Real]]:
    """b_0², a_1 and q_1, b_1², a_2 and q_2, ... until the space is exhausted; Q'KQ = 1."""
    beta, w, residual = 0.0, np.zeros_like(pencil.start), pencil.start
    while True:
        solution = pencil.inverse(residual)
        squared = float(residual @ solution)
        if not squared > 0:
            return
        w_before, beta = w, np.sqrt(squared)
        q, w = solution / beta, residual / beta
        product = pencil.mass(q)
        diagonal = float(q @ product)
        yield squared, diagonal, q
        residual = product - diagonal * w - beta * w_before


def respond_together(
    pencils: Sequence[Pencil],
    combined: Combination,
    s: Complex,
    rtol: float,
    kept: Sequence[Steps] | None = None,
) -> Swept:
    """Forms in S at each s in rad/s, shape (pencil, s), and the relative error of Rs and Cp of the
    interface, shape (s,), as in `lanczos.respond`.

    combined: of one interface. kept: the steps are added to these.
    """
    steps = kept or [Steps() for _ in pencils]
    found = [_Fraction(pencil, own, s) for pencil, own in zip(pencils, steps, strict=True)]
    at_once = now = np.stack([each.form() for each in found])
    before = change = np.full(len(s), np.inf)
    for step in itertools.count(1):
        if not any([each.advance() for each in found]):
            before = change = np.zeros(len(s))
            break
        last, now = now, np.stack([each.form() for each in found])
        if step < MIN_LANCZOS_STEPS:
            continue
        before, change = change, combined.relative_change(last, now).max(axis=(0, 1))
        if step == MAX_LANCZOS_STEPS or max(before.max(), change.max()) <= rtol:
            break
    delayed = np.abs(combined.weights) @ np.abs(at_once - now)
    return now, np.maximum(before, change) + rounded(combined.admittance(now), delayed)[0]


class _Fraction:
    """Continued fraction of one pencil, extended step by step; see `lanczos`."""

    def __init__(self, pencil: Pencil, steps: Steps, s: Complex) -> None:
        self._t, self._steps, self._going = s - pencil.shift, steps, coefficients(pencil)
        self._at_once = pencil.admittance + self._t * pencil.capacitance

    def advance(self) -> bool:
        """Take one more step; False if the Krylov space is exhausted."""
        step = next(self._going, None)
        if step is not None:
            self._steps.add(*step)
        return step is not None

    def form(self) -> Complex:
        """Q in S after the steps so far, shape (s,)."""
        t, value = self._t, np.zeros_like(self._t)
        for squared, diagonal in reversed(self._steps.coefficients):
            value = squared / (1 + t * diagonal - t**2 * value)
        return self._at_once - t**2 * value
