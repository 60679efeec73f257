"""Durations of a meter's reading and of a switch's settling.

The values are assumptions that are plausible for LCR meters, not specifications of one.
"""

from __future__ import annotations

PERIODS = {"FAST": 1, "MEDIUM": 2, "SLOW": 4, "SLOW2": 20}
MIN_SECONDS = {"FAST": 2e-3, "MEDIUM": 5e-3, "SLOW": 50e-3, "SLOW2": 200e-3}
"""Shortest duration of a reading by speed, s."""
SETTLE = 0.02
"""Seconds from the end of switching to the first reading."""


def reading_time(frequency: float, speed: str = "MEDIUM") -> float:
    """Duration of a reading in s: some periods of the signal, at least MIN_SECONDS."""
    return max(PERIODS[speed] / frequency, MIN_SECONDS[speed])
