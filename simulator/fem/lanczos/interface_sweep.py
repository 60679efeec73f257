"""Sweep of a space: forms of excitations at many frequencies from few real solves."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...arrays import Complex, Real
from ..error_estimate import Swept
from ..galerkin import Galerkin
from ..matrices.low_rank import Mass
from ..terminals.excitation import Combination, Excitation, combination
from .combined_lanczos import respond_together
from .lanczos import MAX_LANCZOS_STEPS, CachedSteps, Steps, respond

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

    The excitations combine to interfaces as in `excitation.combination`. mass: M in F.
    """
    fits = MAX_LANCZOS_STEPS * space.inner * len(excitations) <= KEPT_NUMBERS
    own, combined = kept if fits else None, combination(excitations)
    Q, error = np.empty((len(excitations), len(s)), dtype=np.complex128), []
    for weights, group in zip(combined.weights, combined.groups, strict=True):
        some = [excitations[k] for k in group]
        Q[group], of_interface = _interface(space, mass, some, weights[group], s, rtol, own)
        error.append(of_interface)
    return Q, np.stack(error)


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
