"""Displays of a live session: the terminal or a pipe, and a page."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ....simulator.safe_text import say, terminal
from ...meter.meter_reading import MeterReading
from ..live_session import SessionDisplay, TimedAnswer

if TYPE_CHECKING:
    from ..live_localizer import LiveLocalizer


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
    from ....simulator.scene.readings.changed_readings import (
        restricted_to_interfaces,
        with_frequencies,
    )
    from ...event_counter import counted_events
    from ...page.page_document import PageDocument
    from ...page.page_thread import serve_in_thread
    from ...record.recording_dataset import measured_mask
    from ..touch_answer import frequencies_of
    from .page_display import PageDisplay

    model = localizer.model
    taken = measured_mask(frequencies_of(model).values(), model.frequencies)
    scene = with_frequencies(
        restricted_to_interfaces(localizer.scene, model.interfaces), model.frequencies, taken
    )
    document = PageDocument.of(scene, "live")
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

    from .key_input import key_reader
    from .line_output import LineOutput
    from .live_screen import LiveScreen

    console = terminal()
    if plain or not console.is_terminal:
        yield CombinedDisplay((LineOutput(sys.stdout, sys.stderr), *others)), lambda: ""
        return
    with key_reader() as key, LiveScreen(console, localizer) as screen:
        yield CombinedDisplay((screen, *others)), key
