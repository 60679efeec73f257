"""How far a converging sequence still is from its limit."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

ROUNDING = 1e-12
FASTEST_RATE, SLOWEST_RATE = 0.03, 0.9
SAFETY = 2.0


def remaining_error(
    coarser: NDArray[np.float64], coarse: NDArray[np.float64], fine: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Estimated error of the finest of three results of increasing resolution, shape of each.

    Differences d that shrink by a rate r leave d r / (1 - r) to come, and no less than SAFETY d is
    claimed: orders converge fast until a weak singularity takes over, and then slowly. The rate is
    that of the largest relative differences, and holds everywhere: a difference that happens to
    vanish at one frequency is no accuracy there. Nor is one that vanishes at all of them: every
    second order adds nothing to a field that is even in its element, so no rate below FASTEST_RATE
    is believed.
    """
    scale = np.abs(fine) + np.finfo(float).tiny
    last, before = np.abs(fine - coarse), np.abs(coarse - coarser)
    rate = float((last / scale).max() / max((before / scale).max(), ROUNDING))
    rate = max(rate, FASTEST_RATE)
    to_come = max(SAFETY, rate / (1 - rate)) if rate < SLOWEST_RATE else 1 / (1 - SLOWEST_RATE)
    return to_come * np.maximum(last, min(rate, 1.0) * before) + ROUNDING * np.abs(fine)
