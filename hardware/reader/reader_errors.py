"""Bounds on the errors of a reader, used where a meter has an accuracy table."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from ...simulator.meters.accuracy_table import ReadingConditions
from .line_format import LineFormat


@dataclass(frozen=True)
class ReaderErrors:
    """Bounds that the file of a reader states: `error` and `phase_error`."""

    line_format: LineFormat

    @property
    def name(self) -> str:
        """Name for the attribute `accuracy` of a recording."""
        return f"as the file of reader {self.line_format.name} states"

    @property
    def known(self) -> bool:
        """True if the file states bounds of an impedance, so that laws can be checked."""
        return self.line_format.quantity == "impedance" and self.line_format.error is not None

    def has_range(self, range_number: int) -> bool:
        """True: a reader has one range."""
        return True

    def error_bounds(self, Z: complex, conditions: ReadingConditions) -> tuple[float, float]:
        """Bounds on the errors of |Z| (a fraction) and of the phase (rad)."""
        given = self.line_format
        return given.error or 0.0, math.radians(given.phase_error or 0.0)

    @staticmethod
    def conditions(
        settings: Mapping[str, Any], frequency: float, Z: complex, table: Any
    ) -> ReadingConditions:
        """Conditions of a reading: only the frequency matters."""
        return ReadingConditions(frequency, 1)
