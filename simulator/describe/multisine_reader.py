"""Facts about the multisine reader of a scene, with the unpressed skin."""

from __future__ import annotations

import numpy as np

from ..models.solver import Solver
from ..press.press import Press
from ..scene.multisine.excitation import crest_factor, output_peak
from ..scene.multisine.noise import multisine_deviation
from ..scene.multisine.reader import Multisine
from ..scene.scene import Scene
from ..sweeps.units import prefixed


def describe_multisine(scene: Scene, reader: Multisine) -> str:
    """Time of a sweep, peaks and noise of a reader in words."""
    frequency, Z = scene.frequencies, Solver(scene).solve(Press()).Z
    peak = float(output_peak(reader, Z, frequency).max()) / reader.full_scale
    read = (
        f"{len(frequency)} tones in {reader.frames} frame{'s' * (reader.frames > 1)} of "
        f"{prefixed(reader.frame, 's')}, at multiples of {prefixed(reader.grid, 'Hz')}; crest "
        f"factor {crest_factor(reader, frequency):.3g}; unpressed, the amplifier's output peaks at "
        f"{100 * peak:.3g} % of the converter's range"
    )
    if peak > 1:
        return f"{read}: too high, lower readout.multisine.feedback_resistance"
    noise = multisine_deviation(reader, Z, frequency)
    low, high = np.min(noise), np.max(noise)
    return f"{read}, and noise is from {100 * low:.2g} to {100 * high:.2g} % of |Z|"
