"""A press: where the skin is touched, pixels or places of any size, and how strongly each."""

from __future__ import annotations

import math
import re
from dataclasses import astuple, dataclass
from typing import NamedTuple

from simulator.sweeps import UNPRESSED, InputError

SYNTAX = (
    "ROW,COLUMN[:FACTOR], rect(X,Y,WIDTH,HEIGHT)[:FACTOR] or disc(X,Y,RADIUS)[:FACTOR], "
    "touches joined by '+', or 'none'"
)
JOINT = re.compile(r"(?<!\de)\+", re.IGNORECASE)
TOUCH = re.compile(
    r"\s*(?:(?P<row>\d+)\s*,\s*(?P<column>\d+)|(?P<shape>rect|disc)\s*\((?P<place>[^()]*)\))"
    r"\s*(?::\s*(?P<factor>.+?)\s*)?"
)


class Box(NamedTuple):
    """A rectangle between two lines each way, m."""

    left: float
    right: float
    bottom: float
    top: float


@dataclass(frozen=True, order=True)
class Touch:
    """One pressed pixel, counted from 1, and its capacitance over that at rest."""

    row: int
    column: int
    factor: float

    def __str__(self) -> str:
        return f"{self.row},{self.column}:{self.factor!r}"


@dataclass(frozen=True, order=True)
class Rectangle:
    """A rectangle of the skin around (x, y), width along x, all in m, and its factor."""

    x: float
    y: float
    width: float
    height: float
    factor: float

    @property
    def box(self) -> Box:
        """What it covers."""
        x, y, half_width, half_height = self.x, self.y, self.width / 2, self.height / 2
        return Box(x - half_width, x + half_width, y - half_height, y + half_height)

    def __str__(self) -> str:
        return f"rect({self.x!r},{self.y!r},{self.width!r},{self.height!r}):{self.factor!r}"


@dataclass(frozen=True, order=True)
class Disc:
    """A disc of the skin around (x, y), all in m, and its factor."""

    x: float
    y: float
    radius: float
    factor: float

    @property
    def box(self) -> Box:
        """The rectangle around it."""
        x, y, radius = self.x, self.y, self.radius
        return Box(x - radius, x + radius, y - radius, y + radius)

    def __str__(self) -> str:
        return f"disc({self.x!r},{self.y!r},{self.radius!r}):{self.factor!r}"


AnyTouch = Touch | Rectangle | Disc
SHAPES = {"rect": (Rectangle, ("WIDTH", "HEIGHT")), "disc": (Disc, ("RADIUS",))}
ORDER = (Touch, Rectangle, Disc)


@dataclass(frozen=True)
class Press:
    """Several touches at once; none at all is the skin at rest.

    Pixels are pressed once each; other touches may lie over them and over each other, and factors
    multiply where they do.
    """

    touches: tuple[AnyTouch, ...] = ()

    def __str__(self) -> str:
        return "+".join(map(str, self.touches)) or UNPRESSED

    @property
    def pixel(self) -> tuple[int, int]:
        """(row, column) of a single touch, (0, 0) at rest, (-1, -1) where it is no single pixel."""
        if not self.touches:
            return 0, 0
        first, *others = self.touches
        if others or not isinstance(first, Touch):
            return -1, -1
        return first.row, first.column


def parse_press(text: str, default_factor: float) -> Press:
    """The press written as `text` in SYNTAX; `0,0` and `none` are the skin at rest.

    Touches are put in order: pixels, rectangles, discs. Raises InputError on other syntax, a factor
    or a size that is not finite and > 0, or a pixel named twice.
    """
    if text.strip() in (UNPRESSED, "0,0"):
        return Press()
    touches = [_parse_touch(part, text, default_factor) for part in JOINT.split(text)]
    pixels = [(touch.row, touch.column) for touch in touches if isinstance(touch, Touch)]
    if len(set(pixels)) < len(pixels):
        raise InputError(f"press {text!r}: a pixel is named twice")
    return Press(tuple(sorted(touches, key=lambda t: (ORDER.index(type(t)), astuple(t)))))


def _parse_touch(part: str, text: str, default_factor: float) -> AnyTouch:
    match = TOUCH.fullmatch(part)
    if match is None:
        raise InputError(f"press {text!r}: must be {SYNTAX}")
    given = match["factor"]
    factor = default_factor if given is None else _positive(given, "FACTOR", text)
    if match["shape"] is None:
        return Touch(int(match["row"]), int(match["column"]), factor)
    shape, sizes = SHAPES[match["shape"]]
    x, y, *rest = match["place"].split(",") if match["place"].count(",") else ("", "")
    if len(rest) != len(sizes):
        raise InputError(f"press {text!r}: must be {SYNTAX}")
    place = [_number(value, name, text) for name, value in zip("XY", (x, y), strict=True)]
    extent = [_positive(value, name, text) for name, value in zip(sizes, rest, strict=True)]
    return shape(*place, *extent, factor)


def _positive(given: str, name: str, text: str) -> float:
    value = _float(given)
    if not (math.isfinite(value) and value > 0):
        raise InputError(f"press {text!r}: {name} must be finite and > 0, got {given.strip()}")
    return value


def _number(given: str, name: str, text: str) -> float:
    value = _float(given)
    if not math.isfinite(value):
        raise InputError(f"press {text!r}: {name} must be a finite number, got {given.strip()}")
    return value


def _float(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return math.nan
