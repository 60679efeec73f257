"""Displays of a live session: a pipe, several at once, the terminal and a page."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TextIO

import numpy as np

from ....simulator.safe_text import escaped, say, terminal
from ...meter.meter_reading import MeterReading
from ..live_session import SessionDisplay, TimedAnswer

if TYPE_CHECKING:
    from ..live_localizer import LiveLocalizer


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
    from ...event_counter import counted_events
    from ...page.page_document import PageDocument
    from ...page.page_server import serve_in_thread
    from ...record.recording_output import measured_mask
    from ..touch_answer import frequencies_of
    from .page_display import PageDisplay

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
