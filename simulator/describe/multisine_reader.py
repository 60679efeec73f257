"""Facts about the multisine reader of a scene, with the unpressed skin."""

from __future__ import annotations

import numpy as np

from ..arrays import Complex, Real
from ..models.solver import Solver
from ..press.press import Press
from ..scene.multisine import Multisine, crest_factor, multisine_deviation, output_peak
from ..scene.parts import SceneParts
from ..sweeps.units import prefixed

FILLED = 0.7
"""Peak of the output for the unpressed skin over the ADC's range; presses raise the current."""
STEPS = 20
"""Repetitions of the fit of the resistance, which has converged long before."""
MAX_RESISTANCE = 1e9
"""Largest feedback resistance, ohm; beyond it a feedback capacitance has all the current."""


def fitted_resistance(reader: Multisine, Z: Complex, frequency: Real) -> float:
    """Feedback resistance whose output peaks at FILLED of the ADC's range, ohm, three digits.

    Z: reading of the unpressed skin, ohm, shape (interface, frequency). frequency: Hz.
    """
    for _ in range(STEPS):
        peak = float(output_peak(reader, Z, frequency).max())
        R = reader.feedback_resistance * FILLED * reader.full_scale / peak
        R = min(max(R, 1.0), MAX_RESISTANCE)
        reader = reader.model_copy(update={"feedback_resistance": R})
    return float(f"{reader.feedback_resistance:.3g}")


def describe_multisine(parts: SceneParts, reader: Multisine) -> str:
    """Time of a sweep, peaks and noise of a reader in words."""
    frequency, Z = parts.setup.frequency, Solver(parts).solve(Press()).Z
    peak = float(output_peak(reader, Z, frequency).max()) / reader.full_scale
    read = (
        f"{len(frequency)} tones in {reader.frames} frame{'s' * (reader.frames > 1)} of "
        f"{prefixed(reader.frame, 's')}, at multiples of {prefixed(reader.grid, 'Hz')}; crest "
        f"factor {crest_factor(reader, frequency):.3g}; unpressed, the amplifier's output peaks at "
        f"{100 * peak:.3g} % of the converter's range; feedback_resistance = "
        f"{fitted_resistance(reader, Z, frequency):g} fills {100 * FILLED:g} % of it"
    )
    if peak > 1:
        return f"{read}: too high now, lower readout.multisine.feedback_resistance"
    noise = multisine_deviation(reader, Z, frequency)
    low, high = np.min(noise), np.max(noise)
    return f"{read}, and noise is from {100 * low:.2g} to {100 * high:.2g} % of |Z|"
