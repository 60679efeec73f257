"""Reference sets of frequencies, and candidates in a band."""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Mask, Real
from ..models.line import interrogation_frequency
from ..scene.frequency import parse_band
from ..scene.parts import Setup, Skin
from ..sweeps import InputError
from ..sweeps.errors import named
from ..sweeps.units import quantity

EQUATION_6, LOGARITHMIC, OPTIMAL = "Eq. 6", "log spacing", "optimal"
DISTINCT = 1.1
"""Smallest ratio of two chosen frequencies. The penetration depth falls with the root of the
frequency; below this ratio it differs by less than 5 %, and the second reading repeats the first.
`repeats` allows that."""
DIGITS = 6
"""Significant digits of a meter's frequencies."""


def equation_6(skin: Skin, setup: Setup, n: int) -> Real:
    """f_i = 0.0382 / (R C x_i²) in Hz, ascending; x_i = i l / n from the driven edge, i = 1 .. n.

    R C per squared length is the resistance of both sheets times the capacitance per area. Source:
    paper Eq 6.
    """
    sheets = skin.both_sheets
    edge = skin.contact(setup.interfaces[0].high[0]).edge
    length = skin.length if edge in ("left", "right") else skin.width
    ends = length * np.arange(n, 0, -1) / n
    return rounded(interrogation_frequency(ends, sheets, skin.foam.unpressed_capacitance_per_area))


def logarithmic(band: tuple[float, float], n: int) -> Real:
    """n frequencies in Hz with logarithmic spacing over a band; the middle of it for n = 1."""
    low, high = band
    return rounded(np.geomspace(low, high, n) if n > 1 else np.array([math.sqrt(low * high)]))


def within(frequencies: Real, band: tuple[float, float]) -> Real:
    """Frequencies clipped to a band."""
    return np.clip(frequencies, *band)


def compared(skin: Skin, setup: Setup, n: int, band: tuple[float, float]) -> dict[str, Real]:
    """n frequencies in Hz by Eq. 6, and n with logarithmic spacing, clipped to a band."""
    found = {EQUATION_6: equation_6(skin, setup, n), LOGARITHMIC: logarithmic(band, n)}
    return {name: within(frequencies, band) for name, frequencies in found.items()}


def candidates_in(setup: Setup, band: tuple[float, float], grid: int) -> Real:
    """Candidate frequencies in Hz, ascending: a grid over the band, and the scene's own in it."""
    own = setup.frequency[(setup.frequency >= band[0]) & (setup.frequency <= band[1])]
    return np.unique(np.concatenate([own, within(logarithmic(band, grid), band)]))


def candidates_of(skin: Skin, setup: Setup, n: int, band: tuple[float, float], grid: int) -> Real:
    """Candidates of `candidates_in` and the frequencies of `compared`, ascending."""
    others = compared(skin, setup, n, band).values()
    return np.unique(np.concatenate([candidates_in(setup, band, grid), *others]))


def own_band(setup: Setup) -> tuple[float, float]:
    """Lowest and highest frequency of a scene, Hz."""
    return float(setup.frequency[0]), float(setup.frequency[-1])


def chosen_band(text: str | None, setup: Setup) -> tuple[float, float]:
    """The band of a text LOW:HIGH in Hz, with the scene's own as default. Raises InputError."""
    low, high = parse_band(text or ":", own_band(setup))
    if not (0 < low and high < math.inf):
        raise InputError(
            f"{named('band')} must be LOW:HIGH in Hz with 0 < LOW < HIGH < inf, got "
            f"{low:g}:{high:g}"
        )
    return low, high


def frequencies_among(text: str | None, setup: Setup) -> Real | None:
    """Frequencies of the option `--among` in Hz, ascending: the scene's, or those of a list.

    Raises InputError for any other text.
    """
    if text is None or text == "scene":
        return None if text is None else setup.frequency
    try:
        found = np.unique([quantity(each, "Hz") for each in text.split(",")])
    except ValueError:
        found = np.zeros(1)
    if not (np.isfinite(found).all() and (found > 0).all()):
        raise InputError(f"--among must be `scene` or F,F,... in Hz, each > 0, got {text!r}")
    return found


def too_near(frequencies: Real, n: int) -> Mask:
    """True for pairs of frequencies in Hz, ascending, with a ratio below DISTINCT.

    The ratio is smaller where n of them need it: each uses at most half of its share of the band.
    """
    logarithm = np.log(frequencies)
    room = float(np.ptp(logarithm)) / (4 * n)
    separation = np.abs(logarithm[:, None] - logarithm)
    return (separation < min(math.log(DISTINCT), room)) | np.eye(len(frequencies), dtype=bool)


def rounded(frequencies: Real) -> Real:
    """Frequencies rounded to the digits of a meter."""
    return np.array([float(f"{f:.{DIGITS}g}") for f in frequencies])
