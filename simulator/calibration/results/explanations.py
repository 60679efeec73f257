"""Explanations of a calibration, a line each: misfit, noise, widening, and what is assumed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...arrays import Complex, Real
from ...models.parameters import SOURCE
from ...sweeps.errors import named
from .sheet_intervals import MISMATCH

if TYPE_CHECKING:
    from ..fit_options import FitSpec
    from ..run import Calibration
    from .identifiability import Information

TIED = 0.95
WIDENED = 1.2
"""Chi-squared per degree of freedom from which the report states that it widens intervals."""


def explanations(calibration: Calibration) -> list[str]:
    """Remarks on the fit, a line each."""
    spec = calibration.fit.spec
    readings = "gains" if spec.measurements.parts.setup.gain else "Z"
    lines = [
        f"chi-squared per degree of freedom {calibration.chi_squared:.3g}"
        f"{' by construction' if calibration.noise.guessed else ''}; "
        f"rms relative error of {readings} {100 * calibration.rms_error:.3g} %",
        f"noise from {calibration.noise.source}: {_noise(spec)}",
    ]
    lines += _widening(calibration.information)
    if spec.touch_count:
        lines.append(_strength_range(calibration))
    lines += _source(calibration)
    lines += assumptions(calibration)
    lines += _strong_correlations(calibration)
    lines += calibration.remarks
    return [*lines, *(calibration.ideal.sentences if calibration.ideal else ())]


def _noise(spec: FitSpec) -> str:
    """Noise of magnitude and phase of the measured readings, with its range where it has one."""
    noise = spec.readout.noise(*readings_of(spec))
    found = (
        " to ".join(dict.fromkeys(f"{scale * each:.3g}" for each in (own.min(), own.max())))
        for own, scale in zip(noise, (100, 1e3), strict=True)
    )
    magnitude = "|V / V_s|" if spec.measurements.parts.setup.gain else "|Z|"
    units = (f"% of {magnitude}", "mrad")[: spec.measurements.per_reading]
    return ", ".join(f"{each} {unit}" for each, unit in zip(found, units, strict=False))


def readings_of(spec: FitSpec) -> tuple[Complex, Real]:
    """Z in ohm of all readings, shape (sweep, reading), and the frequency of each, Hz."""
    read, f = spec.measurements.read, spec.measurements.parts.setup.frequency
    Z = np.stack([each.Z[read] for each in spec.measurements.sweeps])
    return Z, np.broadcast_to(f, read.shape)[read]


def _widening(information: Information) -> list[str]:
    """A line on the factor by which intervals are wider than by independent noise, and why."""
    scale, count = information.scale, information.correlated
    if scale < WIDENED:
        return []
    reasons = {
        f"exceed the noise ({(scale / count) ** 0.5:.2g} times)": scale / count,
        f"are correlated ({count**0.5:.2g} times: {count:.2g} of them count as one)": count,
    }
    why = " and ".join(reason for reason, share in reasons.items() if share > WIDENED**0.5)
    wider = f"intervals are {scale**0.5:.2g} times as wide as by the noise alone"
    return [f"{wider}, because the residuals {why}"]


def _strong_correlations(calibration: Calibration) -> list[str]:
    """A line for each pair of strongly correlated estimates."""
    names, rows = calibration.information.names, calibration.information.correlation
    return [
        f"{names[i]} and {names[j]} are strongly correlated ({rows[i, j]:+.3f})"
        for i in range(len(names))
        for j in range(i)
        if abs(rows[i, j]) > TIED
    ]


def _source(calibration: Calibration) -> list[str]:
    """A line on the voltage of the source of gains, where that is a parameter."""
    if SOURCE not in calibration.intervals:
        return []
    value, error = calibration.values[SOURCE], calibration.standard_errors[SOURCE]
    if calibration.identified[SOURCE]:
        return [f"the source has {value:.4g} times the stated voltage, standard error {error:.2g}"]
    return [
        f"the voltage of the source is not identified by these gains ({value:.3g} times the "
        f"stated one, standard error {error:.2g}); if it is known, use {named('fix')} {SOURCE}"
    ]


def _strength_range(calibration: Calibration) -> str:
    problem, nothing = calibration.fit.problem, np.zeros_like(calibration.fit.u)
    stated = [problem.strengths(nothing, k) for k in range(len(problem.cells))]
    pairs = zip(calibration.strengths, stated, strict=True)
    over = [
        float(own / stated_rise)
        for rises, stated_rises in pairs
        for own, stated_rise in zip(rises, stated_rises, strict=True)
    ]
    return (
        f"rises of {len(over)} touches are {min(over):.2f} to {max(over):.2f} times the stated ones"
    )


def assumptions(calibration: Calibration) -> list[str]:
    """Quantities that are assumed, not identified, a line each."""
    left = ", ".join(name for name in calibration.not_fitted if name != MISMATCH)
    kept = f"not fitted; scene's values kept, uncertain within their priors: {left}"
    return [*([kept] if left else []), *calibration.unclear]
