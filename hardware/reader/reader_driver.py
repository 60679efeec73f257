"""Driver of a reader: a source of whole sweeps, none older than the request."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import Any

import numpy as np

from ...simulator.arrays import Complex, Real
from ...simulator.sweeps import InputError
from ...simulator.sweeps.reading_quantities import MAGNITUDE, ReadingKind
from ..event_counter import Report
from ..meter.errors import GarbledError, LostConnectionError, MeterError, NoAnswerError
from ..meter.meter_reading import VIRTUAL_SERIAL, MeterIdentity, MeterReading, SettingValue
from ..meter.termination import raise_pending_signal
from .line_format import LineFormat
from .line_port import ReceivedLine, open_line_port
from .sweep_assembly import SweepAssembly

VIRTUAL_READER = "# rcskin virtual reader"
"""First line of the virtual reader, which marks its sweeps as simulated."""
TRIES = 4
"""Sweeps that may be discarded, in time, before a sweep fails."""
SLOW_FACTOR = 3
"""Factor on the time of a sweep of a device that is slower than described, but has no fault."""
START_INTERVAL = 1.0
"""Seconds between two start commands: a device may answer one as if it had restarted."""
Sweep = Mapping[str, Complex]


class ReaderTerminals:
    """The interfaces of a reader, as a switch: the selected one is that of the next readings."""

    def __init__(self, interfaces: Sequence[str]) -> None:
        self.selected: str | None = interfaces[0]

    def select(self, name: str) -> None:
        """Choose the interface of the next readings."""
        self.selected = name

    def check_stayed(self) -> None:
        """Do nothing: each line names its terminal."""

    def close(self) -> None:
        """Do nothing: there is no switch."""


class ReaderDriver:
    """A device that sends lines, connected and started. It is a `ReadingSource`."""

    sweeps = True
    reported: Sequence[str] = ()

    def __init__(
        self,
        resource: str,
        line_format: LineFormat,
        frequencies: Mapping[str, Sequence[float]],
        terminals: ReaderTerminals | None = None,
        timeout: float = 5.0,
        follows: bool = False,
        report: Report = lambda kind, text: None,
        kind: ReadingKind | None = None,
    ) -> None:
        """resource: `serial:PORT` or `tcp:HOST:PORT`. frequencies: Hz, by interface.

        terminals: selects the interface. timeout: longest silence beyond the time of a line, s.
        follows: True if a sweep may begin where the one before ended, as in a live session;
        otherwise it begins after the request. report: takes the faults of lines. kind: of the
        readings that are used; None: as sent. Raises InputError if the name is no resource or an
        interface is missing, MeterError.
        """
        if not 0 < timeout <= 3600:
            raise InputError(f"`timeout` must be in (0, 3600] s, got {timeout:g}")
        self._format, self._timeout = line_format, timeout
        self._terminals = terminals or ReaderTerminals(list(frequencies))
        self._report, self._follows, self._kind = report, follows, kind or line_format.kind
        self._frequencies = ordered_frequencies(line_format, frequencies)
        self._port = open_line_port(resource, line_format.baud, timeout)
        self._notes: Counter[str] = Counter()
        self._examples: dict[str, str] = {}
        self._ended, self._virtual = 0.0, False
        self._waiting: dict[str, Complex] = {}
        self._assembly, self._started = self._new_assembly(), 0.0
        try:
            self._start()
        except BaseException:
            with suppress(MeterError):
                self.restore_original()
            self.close()
            raise

    @property
    def model(self) -> str:
        """Name of the reader, from its file."""
        return self._format.name

    @property
    def identity(self) -> MeterIdentity:
        """Name and quantity, from the file; the virtual reader has the virtual serial number."""
        serial = VIRTUAL_SERIAL if self._virtual else ""
        text = ",".join(filter(None, ["line reader", self._format.name, serial]))
        return MeterIdentity(text, self._format.name, serial, "")

    @property
    def resource(self) -> str:
        """Name of the resource."""
        return self._port.resource

    @property
    def band(self) -> tuple[float, float]:
        """All frequencies: the reader chooses them."""
        return 0.0, np.inf

    def nearest(self, frequency: float) -> float:
        """The frequency itself: it must be among those that the reader sends."""
        return frequency

    @property
    def busy_seconds(self) -> float:
        """Always 0: nothing is restored after a sweep."""
        return 0.0

    def _start(self) -> None:
        """Wait for the device to start, send its start command, and wait for its first line.

        Raises NoAnswerError if no line comes, LostConnectionError.
        """
        time.sleep(self._format.boot)
        self._start_again()
        line = self._next_line(time.perf_counter() + self._line_seconds)
        self._virtual = line.text == VIRTUAL_READER

    def read_at(self, frequency: float) -> MeterReading:
        """Raises MeterError: a reader of lines chooses its readings itself."""
        raise MeterError(
            f"{self.resource}: the reader sends whole sweeps and takes no request for "
            f"{frequency:g} Hz; measure without --adaptive"
        )

    def read_sweep(self, frequencies: Sequence[float]) -> list[MeterReading]:
        """Readings at the selected interface, of one sweep for all interfaces in turn.

        Raises NoAnswerError, GarbledError if no whole sweep came in time, LostConnectionError.
        """
        name = self._terminals.selected
        assert name is not None
        if name not in self._waiting:
            self._waiting = dict(self._next_sweep())
        Z = self._waiting.pop(name)
        values = (np.abs(Z) + 0j if self._kind is MAGNITUDE else Z).tolist()
        return [MeterReading(value, kind=self._kind) for value in values]

    def snapshot(self) -> dict[str, SettingValue]:
        """The description of the lines, as text by key."""
        given = self._format.model_dump(exclude_defaults=True)
        return {name: str(value) for name, value in given.items()}

    def apply_settings(self, settings: Mapping[str, Any]) -> None:
        """Raises InputError if a setting differs from the file's."""
        known = self.snapshot()
        for name in sorted(settings.keys() | (known.keys() if settings else set())):
            if settings.get(name) != known.get(name):
                raise InputError(
                    f"`{name}` of the reader's file is {known.get(name, 'absent')} and was "
                    f"{settings.get(name, 'absent')} when the recording began; take the same file, "
                    "or another output"
                )

    def restore_original(self) -> None:
        """Send the stop command."""
        self._send(self._format.stop)

    def close(self) -> None:
        """Close the port. Closing twice does no harm."""
        self._port.close()

    @property
    def _line_seconds(self) -> float:
        """Longest time from one line to the next, s."""
        return self._timeout + 2 / self._format.rate

    @property
    def _sweep_seconds(self) -> float:
        """Time of one sweep, by the described rate, s."""
        sizes = [own.size for own in self._frequencies.values()]
        lines = sum(sizes) if self._format.terminal else max(sizes)
        if self._format.lines == "sweeps":
            lines = len(self._format.interface) if self._format.terminal else 1
        return lines / self._format.rate

    def _next_sweep(self) -> Sweep:
        begun, before = time.perf_counter(), -np.inf
        if self._follows and begun - self._ended < self._sweep_seconds:
            begun = before = -np.inf
        else:
            self._assembly = self._new_assembly()
        self._notes.clear()
        span, since = self._line_seconds + TRIES * self._sweep_seconds, time.perf_counter()
        while time.perf_counter() < since + span * (1 if self._notes else SLOW_FACTOR):
            try:
                line = self._next_line(time.perf_counter() + self._line_seconds)
            except (NoAnswerError, LostConnectionError):
                last = self._assembly.end()
                if last is None:
                    raise
                return last
            measured_since, before = before, line.since
            if measured_since < begun:
                self._assembly.take_banner(line.text)
                continue
            sweep = self._assembly.feed(line.text)
            if sweep is not None:
                self._ended = line.ended
                return sweep
        raise GarbledError(
            f"{self.resource}: no whole sweep within {TRIES} sweeps of the described rate "
            f"({self._faults()}); check the reader's file against a few lines of the device, the "
            "baud rate, and that the frequencies are those of the scene"
        )

    def _new_assembly(self) -> SweepAssembly:
        return SweepAssembly(self._format, self._frequencies, self._note, self._start_again)

    def _faults(self) -> str:
        if not self._notes:
            return "no fault, but too few lines; check `rate`"
        kinds = self._notes.most_common()
        counted = ", ".join(f"{number} {kind}" for kind, number in kinds)
        return f"{counted}; for example: {self._examples[kinds[0][0]]}"

    def _next_line(self, deadline: float) -> ReceivedLine:
        raise_pending_signal()
        line = self._port.next_line(deadline)
        if line is None:
            faults = f" ({self._faults()})" if self._notes else ""
            raise NoAnswerError(
                f"{self.resource}: the reader sends no line{faults}; check its power, the cable, "
                "the baud rate, and whether it needs a `start` command or a longer `boot`"
            )
        return line

    def _note(self, kind: str, text: str) -> None:
        self._notes[kind] += 1
        self._examples[kind] = text
        self._report(kind, f"{self.resource}: {text}")

    def _start_again(self) -> None:
        """Send the start command, unless it was sent a moment ago."""
        if time.perf_counter() - self._started > START_INTERVAL:
            self._started = time.perf_counter()
            self._send(self._format.start)

    def _send(self, command: str) -> None:
        if command:
            self._port.write(command)


def ordered_frequencies(
    line_format: LineFormat, frequencies: Mapping[str, Sequence[float]]
) -> dict[str, Real]:
    """Frequencies in Hz by interface, in the order of the reader's file.

    Raises InputError if the reader lacks an interface.
    """
    described = [each.name for each in line_format.interface]
    wanted = {name: np.asarray(own, dtype=float) for name, own in frequencies.items()}
    if not described and len(wanted) == 1:
        return wanted
    missing = sorted(wanted.keys() - set(described))
    if missing:
        known = ", ".join(described) or "one without a name"
        raise InputError(
            f"the reader's file lacks the interface {', '.join(missing)}; its `[[interface]]` "
            f"tables name {known}"
        )
    return {name: wanted[name] for name in described if name in wanted}
