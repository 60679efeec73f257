"""Coloured grid of pixels: the probability of touches, or a position and its region."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..touch_answer import TouchAnswer

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from rich.text import Text

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
