"""Under what conditions a reading is taken, and how long it takes."""

from __future__ import annotations

from dataclasses import dataclass

PERIODS = {"FAST": 1, "MEDIUM": 2, "SLOW": 4, "SLOW2": 20}
LEAST = {"FAST": 2e-3, "MEDIUM": 5e-3, "SLOW": 50e-3, "SLOW2": 200e-3}


@dataclass(frozen=True)
class Conditions:
    """frequency: Hz. range: 1 to 10. level: open voltage at the terminals in V. cable: m."""

    frequency: float
    range: int
    speed: str = "MEDIUM"
    averaging: int = 1
    level: float = 1.0
    cable: int = 0

    @property
    def seconds(self) -> float:
        """Time of a measurement: some periods of the signal, but never less than LEAST.

        Both tables are assumptions of the virtual meter: plausible, not the IM3523's own.
        """
        once = max(PERIODS[self.speed] / self.frequency, LEAST[self.speed])
        return once * self.averaging
