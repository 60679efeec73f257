"""Compiled display of readings by meters; see `measure.readout.with_errors` and `shown_values`."""

from __future__ import annotations

import cmath
import math

import numpy as np
from numpy.typing import NDArray

from ..compiled import compiled

IMPEDANCE, GAIN, MAGNITUDE = range(3)


@compiled()
def shown_quantities(
    reading: NDArray,
    deviation: NDArray,
    fixed: NDArray,
    noise: NDArray,
    frequency: NDArray,
    digits: int,
    kind: int,
) -> NDArray:  # pragma: no cover
    """Quantities of readings as displayed, shape (quantity, skin, frequency).

    reading: shape (skin, frequency). deviation: of the fixed errors of magnitude and phase, then of
    their noise, shape (4, skin, frequency), or 1 where they are all equal. fixed, noise: standard
    normal numbers, shapes (2, skin) and (2, skin, frequency). frequency: Hz. digits: 0 for no
    rounding. kind: IMPEDANCE for Rs, X, Cp; GAIN for magnitude and phase; MAGNITUDE.
    """
    skins, frequencies = reading.shape
    found = np.empty((3 - kind, skins, frequencies))
    for skin in range(skins):
        own = min(skin, deviation.shape[1] - 1)
        for k in range(frequencies):
            at = min(k, deviation.shape[2] - 1)
            gain = 1 + deviation[0, own, at] * fixed[0, skin]
            gain *= 1 + deviation[2, own, at] * noise[0, skin, k]
            turn = deviation[1, own, at] * fixed[1, skin]
            turn += deviation[3, own, at] * noise[1, skin, k]
            value = reading[skin, k] * gain * complex(math.cos(turn), math.sin(turn))
            if kind == IMPEDANCE:
                found[0, skin, k] = value.real
                found[1, skin, k] = value.imag
                size = abs(value)
                found[2, skin, k] = -(value.imag / size) / size / (2 * math.pi * frequency[k])
            else:
                found[0, skin, k] = abs(value)
                if kind == GAIN:
                    found[1, skin, k] = cmath.phase(value)
            if digits > 0:
                for quantity in range(len(found)):
                    found[quantity, skin, k] = _rounded(found[quantity, skin, k], digits)
    return found


@compiled()
def _rounded(value: float, digits: int) -> float:  # pragma: no cover
    """Value rounded to significant digits."""
    if value == 0.0 or not math.isfinite(value):
        return value
    step = 10.0 ** (math.floor(math.log10(abs(value))) + 1 - digits)
    return np.rint(value / step) * step
