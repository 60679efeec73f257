"""Displays of a live session: a pipe, a page, several at once, the terminal."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TextIO

import numpy as np

from ...simulator.safe_text import escaped, say, terminal
from ..meter.meter_reading import MeterReading
from ..record.measured_sweep import MeasuredSweep
from .live_session import SessionDisplay, TimedAnswer
from .touch_answer import TouchAnswer, reading_count

if TYPE_CHECKING:
    from ...localization.model.localizer_model import Model
    from .live_localizer import LiveLocalizer

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


@dataclass
class CombinedDisplay:
    """Several displays of one session."""

    displays: Sequence[SessionDisplay]

    @property
    def lasting(self) -> bool:
        """True if the first display, the terminal's, stays after the session."""
        return self.displays[0].lasting

    def reading(self, frequency: float, reading: MeterReading) -> None:
        """Show a reading at a frequency in Hz."""
        for show in self.displays:
            show.reading(frequency, reading)

    def answer(self, moment: TimedAnswer) -> None:
        """Show an answer."""
        for show in self.displays:
            show.answer(moment)

    def no_answer(self, why: str) -> None:
        """Show why there is no answer."""
        for show in self.displays:
            show.no_answer(why)

    def note(self, text: str) -> None:
        """Show a note."""
        for show in self.displays:
            show.note(text)


@contextmanager
def other_displays(
    localizer: LiveLocalizer, port: int | None
) -> Iterator[Sequence[SessionDisplay]]:
    """Displays besides the terminal. port: of a page; None: no page."""
    with ExitStack() as stack:
        displays: list[SessionDisplay] = []
        if port is not None:
            displays.append(stack.enter_context(_serve_page(localizer, port)))
        yield displays


@contextmanager
def _serve_page(localizer: LiveLocalizer, port: int) -> Iterator[SessionDisplay]:
    """Serve a page of the localizer's skin. Raises InputError if the scene has none."""
    from ..event_counter import counted_events
    from ..page.page_document import PageDocument
    from ..page.page_server import serve_in_thread
    from ..record.recording_journal import measured_mask
    from .touch_answer import frequencies_of

    model = localizer.model
    taken = measured_mask(frequencies_of(model).values(), model.frequencies)
    parts = localizer.parts
    setup = parts.setup.of(model.interfaces).taking(np.array(model.frequencies), taken)
    document = PageDocument.of(parts.read(setup), "live")
    shown = counted_events(lambda text: say(f"rcskin: page: {text}", err=True))
    with shown, serve_in_thread(document, port) as (address, post):
        say(f"rcskin: page {address.url}", err=True)
        yield PageDisplay(model, post)


@contextmanager
def session_display(
    localizer: LiveLocalizer, plain: bool, others: Sequence[SessionDisplay]
) -> Iterator[tuple[SessionDisplay, Callable[[], str]]]:
    """Display of a session on the terminal and in others, and a function for the pressed key."""
    import sys

    from .live_screen import LiveScreen, key_reader

    console = terminal()
    if plain or not console.is_terminal:
        yield CombinedDisplay((LineOutput(sys.stdout, sys.stderr), *others)), lambda: ""
        return
    with key_reader() as key, LiveScreen(console, localizer) as screen:
        yield CombinedDisplay((screen, *others)), key
