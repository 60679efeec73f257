"""Common part of Keysight's LCR meters and analysers, and of others with a queue of errors."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import ClassVar

from .errors import GarbledError
from .lcr_meter import SEARCHES, LcrMeter
from .meter_reading import MeterReading, ReadingStatus
from .setting import NO_VALUE, MeterProperty, driver_form

CORRECTION_SECONDS = 120.0
"""Time that the meter may be silent while it acquires a correction, s."""


class KeysightMeter(LcrMeter):
    """A meter with a queue of errors, which may sweep by itself.

    max_points: of a sweep. rounding: largest relative rounding of a frequency. delays: settings
    that `set_up` sets to 0 s, because they make each reading longer. acquire: commands that acquire
    a correction, of the dialect.
    """

    extents = ("ALL", "OFF")
    error_query = ":SYSTem:ERRor?"
    max_points: ClassVar[int] = 1
    rounding: ClassVar[float]
    delays: ClassVar[tuple[str, ...]] = ()
    acquire: ClassVar[Mapping[str, str]]
    open_correction: ClassVar[MeterProperty[str]]
    short_correction: ClassVar[MeterProperty[str]]

    def set_up(self) -> None:
        """End a sweep that may still run, and set the meter up; readings have no delay."""
        self.talk.send(":ABORt")
        super().set_up()
        for name in self.delays:
            setattr(self, name, 0.0)

    def sweep_once(self, frequencies: Sequence[float]) -> list[MeterReading]:
        """Readings of one sweep, at most `max_points` frequencies in Hz."""
        return [self.read_at(frequency) for frequency in frequencies]

    def read_sweep(self, frequencies: Sequence[float]) -> list[MeterReading]:
        """Readings at frequencies in Hz, by sweeps of at most `max_points`."""
        found: list[MeterReading] = []
        for begin in range(0, len(frequencies), self.max_points):
            found += self.sweep_once(frequencies[begin : begin + self.max_points])
        return found

    @contextmanager
    def sweeping(self, frequencies: Sequence[float]) -> Iterator[float]:
        """Block in which a sweep runs. Gives its longest time, s.

        After a signal the meter counts as busy for that time.
        """
        _ = self.seconds  # fills the cache
        each = [self.reading_seconds({**self.cached, "frequency": f}) for f in frequencies]
        self._sweep_seconds = SEARCHES * sum(each)
        yield self._sweep_seconds
        self._sweep_seconds = 0.0

    def check_frequencies(self, frequencies: Sequence[float], reported: Sequence[float]) -> None:
        """Raises GarbledError if the meter measured at other frequencies, Hz."""
        if len(reported) != len(frequencies):
            raise GarbledError(
                f"{self.resource}: the meter swept {len(reported)} frequencies instead of "
                f"{len(frequencies)}; check that nothing else sets it"
            )
        for wanted, found in zip(frequencies, reported, strict=True):
            if not abs(found / wanted - 1) <= self.rounding:
                raise GarbledError(
                    f"{self.resource}: the meter is at {found:g} Hz instead of {wanted:g} Hz; "
                    "check that nothing else sets it, and that the model has this frequency"
                )

    def start_correction(self, kind: str, extent: str) -> None:
        """Start to acquire a correction at all frequencies, or end its use.

        The meter may be silent until it has the correction.
        """
        if extent == "OFF":
            self._use_correction(kind, "OFF")
            return
        self.talk.send("*CLS")
        self._sweep_seconds = CORRECTION_SECONDS
        self.talk.send(driver_form(self.acquire[kind]), CORRECTION_SECONDS)

    def correction_done(self) -> bool:
        """True when the started correction has ended, for which this call waits."""
        return self.talk.query("*OPC?", int, seconds=CORRECTION_SECONDS) == 1

    def correction_fault(self, kind: str) -> str:
        """Fault of the correction that has ended; empty if there is none, and then it is used."""
        self._sweep_seconds = 0.0
        error = self.talk.query(self.error_query, str.strip)
        if not error.lstrip("+").startswith("0"):
            return f"error {error}"
        self._use_correction(kind, "ON")
        return ""

    def cancel_correction(self, kind: str) -> None:
        """Cancel the started correction."""
        self.talk.send(":ABORt")

    def _use_correction(self, kind: str, state: str) -> None:
        self.talk.send(f"{getattr(type(self), f'{kind}_correction').command} {state}")


def reading_of(R: float, X: float, status: ReadingStatus = ReadingStatus.NORMAL) -> MeterReading:
    """Reading of R and X in ohm. Raises ValueError for numbers that are none."""
    if not all(abs(value) < NO_VALUE for value in (R, X)) or R == X == 0:
        raise ValueError(f"{R:g},{X:g}")
    return MeterReading(complex(R, X), status)
