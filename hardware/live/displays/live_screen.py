"""Live localization on a terminal: grid, answer in words, times and notes."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, Self

from ...meter.meter_reading import MeterReading
from ..live_session import BASELINE_KEY, END_KEY, TimedAnswer
from ..touch_answer import reading_count
from .pixel_grid import fitted_grid

if TYPE_CHECKING:
    from rich.console import Console, RenderableType
    from rich.text import Text

    from ..live_localizer import LiveLocalizer

NOTES = 3
MAX_WIDTH = 80
OTHER_LINES = 14
"""Lines of the screen outside the grid."""


class LiveScreen:
    """Picture that each reading updates while the block runs; it is removed at the end."""

    lasting = False

    def __init__(self, console: Console, localizer: LiveLocalizer) -> None:
        from rich.live import Live

        self._localizer, self._console = localizer, console
        self._readings = reading_count(localizer.model)
        self._moment: TimedAnswer | None = None
        self._why, self._done, self._frequency = "connecting", 0, 0.0
        self._notes = deque[str](maxlen=NOTES)
        self._live = Live(
            console=console, transient=True, refresh_per_second=8, get_renderable=self.picture
        )

    def __enter__(self) -> Self:
        self._live.start(refresh=True)
        return self

    def __exit__(self, *_: object) -> None:
        self._live.stop()

    def reading(self, frequency: float, reading: MeterReading) -> None:
        """Show the progress of the sweep."""
        self._done = self._done % self._readings + 1
        self._frequency = frequency

    def answer(self, moment: TimedAnswer) -> None:
        """Show the answer."""
        self._moment, self._why, self._done = moment, "", 0
        self._live.refresh()

    def no_answer(self, why: str) -> None:
        """Show the reason in place of the answer."""
        self._why, self._done = why, 0
        self._live.refresh()

    def note(self, text: str) -> None:
        """Show the note among the latest ones."""
        self._notes.append(text)

    def picture(self) -> RenderableType:
        """Current picture."""
        from rich.console import Group
        from rich.panel import Panel
        from rich.text import Text

        localizer, skin = self._localizer, self._localizer.scene.skin
        width = min(self._console.width, MAX_WIDTH)
        room = width - 4, self._console.height - OTHER_LINES
        grid = fitted_grid(
            *localizer.scene.pixels.shape, (1e3 * skin.length, 1e3 * skin.width), room
        )
        current = None if self._why or not self._moment else self._moment.answer
        parts = [grid.draw(current), self._words(), *self._time_lines(), self._beside()]
        title = Text(f"rcskin live: {localizer.model.target}")
        return Panel(Group(*parts), title=title, width=width)

    def _words(self) -> Text:
        from rich.text import Text

        if self._why or not self._moment:
            return Text(f"\n{self._why}\n", "bold yellow")
        return Text(f"\n{self._moment.answer.words}\n", "bold")

    def _time_lines(self) -> list[Text]:
        from rich.text import Text

        moment = self._moment
        if moment is None:
            return []
        touch = "" if moment.since_before is None else f"-{_ms(moment.since_before)}"
        rate = "" if moment.rate is None else f"   {moment.rate:.2g} answers/s"
        return [
            Text(
                f"sweep {_ms(moment.measuring)} ms + answer {_ms(moment.localizing)} ms   "
                f"touch to answer {_ms(moment.latency)}{touch} ms{rate}"
            ),
            Text(f"sweeps lost: {moment.failed}"),
            *(Text(remark, "yellow") for remark in moment.remarks),
        ]

    def _beside(self) -> Text:
        from rich.text import Text

        keys = f"{END_KEY}: end" + (
            f" {BASELINE_KEY}: measure the unpressed skin again"
            if self._localizer.uses_baseline
            else ""
        )
        sweep = f"sweep: {self._done} of {self._readings} readings"
        now = f", {self._frequency / 1e3:.4g} kHz" if self._done else ""
        return Text("\n".join([*self._notes, f"{sweep}{now}", keys]), "dim")


def _ms(seconds: float) -> str:
    return f"{1e3 * seconds:.0f}"
