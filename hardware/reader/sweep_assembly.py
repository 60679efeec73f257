"""Assembly of whole sweeps from the lines of a reader.

A sweep is given only if every line between its first and its last was read, was in its place, and
no restart of the device was seen. Otherwise it is discarded, and the next one is assembled.

A device that restarts within the last number of a sweep sends a line end before its boot text, so
that the number looks complete. So a sweep waits until the next line follows in order, unless its
lines have a checksum.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from ...simulator.arrays import Complex, Real
from ...simulator.sweeps.same_skin import same_frequencies
from ..event_counter import Report
from .line_format import SHOWN, LineContent, LineError, LineFormat, LineReading, parse_line

Place = tuple[str, float]
"""Interface and frequency in Hz, as the reader sends it."""
Readings = dict[tuple[str, int], complex]
"""Readings by interface and index of the frequency, in the order in which they came."""
RESTARTS, TOO_LONG, REPEATED = "restarts of the device", "lines that are too long", "repeated lines"
LOST, INCOMPLETE, OTHER = "gaps in the count", "incomplete sweeps", "readings at other frequencies"
TWICE, LOST_SWEEPS = "readings that came twice", "lost sweeps"
INTERLEAVED, UNCONFIRMED = "interleaved sweeps", "sweeps whose last line no other followed"
SHOWN_FREQUENCIES = 3


@dataclass
class SweepAssembly:
    """Assembles sweeps at these frequencies in Hz by interface, in the order of the format.

    note: takes the faults. on_banner: called when the device sent the banner of its start.
    """

    line_format: LineFormat
    frequencies: Mapping[str, Real]
    note: Report
    on_banner: Callable[[], None] = lambda: None
    _readings: Readings | None = field(default=None, init=False)
    _unconfirmed: Readings | None = field(default=None, init=False)
    _latest: LineContent | None = field(default=None, init=False)
    _text: str = field(default="", init=False)
    _unread: int = field(default=0, init=False)
    _known: dict[Place, int] = field(default_factory=dict, init=False)

    def feed(self, text: str | None) -> dict[str, Complex] | None:
        """Take a line, None if it was too long. Returns the sweep that it confirms, or None."""
        if text is None:
            self._unread += 1
            self._discard(TOO_LONG, "a line never ended")
            return None
        if self.take_banner(text) or self._is_comment(text):
            return None
        try:
            content = parse_line(text, self.line_format)
        except LineError as fault:
            self._unread += 1
            self._discard(fault.kind, str(fault))
            return None
        return self._take(content, text)

    def take_banner(self, text: str | None) -> bool:
        """Take a line if it is the banner of a restart. True if it was."""
        banner = self.line_format.banner
        if not banner or text is None or banner not in text:
            return False
        self._restarted(f"it sent {text[:SHOWN]!r}")
        self._latest = None
        self.on_banner()
        return True

    def end(self) -> dict[str, Complex] | None:
        """Take the end of the stream. Returns the sweep that no line follows, if it is whole.

        The brace that closes a line of JSON shows that its last number is. A line of CSV has no
        such sign.
        """
        if self._unconfirmed is not None and self.line_format.format == "csv":
            self._discard(UNCONFIRMED, "no line followed the last one of a sweep")
        last, self._unconfirmed = self._unconfirmed, None
        return self._sweep(last)

    def _take(self, content: LineContent, text: str) -> dict[str, Complex] | None:
        before, self._latest = self._latest, content
        repeated, self._text = text == self._text, text
        if before is not None:
            if self._is_repeated(before, content, repeated):
                return None
            self._check_order(before, content)
            if self._unconfirmed is not None and not self._follows(before, content):
                self._discard(INCOMPLETE, "no line with the next sweep's first reading followed")
        self._unread = 0
        if self._begins(before, content):
            self._readings = {}
        completed = self._completed(content)
        if self.line_format.checksum:
            return self._sweep(completed)
        confirmed, self._unconfirmed = self._unconfirmed, completed
        return self._sweep(confirmed)

    def _completed(self, content: LineContent) -> Readings | None:
        """Add the readings of a line. Returns the readings of the sweep that they complete."""
        if self._readings is None or not all(map(self._add, content.readings)):
            return None
        if len(self._readings) < sum(own.size for own in self.frequencies.values()):
            return None
        readings, self._readings = self._readings, None
        return readings

    def _sweep(self, readings: Readings | None) -> dict[str, Complex] | None:
        if readings is None:
            return None
        return {
            name: np.array([readings[name, k] for k in range(own.size)])
            for name, own in self.frequencies.items()
        }

    def _is_comment(self, text: str) -> bool:
        return bool(self.line_format.comment) and text.startswith(self.line_format.comment)

    def _is_repeated(self, before: LineContent, content: LineContent, same_text: bool) -> bool:
        """True if a line came twice, by its count or, within a sweep, by its text."""
        if content.count is not None:
            if content.count != before.count:
                return False
            if not same_text:
                self._discard(TWICE, f"two lines have the count {content.count}")
                return True
        elif not same_text or self._contains_first(content):
            return False
        elif self._readings is None and self._unconfirmed is None:
            return False
        self.note(REPEATED, "a line came twice and was used once")
        return True

    def _check_order(self, before: LineContent, content: LineContent) -> None:
        """Discard the present sweep if counters show lost lines or a restart."""
        limit = self.line_format.count_limit
        if content.time is not None and before.time is not None and content.time < before.time:
            self._restarted(f"its time went back from {before.time:g} to {content.time:g}")
        elif content.count is not None and before.count is not None:
            step = content.count - before.count
            step = step % limit if limit else step
            went = f"from {before.count} to {content.count}"
            if step < 0:
                self._restarted(f"its count went back {went}")
            elif step > 1 + self._unread:
                self._discard(LOST, f"the count jumped {went}")
        if content.sweep is not None and before.sweep is not None:
            went = f"from {before.sweep} to {content.sweep}"
            if content.sweep == before.sweep - 1:
                self._discard(INTERLEAVED, f"the number of the sweep went back {went}")
            elif content.sweep < before.sweep:
                self._restarted(f"the number of its sweep went back {went}")
            elif content.sweep > before.sweep + 1:
                lost = self.note if content.count is not None else self._discard
                lost(LOST_SWEEPS, f"the number of the sweep jumped {went}")

    def _follows(self, before: LineContent, content: LineContent) -> bool:
        """True if a line may be the next one after a whole sweep.

        A count shows that. Without it, the line must begin a sweep at the place where that one
        began, or hold nothing of the scene: two lines that ran into one have one successor less.
        """
        places = [place for place in map(self._place, content.readings) if place]
        if content.count is not None or not places:
            return True
        if content.sweep is not None and content.sweep == before.sweep:
            return False
        assert self._unconfirmed is not None
        return next(iter(self._unconfirmed)) in places

    def _begins(self, before: LineContent | None, content: LineContent) -> bool:
        """True if the line is the first of a sweep; a sweep begun before is then incomplete."""
        if content.sweep is not None:
            begins = before is not None and content.sweep != before.sweep
        else:
            begins = self._contains_first(content)
        if begins and self._readings is not None:
            self._discard(INCOMPLETE, f"a sweep lacks {self._missing()}")
        return begins

    def _contains_first(self, content: LineContent) -> bool:
        """True if a line has the reading with which the reader's sweeps begin."""
        interface = next(iter(self.frequencies))
        own = self.frequencies[interface]
        first = int(own.argmax() if self.line_format.begins == "highest" else own.argmin())
        return (interface, first) in map(self._place, content.readings)

    def _name(self, reading: LineReading) -> str:
        return reading.interface or next(iter(self.frequencies))

    def _place(self, reading: LineReading) -> tuple[str, int] | None:
        """Interface and index of the frequency of a reading; None if the scene lacks it."""
        name = self._name(reading)
        index = self._index(name, reading.frequency) if name in self.frequencies else None
        return None if index is None else (name, index)

    def _add(self, reading: LineReading) -> bool:
        """Add a reading; False if the sweep was discarded."""
        name = self._name(reading)
        if name not in self.frequencies:
            return True
        index = self._index(name, reading.frequency)
        if index is None:
            count = self.frequencies[name].size
            self._discard(OTHER, f"{reading.frequency:.6g} Hz is none of the {count} of the scene")
            return False
        assert self._readings is not None
        if (name, index) in self._readings:
            self._discard(TWICE, f"{reading.frequency:.6g} Hz came twice in a sweep")
            return False
        self._readings[name, index] = reading.value
        return True

    def _index(self, name: str, frequency: float) -> int | None:
        """Index of a frequency in Hz at an interface, or None."""
        if (name, frequency) not in self._known:
            own = self.frequencies[name]
            found = np.flatnonzero(same_frequencies(np.full(own.shape, frequency), own))
            if not found.size:
                return None
            self._known[name, frequency] = int(found[0])
        return self._known[name, frequency]

    def _missing(self) -> str:
        assert self._readings is not None
        lacking = [
            f"{own[k]:.6g} Hz at {name}" if len(self.frequencies) > 1 else f"{own[k]:.6g} Hz"
            for name, own in self.frequencies.items()
            for k in range(own.size)
            if (name, k) not in self._readings
        ]
        more = len(lacking) - SHOWN_FREQUENCIES
        shown = ", ".join(lacking[:SHOWN_FREQUENCIES])
        return f"{shown} and {more} more" if more > 0 else shown

    def _restarted(self, why: str) -> None:
        self._discard(RESTARTS, f"the device restarted: {why}")

    def _discard(self, kind: str, why: str) -> None:
        lost = self._readings is not None or self._unconfirmed is not None
        self._readings = self._unconfirmed = None
        self.note(kind, f"{why}; the sweep was discarded and is read again" if lost else why)
