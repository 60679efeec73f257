"""Between skin and meter: what the leads add to the impedance of the skin."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from simulator.table import Table
from simulator.validation import Number, at_least_zero


class Leads(Table):
    """Stray capacitance [F] in parallel with the skin; resistance [ohm] and inductance [H] in
    series with both. Each is the same at every interface.

    guard: part of the stray capacitance that a guard, driven along, keeps from the meter.
    """

    resistance: Annotated[Number, at_least_zero("ohm")] = 0.0
    inductance: Annotated[Number, at_least_zero("H")] = 0.0
    stray_capacitance: Annotated[Number, at_least_zero("F")] = 0.0
    guard: Annotated[Number, Field(ge=0, le=1)] = 0.0

    @property
    def unguarded(self) -> float:
        """The stray capacitance that the meter sees, F."""
        return (1 - self.guard) * self.stray_capacitance

    @property
    def ideal(self) -> bool:
        """Whether the meter sees the skin as it is."""
        return not (self.resistance or self.inductance or self.unguarded)

    def seen_through(
        self, Z: NDArray[np.complex128], frequency: NDArray[np.float64]
    ) -> NDArray[np.complex128]:
        """Z in ohm at the meter's end: R + j omega L + 1/(1/Z + j omega C); frequency [Hz] last."""
        omega = 2j * np.pi * frequency
        series = self.resistance + omega * self.inductance
        return series + Z / (1 + omega * self.unguarded * Z)
