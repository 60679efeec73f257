"""Live localization on a terminal: grid of pixels, answer in words, times, notes, and keys."""

from __future__ import annotations

import math
import os
import select
import sys
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from ...simulator.cleanup import cleanup_after
from ..meter.meter_reading import MeterReading
from .live_session import BASELINE_KEY, END_KEY, TimedAnswer
from .touch_answer import TouchAnswer, reading_count

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from rich.console import Console, RenderableType
    from rich.text import Text

    from .live_localizer import LiveLocalizer

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

        localizer, skin = self._localizer, self._localizer.parts.skin
        width = min(self._console.width, MAX_WIDTH)
        room = width - 4, self._console.height - OTHER_LINES
        grid = fitted_grid(*skin.pixels.shape, (1e3 * skin.length, 1e3 * skin.width), room)
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


CIVIDIS = ((0, 34, 78), (53, 69, 108), (102, 105, 112), (148, 142, 119), (200, 184, 102))
RAMP = (*CIVIDIS, (254, 232, 56))
"""Colours of J. R. Nunez et al., PLoS ONE 13 (2018) e0199239; readable with colour blindness."""
MARKER = "+"
MIN_NUMBERED_WIDTH = 4
"""Smallest width of a pixel, in characters, that has room for its number."""


@dataclass(frozen=True)
class PixelGrid:
    """Pixels of a skin, drawn with row 1 at the bottom. size: of the skin, mm.

    pixel_width, pixel_height: characters of each pixel.
    """

    rows: int
    columns: int
    size: tuple[float, float]
    pixel_width: int = 9
    pixel_height: int = 3

    def draw(self, answer: TouchAnswer | None) -> Text:
        """Grid that shows an answer; None draws it dark."""
        from rich.text import Text

        text = Text(no_wrap=True)
        for row in range(self.rows, 0, -1):
            for line in range(self.pixel_height):
                middle = line == self.pixel_height // 2
                text.append(f"{row:>3} " if middle else "    ")
                self._draw_line(text, row, line, answer)
                text.append("\n")
        room = self.pixel_width - 1
        numbers = (str(n)[-room:] for n in range(1, self.columns + 1))
        text.append("    " + "".join(f"{n:^{room}} " for n in numbers))
        return text

    def _draw_line(self, text: Text, row: int, line: int, answer: TouchAnswer | None) -> None:
        if answer is not None and answer.pixels is not None:
            numbered = self._numbered_columns(row, answer.shared)
            self._draw_pixels(text, answer.pixels[row - 1], line, numbered)
        elif answer is not None and answer.position is not None:
            down = (self.rows - row) * self.pixel_height + line
            self._draw_position(text, down, answer.position, answer.region)
        else:
            text.append(" " * (self.pixel_width * self.columns), _style(0))

    def _numbered_columns(self, row: int, shared: str) -> range:
        """Columns of a row, from 0, that show their probability as a number.

        All columns do. If a whole column or row shares one probability, only its middle pixel does.
        """
        if shared == "column" and row != (self.rows + 1) // 2:
            return range(0)
        middle = (self.columns - 1) // 2
        return range(middle, middle + 1) if shared == "row" else range(self.columns)

    def _draw_pixels(self, text: Text, probabilities: NDArray, line: int, numbered: range) -> None:
        """One line of a row of pixels, with a gap of half a line below the row."""
        room = line == self.pixel_height // 2 and self.pixel_width >= MIN_NUMBERED_WIDTH
        last = line > 0 and line == self.pixel_height - 1
        for column, p in enumerate(probabilities.tolist()):
            shown = f"{100 * p:.0f}" if room and column in numbered else ""
            if last:
                text.append("▀" * (self.pixel_width - 1), _hex(p))
            else:
                text.append(f"{shown:^{self.pixel_width - 1}}", _style(p))
            text.append(" ")

    def _draw_position(
        self,
        text: Text,
        down: int,
        position: tuple[float, float],
        region: Callable[[NDArray, NDArray], NDArray] | None,
    ) -> None:
        """One line with the marker of the position and its region, brighter for likelier places."""
        wide, high = self.pixel_width * self.columns, self.pixel_height * self.rows
        at_x, at_y = (
            _cell_index(position[0] / self.size[0], wide),
            _cell_index(1 - position[1] / self.size[1], high),
        )
        x = (np.arange(wide) + 0.5) / wide * self.size[0]
        y = np.full(wide, (1 - (down + 0.5) / high) * self.size[1])
        likely = np.zeros(wide) if region is None else region(x, y)
        for across, level in enumerate(likely.tolist()):
            marked = (across, down) == (at_x, at_y)
            text.append(MARKER if marked else " ", _style(1.0 if marked else level))


def fitted_grid(
    rows: int, columns: int, size: tuple[float, float], room: tuple[int, int]
) -> PixelGrid:
    """Grid with the largest pixels that fit. room: characters across and down."""
    wide = max(2, min(9, (room[0] - 4) // columns))
    high = 3 if 3 * rows < room[1] else 1
    return PixelGrid(rows, columns, size, wide, high)


def _cell_index(fraction: float, count: int) -> int:
    return min(max(math.floor(fraction * count), 0), count - 1)


def _style(level: float) -> str:
    """Foreground and background of a level from 0 to 1."""
    red, green, blue = _colour(level)
    dark = 0.299 * red + 0.587 * green + 0.114 * blue < 110
    return f"{'#ffffff' if dark else '#000000'} on {_hex(level)}"


def _hex(level: float) -> str:
    return "#{:02x}{:02x}{:02x}".format(*_colour(level))


def _colour(level: float) -> tuple[int, int, int]:
    at = min(max(level, 0.0), 1.0) * (len(RAMP) - 1)
    number = min(int(at), len(RAMP) - 2)
    share = at - number
    red, green, blue = (
        round((1 - share) * low + share * high)
        for low, high in zip(RAMP[number], RAMP[number + 1], strict=True)
    )
    return red, green, blue


PREFIXES = ("\0", "\xe0")
"""First character of arrow and function keys, as `msvcrt.getwch` gives them."""


@contextmanager
def key_reader() -> Iterator[Callable[[], str]]:
    """Gives a function that returns the last key since its last call, or an empty string.

    The end of the block restores the terminal. Without a terminal the function always returns "".
    """
    if not sys.stdin.isatty():
        yield lambda: ""
        return
    if sys.platform == "win32" or find_spec("termios") is None:
        yield partial(_last_console_key, import_module("msvcrt"))
        return
    import termios
    import tty

    terminal = sys.stdin.fileno()
    before = termios.tcgetattr(terminal)

    def restore() -> None:
        with suppress(termios.error):  # the terminal is gone
            termios.tcsetattr(terminal, termios.TCSADRAIN, before)

    with cleanup_after(restore):
        tty.setcbreak(terminal)
        yield lambda: _last_key(terminal)


def _last_console_key(msvcrt: Any) -> str:
    """Last key on Windows, where a key without a letter is a prefix and a code."""
    last = ""
    while msvcrt.kbhit():
        last = msvcrt.getwch()
        if last in PREFIXES:
            msvcrt.getwch()
    return "" if last in PREFIXES else last.lower()


def _last_key(terminal: int) -> str:
    if not select.select([terminal], [], [], 0)[0]:
        return ""
    with suppress(OSError):  # the terminal is gone
        return os.read(terminal, 1024).decode(errors="replace")[-1:].lower()
    return ""
