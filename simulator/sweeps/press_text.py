"""Syntax of presses as text, and the parser that turns it into touches."""

from __future__ import annotations

import math
import re
from decimal import Decimal
from typing import Literal, NamedTuple

from .errors import InputError
from .schema import UNPRESSED
from .units import PREFIXES, plain_number, suggestion

SYNTAX = (
    "ROW,COLUMN, rect(X,Y,WIDTH,HEIGHT), disc(X,Y,RADIUS) or poly(X1,Y1,X2,Y2,X3,Y3,...); behind "
    "it :FACTOR, a depth (:2mm), a force (:5N) or :touch; then :finger, :rod or a capacitance to "
    "earth (:5.3pF); '+' joins touches; 'none' is the unpressed skin"
)

EARTHED: Literal["earthed"] = "earthed"
FREE_TOUCH: Literal["touch"] = "touch"
"""A touch without pressure: by the scene's finger, or an earthed one if it has none."""
WrittenFinger = float | Literal["earthed", "touch"]
"""Touching object: a capacitance to earth in F, or a named finger that has one."""

MIN_FACTOR, MAX_FACTOR = 1e-6, 1e6
"""Limits of the capacitance factor, far beyond what foam can be lifted or pressed to."""
MAX_FORCE = 1e6
"""N: a locomotive's weight."""
MAX_FINGER = 1e-6
"""F: a hand on a thin film has nanofarad."""

JOINT = re.compile(r"(?<!\de)\+", re.IGNORECASE)
TOUCH = re.compile(
    r"\s*(?:(?P<row>\d+)\s*,\s*(?P<column>\d+)|(?P<shape>rect|disc|poly)\s*\((?P<place>[^()]*)\))"
    r"\s*(?::\s*(?P<strength>\S(?:.*?\S)??)\s*)?",
    re.ASCII,
)
PIXEL = re.compile(r"(\d+),(\d+)", re.ASCII)
STRENGTH_WITH_UNIT = re.compile(r"(?P<number>(?:.*?\S)??)\s*(?P<unit>[cmuµ]?m|[mk]?N)")
PER_M = {"m": 1, "cm": 100, "mm": 1000, "um": 1_000_000, "µm": 1_000_000}
PER_N = {"N": 1, "mN": 1000, "kN": 1e-3}
WEIGHT = re.compile(r"(?P<number>[\d.]+)\s*(?P<unit>g|kg|gf|kgf)")
WITH_LETTERS = re.compile(r"[\d.]+\s*[a-zA-Z]+")
UNITS = "; a force is in N, a depth in mm, a factor has no unit"
KILOGRAM = 9.80665
"""Weight of a kilogram, N."""
FARAD = re.compile(r"(?P<number>(?:.*?\S)??)\s*(?P<prefix>[fpnuµm]?)F")
DISPLAYED = {"": (1.0, ""), "m": (1e3, "mm"), "N": (1.0, "N"), "F": (1e12, "pF")}
"""Factor and unit of a strength or finger as it is displayed, by the unit in the text."""
FINGERS: dict[str, WrittenFinger] = {"finger": EARTHED, "rod": 0.0}
LENGTH = re.compile(r"\s*(?P<number>\S(?:.*?\S)??)\s*(?P<unit>mm|cm|m)\s*")
SIZES = {"rect": ("WIDTH", "HEIGHT"), "disc": ("RADIUS",)}

Kind = Literal["pixel", "rect", "disc", "poly"]
Unit = Literal["", "m", "N"]


class WrittenStrength(NamedTuple):
    """A capacitance factor (no unit), a depth in m or a force in N."""

    value: float
    unit: Unit


class WrittenTouch(NamedTuple):
    """One touch as it is written.

    numbers: row and column of a pixel; X, Y and sizes of a rect or disc, X and Y of the corners of
    a poly, in m. strength, finger: None if the text does not state them.
    """

    kind: Kind
    numbers: tuple[float, ...]
    strength: WrittenStrength | None
    finger: WrittenFinger | None = None

    @property
    def pixel(self) -> tuple[int, int]:
        """Row and column of a pixel; -1 and -1 for other shapes."""
        row, column = self.numbers[:2] if self.kind == "pixel" else (-1, -1)
        return int(row), int(column)


def parse_touches(text: str) -> list[WrittenTouch]:
    """Parses a press written in SYNTAX into its touches, in order; no touches for `none`.

    Raises InputError for other syntax, for a factor, depth, force or size that is not finite and
    > 0, for a capacitance that no finger has, and for a pixel named twice.
    """
    if text.strip() == UNPRESSED:
        return []
    touches = [_touch(part, text) for part in JOINT.split(text)]
    pixels = [touch.pixel for touch in touches if touch.kind == "pixel"]
    if len(set(pixels)) < len(pixels):
        raise InputError(f"press {text!r}: a pixel is named twice")
    return touches


def written_pixel(text: str) -> tuple[int, int]:
    """Row and column of a press of one pixel; 0 and 0 if unpressed, -1 and -1 for other presses.

    Raises InputError as `parse_touches`.
    """
    touches = parse_touches(text)
    if not touches:
        return 0, 0
    return touches[0].pixel if len(touches) == 1 else (-1, -1)


def displayed_press(text: str) -> str:
    """A press as titles and messages show it: four digits, depths in mm, capacitances in pF."""
    touches = (part.split(":") for part in JOINT.split(text))
    return "+".join(":".join([place, *map(_displayed, by)]) for place, *by in touches)


def _displayed(by: str) -> str:
    """Strength or finger of a touch, which itself writes in m, N and F."""
    number, unit = re.fullmatch(r"(.*?)([mNF]?)", by, re.DOTALL).groups()  # pyright: ignore[reportOptionalMemberAccess]
    scale, shown = DISPLAYED[unit]
    value = plain_number(number)
    return f"{scale * value:.4g}{shown}" if math.isfinite(value) else by


def named_pixels(label: str) -> list[tuple[int, int]]:
    """Row and column of each pixel in a class label such as "1,2+3,4"; (0, 0) if unpressed."""
    return [(int(row), int(column)) for row, column in PIXEL.findall(label)]


def _touch(part: str, text: str) -> WrittenTouch:
    match = TOUCH.fullmatch(part)
    if match is None:
        raise InputError(f"press {text!r}: must be {SYNTAX}")
    by = _strength_and_finger(match["strength"], text)
    if match["shape"] is None:
        return WrittenTouch("pixel", _pixel(match["row"], match["column"], text), *by)
    numbers = list(map(_in_m, match["place"].split(",")))
    if match["shape"] == "poly":
        return WrittenTouch("poly", _corners(numbers, text), *by)
    kind: Kind = "rect" if match["shape"] == "rect" else "disc"
    return WrittenTouch(kind, _place_and_sizes(numbers, SIZES[kind], text), *by)


def _strength_and_finger(
    given: str | None, text: str
) -> tuple[WrittenStrength | None, WrittenFinger | None]:
    """Parses the part behind a place: strength and finger of a touch."""
    if given is None:
        return None, None
    first, *others = (part.strip() for part in given.split(":"))
    if len(others) > 1:
        raise InputError(f"press {text!r}: must be {SYNTAX}")
    if not others and _names_finger(first):
        return None, _finger(first, text)
    if first == FREE_TOUCH:
        return WrittenStrength(1.0, ""), _finger(others[0], text) if others else FREE_TOUCH
    return _strength(first, text), _finger(others[0], text) if others else None


def _names_finger(given: str) -> bool:
    return given in FINGERS or FARAD.fullmatch(given) is not None


def _finger(given: str, text: str) -> WrittenFinger:
    if given in FINGERS:
        return FINGERS[given]
    match = FARAD.fullmatch(given)
    if match is None:
        raise InputError(
            f"press {text!r}: the touching object must be finger, rod or a capacitance such as "
            f"5.3pF, got {given}"
        )
    _number(match["number"], f"capacitance in {match['prefix']}F", text)
    power = PREFIXES.get(match["prefix"], 0)
    farad = float(Decimal(match["number"].strip()).scaleb(power))
    if not 0 <= farad <= MAX_FINGER:
        raise InputError(
            f"press {text!r}: the capacitance of the touching object must be from 0 to "
            f"{MAX_FINGER:g} F, got {given}"
        )
    return farad


def _pixel(row: str, column: str, text: str) -> tuple[int, int]:
    if 0 in (int(row), int(column)):
        raise InputError(
            f"press {text!r}: rows and columns count from 1; nothing pressed is {UNPRESSED!r}"
        )
    return int(row), int(column)


def _place_and_sizes(given: list[str], sizes: tuple[str, ...], text: str) -> tuple[float, ...]:
    if len(given) != 2 + len(sizes):
        raise InputError(f"press {text!r}: must be {SYNTAX}")
    place = [_number(value, name, text) for name, value in zip("XY", given[:2], strict=True)]
    extent = [_positive(value, name, text) for name, value in zip(sizes, given[2:], strict=True)]
    return (*place, *extent)


def _corners(given: list[str], text: str) -> tuple[float, ...]:
    if len(given) < 6 or len(given) % 2:
        raise InputError(f"press {text!r}: poly needs X,Y of at least 3 corners")
    names = [f"{'XY'[k % 2]}{k // 2 + 1}" for k in range(len(given))]
    return tuple(_number(value, name, text) for value, name in zip(given, names, strict=True))


def _strength(given: str, text: str) -> WrittenStrength:
    match = STRENGTH_WITH_UNIT.fullmatch(given)
    if match is None:
        _refuse_weight(given, text)
        factor = _positive(given, "FACTOR", text)
        _check_maximum(factor, "FACTOR", MAX_FACTOR, given, text)
        if factor < MIN_FACTOR:
            raise InputError(f"press {text!r}: FACTOR must be >= {MIN_FACTOR:g}, got {factor:g}")
        return WrittenStrength(factor, "")
    if match["unit"] in PER_N:
        force = _positive(match["number"], f"force in {match['unit']}", text) / PER_N[match["unit"]]
        _check_maximum(force, "force in N", MAX_FORCE, given, text)
        return WrittenStrength(force, "N")
    depth = _positive(match["number"], f"depth in {match['unit']}", text)
    return WrittenStrength(depth / PER_M[match["unit"]], "m")


def _refuse_weight(given: str, text: str) -> None:
    """Raises InputError with the force in N if a strength is written as a mass."""
    match = WEIGHT.fullmatch(given)
    mass = plain_number(match["number"]) if match else math.nan
    if match is None or not math.isfinite(mass):
        return
    force = KILOGRAM * mass * (1 if match["unit"].startswith("k") else 1e-3)
    raise InputError(f"press {text!r}: a force is in N; did you mean {force:.3g}N?")


def _check_maximum(value: float, name: str, maximum: float, given: str, text: str) -> None:
    if value > maximum:
        raise InputError(f"press {text!r}: {name} must be <= {maximum:g}, got {given.strip()}")


def _positive(given: str, name: str, text: str) -> float:
    value = plain_number(given)
    if not (math.isfinite(value) and value > 0):
        hint = suggestion(given) or (UNITS if WITH_LETTERS.fullmatch(given.strip()) else "")
        raise InputError(
            f"press {text!r}: {name} must be finite and > 0, got {given.strip()}{hint}"
        )
    return value


def _number(given: str, name: str, text: str) -> float:
    value = plain_number(given)
    if not math.isfinite(value):
        raise InputError(f"press {text!r}: {name} must be a finite number, got {given.strip()}")
    return value


def _in_m(text: str) -> str:
    """Converts a length with a unit to a number in m."""
    match = LENGTH.fullmatch(text)
    return text if match is None else repr(plain_number(match["number"]) / PER_M[match["unit"]])
