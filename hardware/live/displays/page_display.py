"""A live session on a page: latest sweep, answer and notes as one state."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from ...meter.meter_reading import MeterReading
from ...record.measured_sweep import MeasuredSweep
from ..live_session import TimedAnswer
from ..touch_answer import TouchAnswer, reading_count

if TYPE_CHECKING:
    from ....localization.model.localizer_model import Model

NOTES = 5
UPDATE_INTERVAL = 0.25
"""Seconds between two updates of a sweep's progress."""


@dataclass
class PageDisplay:
    """Posts the state of a session, as numbers and text, at each change."""

    lasting = False
    model: Model
    post: Callable[[Mapping[str, Any]], None]
    _state: dict[str, Any] = field(init=False)
    _notes: deque[str] = field(default_factory=lambda: deque(maxlen=NOTES), init=False)
    _done: int = field(default=0, init=False)
    _posted: float = field(default=0.0, init=False)

    def __post_init__(self) -> None:
        self._state = {
            "kind": "live",
            "target": self.model.target,
            "why": "connecting",
            "answer": None,
            "measured": None,
            "times": None,
            "remarks": [],
        }
        self._post_state()

    def reading(self, frequency: float, reading: MeterReading) -> None:
        """Post the progress of the sweep, at intervals."""
        self._done += 1
        if time.monotonic() - self._posted > UPDATE_INTERVAL:
            self._post_state(frequency)

    def answer(self, moment: TimedAnswer) -> None:
        """Post the answer and its sweep."""
        self._done = 0
        self._state |= {
            "why": "",
            "answer": _answer_state(moment.answer),
            "measured": {"at": moment.at, **_measured_state(moment, self.model)},
            "times": {
                "measuring": moment.measuring,
                "localizing": moment.localizing,
                "latency": moment.latency,
                "rate": moment.rate,
                "failed": moment.failed,
            },
            "remarks": list(moment.remarks),
        }
        self._post_state()

    def no_answer(self, why: str) -> None:
        """Post the reason in place of the answer; the sweep stays until the next sound one."""
        self._done = 0
        self._state |= {"why": why, "answer": None, "remarks": []}
        self._post_state()

    def note(self, text: str) -> None:
        """Post the note among the latest ones."""
        self._notes.append(text)
        self._post_state()

    def _post_state(self, frequency: float | None = None) -> None:
        self._posted = time.monotonic()
        whole = reading_count(self.model)
        progress = {"done": self._done, "of": whole, "frequency": frequency}
        self.post({**self._state, "notes": list(self._notes), "progress": progress})


def _answer_state(answer: TouchAnswer) -> dict[str, Any]:
    return {
        "label": answer.label,
        "words": answer.words,
        "pixels": None if answer.pixels is None else np.clip(answer.pixels, 0, 1).tolist(),
        "shared": answer.shared,
        "position": answer.position,
        "deviation": answer.deviation,
    }


def _measured_state(moment: TimedAnswer, model: Model) -> dict[str, Any]:
    """Z and its mean of the unpressed skin, ohm, by interface and frequency; None if not read."""
    read = {
        trace.interface: dict(zip(trace.frequency, trace.Z.tolist(), strict=True))
        for trace in moment.sweep.traces
    }
    rows = [
        [_pair(of[f]) if f in of else None for f in model.frequencies]
        for of in (read.get(name, {}) for name in model.interfaces)
    ]
    rest = _mean(moment.baseline) if moment.baseline else None
    return {"Z": rows, "rest": rest, "rests": len(moment.baseline)}


def _mean(sweeps: Sequence[MeasuredSweep]) -> list[list[tuple[float, float]]]:
    mean = np.mean([[trace.Z for trace in sweep.traces] for sweep in sweeps], axis=0)
    return [[_pair(z) for z in row] for row in mean.tolist()]


def _pair(z: complex) -> tuple[float, float]:
    return z.real, z.imag
