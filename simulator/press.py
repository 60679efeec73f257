"""A press: the touches of the skin at one time, and how they are written."""

from __future__ import annotations

import math
import re
from dataclasses import astuple, dataclass

from simulator.sweeps import UNPRESSED, InputError
from simulator.touch import (
    AnyTouch,
    Box,
    Depth,
    Disc,
    Force,
    Indentation,
    Place,
    Polygon,
    Rectangle,
    Strength,
    Touch,
    place_of,
    touch_at,
)

__all__ = [
    "AnyTouch",
    "Box",
    "Depth",
    "Disc",
    "Force",
    "Indentation",
    "Place",
    "Polygon",
    "Press",
    "Rectangle",
    "Strength",
    "Touch",
    "parse_press",
    "place_of",
    "require_plain",
    "touch_at",
]

SYNTAX = (
    "ROW,COLUMN[:FACTOR], rect(X,Y,WIDTH,HEIGHT)[:FACTOR], disc(X,Y,RADIUS)[:FACTOR] or "
    "poly(X1,Y1,X2,Y2,X3,Y3,...)[:FACTOR], a depth (2mm, 0.002m) or a force (5N) in place of "
    "FACTOR, touches joined by '+', or 'none'"
)
JOINT = re.compile(r"(?<!\de)\+", re.IGNORECASE)
TOUCH = re.compile(
    r"\s*(?:(?P<row>\d+)\s*,\s*(?P<column>\d+)|(?P<shape>rect|disc|poly)\s*\((?P<place>[^()]*)\))"
    r"\s*(?::\s*(?P<strength>.+?)\s*)?"
)
MEASURED = re.compile(r"(?P<number>.*?)\s*(?P<unit>mm|m|N)")
SHAPES = {"rect": (Rectangle, ("WIDTH", "HEIGHT")), "disc": (Disc, ("RADIUS",))}
ORDER = (Touch, Rectangle, Disc, Polygon)


@dataclass(frozen=True)
class Press:
    """Several touches at once; none at all is the skin at rest.

    Pixels are pressed once each; other touches may lie over them and over each other. Factors
    multiply where they do; of applicators the deeper one counts.
    """

    touches: tuple[AnyTouch, ...] = ()

    def __str__(self) -> str:
        return "+".join(map(str, self.touches)) or UNPRESSED

    @property
    def plain(self) -> bool:
        """Whether it is nothing but factors of pixels and rectangles."""
        return all(isinstance(touch, Touch | Rectangle) for touch in self.touches)

    @property
    def sharp(self) -> Press:
        """Its touches of a given factor."""
        return Press(tuple(each for each in self.touches if not isinstance(each, Indentation)))

    @property
    def indented(self) -> tuple[Indentation, ...]:
        """Its touches of a given depth or force."""
        return tuple(each for each in self.touches if isinstance(each, Indentation))

    @property
    def pixel(self) -> tuple[int, int]:
        """(row, column) of a single touch, (0, 0) at rest, (-1, -1) where it is no single pixel."""
        if not self.touches:
            return 0, 0
        first, *others = self.touches
        place = place_of(first)
        if others or not isinstance(place, Touch):
            return -1, -1
        return place.row, place.column


def require_plain(press: Press) -> None:
    """Raises InputError unless the press is plain."""
    if not press.plain:
        raise InputError(
            f"press {press}: must be capacitance factors of pixels or rect here, "
            "without depth, force, disc or poly"
        )


def parse_press(text: str, default: Strength) -> Press:
    """The press written as `text` in SYNTAX; `0,0` and `none` are the skin at rest.

    `default` is how strongly touches are pressed that do not say so. Touches are put in order:
    those with factors before those with depths and forces, pixels before rectangles, discs and
    polygons. Raises InputError on other syntax, a factor, depth, force or size that is not finite
    and > 0, or a pixel named twice.
    """
    if text.strip() in (UNPRESSED, "0,0"):
        return Press()
    touches = [_parse_touch(part, text, default) for part in JOINT.split(text)]
    places = [place_of(touch) for touch in touches]
    pixels = [(place.row, place.column) for place in places if isinstance(place, Touch)]
    if len(set(pixels)) < len(pixels):
        raise InputError(f"press {text!r}: a pixel is named twice")
    return Press(tuple(sorted(touches, key=order)))


def order(touch: AnyTouch) -> tuple:
    """What the touches of a press are sorted by."""
    place = place_of(touch)
    by = (touch.by.unit, touch.by.value) if isinstance(touch, Indentation) else ()
    return bool(by), ORDER.index(type(place)), astuple(place), by


def _parse_touch(part: str, text: str, default: Strength) -> AnyTouch:
    match = TOUCH.fullmatch(part)
    if match is None:
        raise InputError(f"press {text!r}: must be {SYNTAX}")
    given = match["strength"]
    strength = default if given is None else _strength(given, text)
    return touch_at(_parse_place(match, text), strength)


def _parse_place(match: re.Match[str], text: str) -> Place:
    if match["shape"] is None:
        return Touch(int(match["row"]), int(match["column"]), 1.0)
    given = match["place"].split(",")
    if match["shape"] == "poly":
        return Polygon(_points(given, text), 1.0)
    shape, sizes = SHAPES[match["shape"]]
    if len(given) != 2 + len(sizes):
        raise InputError(f"press {text!r}: must be {SYNTAX}")
    place = [_number(value, name, text) for name, value in zip("XY", given[:2], strict=True)]
    extent = [_positive(value, name, text) for name, value in zip(sizes, given[2:], strict=True)]
    return shape(*place, *extent, 1.0)


def _points(given: list[str], text: str) -> tuple[tuple[float, float], ...]:
    if len(given) < 6 or len(given) % 2:
        raise InputError(f"press {text!r}: poly needs X,Y of at least 3 corners")
    named_values = [(value, f"{'XY'[k % 2]}{k // 2 + 1}") for k, value in enumerate(given)]
    values = [_number(value, name, text) for value, name in named_values]
    return tuple(zip(values[::2], values[1::2], strict=True))


def _strength(given: str, text: str) -> Strength:
    match = MEASURED.fullmatch(given)
    if match is None:
        return _positive(given, "FACTOR", text)
    if match["unit"] == "N":
        return Force(_positive(match["number"], "force in N", text))
    depth = _positive(match["number"], f"depth in {match['unit']}", text)
    return Depth(depth / 1000 if match["unit"] == "mm" else depth)


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
