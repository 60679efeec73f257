"""Sweep of a space: forms of excitations at many frequencies from few real solves."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ..arrays import Complex, Real
from ..scene.air_nodes import LOSSLESS_FOAM, AirNodes, air_factor, air_nodes
from ..scene.frequency import Loss, laplace_variable
from ..sweeps import ToleranceError
from .error_estimate import Swept
from .factors import Mass
from .galerkin import Galerkin
from .lanczos import MAX_LANCZOS_STEPS, CachedSteps, Steps, respond, respond_together
from .terminals import Combination, Excitation, combination

REACH = 10.0
KEPT_NUMBERS = 2_000_000
"""Maximum count of numbers in the cached vectors of a sweep."""


def swept(
    space: Galerkin,
    mass: Mass,
    excitations: Sequence[Excitation],
    s: Complex,
    rtol: float,
    kept: CachedSteps | None = None,
) -> Swept:
    """Forms of excitations at each s in rad/s, and relative errors of the interfaces.

    The excitations combine to interfaces as in `terminals.combination`. mass: M in F.
    """
    fits = MAX_LANCZOS_STEPS * space.inner * len(excitations) <= KEPT_NUMBERS
    own, combined = kept if fits else None, combination(excitations)
    Q, error = np.empty((len(excitations), len(s)), dtype=np.complex128), []
    for weights, group in zip(combined.weights, combined.groups, strict=True):
        some = [excitations[k] for k in group]
        Q[group], of_interface = _interface(space, mass, some, weights[group], s, rtol, own)
        error.append(of_interface)
    return Q, np.stack(error)


def swept_with_air(
    space: Galerkin,
    mass_with: Callable[[complex], Mass],
    excitations: Sequence[Excitation],
    frequency: Real,
    loss: Loss,
    any_air: bool,
    rtol: float,
    kept: CachedSteps | None = None,
) -> Swept:
    """Like `swept` at frequencies in Hz, where only the foam has the loss.

    mass_with: M in F with a factor on the capacitance in air. If the foam conducts too much for
    `air_nodes`, each frequency is solved by itself.
    """
    s = laplace_variable(frequency, loss)
    try:
        air = air_nodes(frequency, loss, rtol) if any_air else LOSSLESS_FOAM
    except ToleranceError:
        return _one_by_one(space, mass_with, excitations, s, air_factor(frequency, loss))
    if air.single:
        return swept(space, mass_with(1.0), excitations, s, rtol, kept)
    return _at_nodes(space, mass_with, excitations, s, rtol, air)


def _at_nodes(
    space: Galerkin,
    mass_with: Callable[[complex], Mass],
    excitations: Sequence[Excitation],
    s: Complex,
    rtol: float,
    air: AirNodes,
) -> Swept:
    masses = [mass_with(factor) for factor in air.factors.tolist()]
    each = [swept(space, mass, excitations, s, rtol * air.precision) for mass in masses]
    Q, errors = zip(*each, strict=True)
    return air.mean(Q), np.max(errors, axis=0) / air.precision


def _one_by_one(
    space: Galerkin,
    mass_with: Callable[[complex], Mass],
    excitations: Sequence[Excitation],
    s: Complex,
    factors: Complex,
) -> Swept:
    masses = [mass_with(factor) for factor in factors.tolist()]
    Q = [
        [space.form(mass, excitation, each) for mass, each in zip(masses, s.tolist(), strict=True)]
        for excitation in excitations
    ]
    return np.array(Q), np.zeros((len(combination(excitations).weights), len(s)))


def _interface(
    space: Galerkin,
    mass: Mass,
    excitations: Sequence[Excitation],
    weights: Real,
    s: Complex,
    rtol: float,
    kept: CachedSteps | None,
) -> Swept:
    """Forms of one interface and its relative error.

    Real solves about zero come first, then about shifts for the frequencies that those leave.
    """
    steps = None if kept is None else [Steps() for _ in excitations]

    def about(shift: float, s: Complex, steps: list[Steps] | None = None) -> Swept:
        pencils = [space.pencil(mass, excitation, shift) for excitation in excitations]
        if len(pencils) > 1:
            return respond_together(pencils, Combination(weights[None]), s, rtol, steps)
        Y, error = respond(pencils[0], s, rtol, kept=steps[0] if steps else None)
        return Y[None], error

    Q, error = about(0.0, s, steps)
    left = np.flatnonzero(error > rtol)
    if kept is not None and steps is not None:
        reached = np.abs(s) < np.abs(s[left]).min(initial=np.inf)
        for excitation, own in zip(excitations, steps, strict=True):
            if own.basis:
                kept.steps[excitation] = own, float(np.abs(s[reached]).max(initial=0.0))
    while left.size:
        shift = REACH * float(s.imag[left[0]])
        Q[:, left], error[left] = about(shift, s[left])
        left = left[1:][error[left[1:]] > rtol]
    return Q, error
