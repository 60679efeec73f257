"""How long a meter takes for a reading, and a switch until one can begin.

Assumptions: plausible for meters of this kind, not the specification of one.
"""

from __future__ import annotations

PERIODS = {"FAST": 1, "MEDIUM": 2, "SLOW": 4, "SLOW2": 20}
MIN_SECONDS = {"FAST": 2e-3, "MEDIUM": 5e-3, "SLOW": 50e-3, "SLOW2": 200e-3}
"""s."""
SETTLE = 0.02
"""s from the end of a switch's turn to the first reading."""


def reading_time(frequency: float, speed: str = "MEDIUM") -> float:
    """s of a measurement: some periods of the signal, but never less than LEAST."""
    return max(PERIODS[speed] / frequency, MIN_SECONDS[speed])
