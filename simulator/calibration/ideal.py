"""Why an ideal capacitance cannot follow what was measured, where a constant-phase one can."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from simulator.calibration.fit import Fit, Tell, fitted
from simulator.calibration.problem import difference

IDEAL = {"phase_exponent": 1.0, "loss_tangent": 0.0}
LOW_END = 6
"""Part of the frequencies that are its low end."""


@dataclass(frozen=True)
class Comparison:
    """The fit beside the best one of an ideal capacitance, and what sets them apart."""

    ideal: Fit = field(repr=False)
    rms_error: float
    ideal_rms_error: float
    told: tuple[str, ...]


def compared(fit: Fit, tell: Tell) -> Comparison:
    """With the exponent held at 1 and without loss, all else fitted alike."""
    fixed = {**fit.asked.fixed, **IDEAL}
    others = {name: prior for name, prior in fit.asked.fitted.items() if name not in IDEAL}
    asked = replace(fit.asked, fitted=others, fixed=fixed)
    ideal = fitted(asked, fit.problem.around, tell=tell)
    told = _told(fit, ideal)
    return Comparison(ideal, fit.rms_error, ideal.rms_error, told)


def _told(fit: Fit, ideal: Fit) -> tuple[str, ...]:
    frequency = fit.asked.measured.scene.frequencies
    Z = fit.asked.measured.readings[0].Z[0]
    ours, theirs = (each.problem.fitted(each.u)[0, 0] for each in (fit, ideal))
    exponent = fit.values["phase_exponent"]
    lines = [
        f"with an ideal capacitance (exponent 1) the best fit leaves {100 * ideal.rms_error:.1f} % "
        f"rms of Z, with the exponent {exponent:.3f} {100 * fit.rms_error:.1f} %"
    ]
    if len(frequency) >= 2 * LOW_END:
        lines += [_systematic(theirs, Z), _low_end(frequency, Z, ours, theirs, exponent)]
    return tuple(lines)


def _systematic(fitted: NDArray[np.complex128], Z: NDArray[np.complex128]) -> str:
    phase = np.degrees(difference(fitted[None], Z[None]).reshape(2, -1)[1])
    runs = 1 + int((np.diff(np.sign(phase)) != 0).sum())
    return (
        f"the phase of the ideal fit is off by {phase.min():+.1f} to {phase.max():+.1f} degrees, "
        f"in {runs} runs of one sign over {len(phase)} frequencies (chance makes about "
        f"{(len(phase) + 1) // 2}): it is the wrong curve, not noise"
    )


def _low_end(
    frequency: NDArray[np.float64],
    Z: NDArray[np.complex128],
    ours: NDArray[np.complex128],
    theirs: NDArray[np.complex128],
    exponent: float,
) -> str:
    low = slice(0, max(4, len(frequency) // LOW_END))
    read, own, ideal = (_slopes(frequency[low], each[low]) for each in (Z, ours, theirs))
    return (
        f"from {frequency[0]:.3g} to {frequency[low][-1]:.3g} Hz |Z| was measured to go as "
        f"f^{read[0]:.2f}, Rs as f^{read[1]:.2f}, at {read[2]:.1f} degrees. An ideal line's Rs "
        f"levels off where its |Z| nears 1/f: at its best f^{ideal[0]:.2f}, f^{ideal[1]:.2f} and "
        f"{ideal[2]:.1f} degrees. Where |Z| and Rs both go on, the capacitance itself turns the "
        f"phase: exponent {exponent:.3f} gives f^{own[0]:.2f}, f^{own[1]:.2f} and "
        f"{own[2]:.1f} degrees"
    )


def _slopes(
    frequency: NDArray[np.float64], Z: NDArray[np.complex128]
) -> tuple[float, float, float]:
    """Powers of f that |Z| and Rs go as, and the mean phase in degrees."""
    logarithm = np.log(frequency)
    magnitude, resistance = (
        float(np.polyfit(logarithm, np.log(np.abs(each)), 1)[0]) for each in (Z, Z.real)
    )
    return magnitude, resistance, math.degrees(float(np.angle(Z).mean()))
