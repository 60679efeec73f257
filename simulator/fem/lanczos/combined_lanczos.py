"""Lanczos' method for all excitations of one interface, to the accuracy that their sum needs.

The error is measured at the interface, so an excitation that contributes little there takes few
steps.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np

from ...arrays import Complex
from ..error_estimate import Swept, rounded
from ..terminals.excitation import Combination
from .lanczos import MAX_LANCZOS_STEPS, MIN_LANCZOS_STEPS, Pencil, Steps, coefficients


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
