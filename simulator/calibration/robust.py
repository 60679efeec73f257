"""Fit with Student's t errors, where the data ask for it or the user requests it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..arrays import Real
from .fitting.fit import Fit
from .fitting.prior import Noise, display_step, with_noise
from .likelihood.student import FAR_OFF, StudentT, fitted_tail, likeliest
from .results.identifiability import information

ROUNDS = 12
SETTLED = 0.01
"""Relative change of degrees of freedom and scale at which they have converged."""
NAMED = 6
"""Largest number of readings that a remark names."""
FROM_RESIDUALS = "the residuals of the fit"

Refit = Callable[[Noise, StudentT | None], Fit]


def robust_fit(fit: Fit, noise: Noise, requested: bool | None, refit: Refit) -> tuple[Fit, Noise]:
    """The fit with Student's t errors and the noise of it, or the given ones with normal errors.

    fit: with normal errors. requested: True for Student's t, False for normal errors, None for the
    likelier of both. Noise that was estimated is estimated anew from the residuals, because
    readings far off enlarge it.
    """
    if requested is False:
        return fit, noise
    squares, freedom = fit.problem.squares(fit.u), information(fit).freedom
    parts = fit.spec.measurements.per_reading
    chosen = likeliest if requested is None else fitted_tail
    tail = chosen(squares, freedom, parts=parts)
    if tail is None or (requested is None and not _matters(squares, tail, noise)):
        return fit, noise
    if not noise.stated:
        noise = replace(noise, guessed=True, source=FROM_RESIDUALS)
    for _ in range(ROUNDS):
        noise, tail = _rescaled(noise, tail)
        fit, before = refit(noise, tail), tail
        squares, freedom = fit.problem.squares(fit.u), information(fit).freedom
        tail = fitted_tail(squares, freedom, 1.0 if noise.stated else 0.0, parts)
        if _change(before, tail) < SETTLED:
            break
    return fit, noise


def _matters(squares: Real, tail: StudentT, noise: Noise) -> bool:
    """True if some reading is far off in units of the noise, and not only of rounding."""
    if not noise.stated and noise.readout.magnitude_noise <= display_step(noise.readout):
        return False
    scale = max(tail.scale, 1.0) if noise.stated else tail.scale
    return bool((squares > FAR_OFF * scale**2).any())


def _rescaled(noise: Noise, tail: StudentT) -> tuple[Noise, StudentT]:
    """Noise and distribution whose scale is 1 where the residuals determine the noise."""
    if noise.stated:
        return noise, replace(tail, scale=max(tail.scale, 1.0))
    readout = noise.readout
    magnitude = tail.scale * readout.magnitude_noise
    phase = tail.scale * readout.phase_noise
    return replace(noise, readout=with_noise(readout, magnitude, phase)), replace(tail, scale=1.0)


def _change(before: StudentT, after: StudentT) -> float:
    return max(abs(after.freedom / before.freedom - 1), abs(after.scale / before.scale - 1))


def tail_remarks(fit: Fit) -> list[str]:
    """Remarks on the distribution of errors; none where it is normal."""
    tail = fit.spec.tail
    if tail is None:
        return []
    squares = fit.problem.squares(fit.u) / tail.scale**2
    off = np.flatnonzero(squares > FAR_OFF)
    return [
        f"errors of readings have Student's t distribution of {tail.freedom:.2g} degrees of "
        f"freedom; {len(off)} of {len(squares)} readings are more than "
        f"{np.sqrt(FAR_OFF):.0f} times the noise off{_named(fit, off)}"
    ]


def _named(fit: Fit, off: NDArray[np.intp]) -> str:
    """Frequencies of readings far off. off: their numbers among the used readings."""
    measured = fit.spec.measurements
    used = np.stack([measured.read & sweep.known for sweep in measured.sweeps])
    f = measured.parts.setup.frequency[np.nonzero(used)[2][off]]
    if not len(f):
        return ""
    several = f" and {len(set(f)) - NAMED} more" if len(set(f)) > NAMED else ""
    return f", at {', '.join(f'{each:.4g}' for each in sorted(set(f))[:NAMED])} Hz{several}"
