"""One measured sweep: readings at ascending frequencies, under one press."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.sweeps import InputError
from ..meter.errors import GarbledError
from ..meter.hioki import Meter
from ..meter.reading import BY_CODE, Reading

if TYPE_CHECKING:
    from numpy.typing import NDArray

ROUNDING = 6e-5
Watch = Callable[[float, Reading], None]


@dataclass(frozen=True)
class Sweep:
    """Readings [F, ohm, ohm] and their status codes, one for each frequency."""

    Cp: tuple[float, ...]
    Rs: tuple[float, ...]
    X: tuple[float, ...]
    status: tuple[int, ...]

    @property
    def Z(self) -> NDArray[np.complex128]:
        """Rs + jX in ohm, shape (frequency,)."""
        return np.array(self.Rs) + 1j * np.array(self.X)


def flagged(sweeps: Sequence[Sweep]) -> list[tuple[int, int, int]]:
    """Readings that were not normal: number of the sweep, of the frequency, and status code."""
    return [
        (number, index, code)
        for number, sweep in enumerate(sweeps)
        for index, code in enumerate(sweep.status)
        if code
    ]


def flags(sweeps: Sequence[Sweep]) -> list[str]:
    """In words, how many readings of them the meter flagged, and as what."""
    codes = [code for _, _, code in flagged(sweeps)]
    return [
        f"{codes.count(code)} reading{'s' if codes.count(code) > 1 else ''}: "
        f"{BY_CODE[code].meaning}"
        for code in sorted(set(codes))
    ]


def measure_sweep(
    meter: Meter, frequencies: Iterable[float], watch: Watch = lambda frequency, reading: None
) -> Sweep:
    """A reading at each frequency in Hz in any order, none of them older than this call.

    The meter rounds a frequency to five digits; where it tells one that differs by more, nothing is
    taken for a reading. watch: called with each as it comes, before the next frequency is taken.
    Raises InputError where the meter cannot take a frequency, MeterError where a reading fails.
    """
    readings = [_at(meter, float(frequency), watch) for frequency in frequencies]
    return Sweep(
        tuple(reading.Cp for reading in readings),
        tuple(reading.Rs for reading in readings),
        tuple(reading.X for reading in readings),
        tuple(reading.status.code for reading in readings),
    )


def check_frequencies(meter: Meter, frequencies: Sequence[float]) -> None:
    """Raises InputError where the meter's model does not reach one of the frequencies in Hz."""
    allowed = type(meter).frequency.allowed
    for frequency in frequencies:
        if allowed.write(frequency) is None:
            raise InputError(f"an {meter.model} measures {allowed}, the scene asks {frequency:g}")


def _at(meter: Meter, frequency: float, watch: Watch) -> Reading:
    meter.frequency = frequency
    reading = meter.read()
    told = meter.frequency
    if abs(told / frequency - 1) > ROUNDING:
        raise GarbledError(
            f"{meter.talk.resource}: the meter is at {told:g} Hz instead of {frequency:g} Hz; "
            "check that nothing else sets it"
        )
    watch(frequency, reading)
    return reading
