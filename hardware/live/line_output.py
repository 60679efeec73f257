"""Live localization in a pipe: a line for each answer, and all else on another stream."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TextIO

from ...simulator.safe_text import escaped
from ..meter.meter_reading import MeterReading
from .live_session import TimedAnswer


@dataclass
class LineOutput:
    """Lines `time, answer, probability, latency in ms`, parted by tabs; no control codes.

    answers, notes: where lines go. A note that repeats the one before it is left out,
    and a remark that the answer before had too.
    """

    answers: TextIO
    notes: TextIO
    _told: str = field(default="", init=False)
    _remarks: tuple[str, ...] = field(default=(), init=False)

    def reading(self, frequency: float, reading: MeterReading) -> None:
        """Readings are not shown."""

    def answer(self, moment: TimedAnswer) -> None:
        """Write the answer's line, and what is remarkable about it."""
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
        """Tell why."""
        self.note(why)

    def note(self, text: str) -> None:
        """Tell it, once."""
        if text != self._told:
            self._told = text
            self.notes.write(f"rcskin: {escaped(text)}\n")
            self.notes.flush()
