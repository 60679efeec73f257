"""Live answers in a pipe: one line per answer, and notes on another stream."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TextIO

from ....simulator.safe_text import escaped
from ...meter.meter_reading import MeterReading
from ..live_session import TimedAnswer


@dataclass
class LineOutput:
    """Lines `time, answer, probability, latency in ms`, separated by tabs, without control codes.

    answers, notes: output streams. Repeated notes are left out, and so are remarks that the
    previous answer had.
    """

    answers: TextIO
    notes: TextIO
    _last_note: str = field(default="", init=False)
    _remarks: tuple[str, ...] = field(default=(), init=False)

    @property
    def lasting(self) -> bool:
        """True: lines stay."""
        return True

    def reading(self, frequency: float, reading: MeterReading) -> None:
        """Show nothing."""

    def answer(self, moment: TimedAnswer) -> None:
        """Write the answer's line and its new remarks."""
        probability = moment.answer.probability
        fields = (
            moment.at,
            escaped(moment.answer.label),
            "" if probability is None else f"{probability:.4f}",
            f"{1e3 * moment.latency:.1f}",
        )
        self.answers.write("\t".join(fields) + "\n")
        self.answers.flush()
        for remark in moment.remarks:
            if remark not in self._remarks:
                self.note(remark)
        self._remarks = moment.remarks

    def no_answer(self, why: str) -> None:
        """Write the reason."""
        self.note(why)

    def note(self, text: str) -> None:
        """Write the note unless it repeats the one before."""
        if text != self._last_note:
            self._last_note = text
            self.notes.write(f"rcskin: {escaped(text)}\n")
            self.notes.flush()
