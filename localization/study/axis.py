"""Axes of a study: a key of the scene and its values, as written on the command line."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...simulator.sweeps import InputError
from ...simulator.sweeps.units import quantity
from .scene_keys import ALL_PIXELS, BOTH_SHEETS, Key, find_key

SYNTAX = (
    "KEY=START:STOP:POINTS[:log|linear] for real numbers, KEY=START:STOP for whole ones, or "
    "KEY=VALUE,VALUE,..."
)
READY_MADE = (f"{BOTH_SHEETS}=1e3:1e6:13:log", f"{ALL_PIXELS}=2:10")
MAX_VALUES, MAX_POINTS = 1000, 10_000


@dataclass(frozen=True)
class Axis:
    """A key with its values, ascending, SI. logarithmic: True if spaced evenly by ratio."""

    key: Key
    values: tuple[float, ...]
    logarithmic: bool = False

    @property
    def linear(self) -> bool:
        """True if its values are spaced evenly by difference."""
        return bool(np.allclose(np.diff(self.values, 2), 0, atol=1e-9 * abs(self.values[-1])))


def axes_of(
    vary: str | Sequence[str] | Mapping[str, Iterable[float]], table: Mapping[str, Any]
) -> list[Axis]:
    """One or two axes of a scene's table, written in SYNTAX or as values by key.

    Raises InputError as `parse_axes`.
    """
    if not isinstance(vary, Mapping):
        return parse_axes([vary] if isinstance(vary, str) else vary, table)
    listed = {name: np.atleast_1d(np.asarray(values)).tolist() for name, values in vary.items()}
    axes = parse_axes([f"{k}={','.join(map(repr, each))}" for k, each in listed.items()], table)
    return [replace(axis, logarithmic=_is_geometric(axis.values)) for axis in axes]


def _is_geometric(values: Sequence[float]) -> bool:
    """True if there are three values or more, in geometric progression."""
    if len(values) < 3 or values[0] <= 0:
        return False
    return bool(np.allclose(np.diff(np.log(values), 2), 0, atol=1e-9))


def parse_axes(texts: Sequence[str], table: Mapping[str, Any]) -> list[Axis]:
    """One or two axes of a scene's table, each written in SYNTAX; raises InputError."""
    if not 1 <= len(texts) <= 2:
        raise InputError(f"--vary must be given once or twice, got {len(texts)} times")
    axes = [parse_axis(text, table) for text in texts]
    for place in axes[0].key.places:
        if any(place in other.key.places for other in axes[1:]):
            raise InputError(f"--vary: {texts[0]} and {texts[1]} set the same number of the scene")
    points = math.prod(len(axis.values) for axis in axes)
    if points > MAX_POINTS:
        raise InputError(f"--vary must make at most {MAX_POINTS} points, got {points}")
    return axes


def parse_axis(text: str, table: Mapping[str, Any]) -> Axis:
    """The axis written in SYNTAX; raises InputError that names the key and what is allowed."""
    name, equals, written = (part.strip() for part in text.partition("="))
    if not (name and equals and written):
        raise InputError(f"--vary {text!r}: must be {SYNTAX}")
    key = find_key(name, table)
    parts = written.split(":")
    if len(parts) == 1:
        return Axis(key, _distinct(text, [_number(text, key, part) for part in written.split(",")]))
    first, last = (_number(text, key, part) for part in parts[:2])
    if not first < last:
        raise InputError(f"--vary {text!r}: START must be < STOP, got {first:g} and {last:g}")
    return _whole_range(text, key, parts) if key.whole else _real_range(text, key, parts)


def _whole_range(text: str, key: Key, parts: Sequence[str]) -> Axis:
    if len(parts) != 2:
        raise InputError(f"--vary {text!r}: {key.name} is a whole number: {key.name}=START:STOP")
    first, last = (int(_number(text, key, part)) for part in parts)
    if last - first >= MAX_VALUES:
        raise InputError(f"--vary {text!r}: at most {MAX_VALUES} values, got {last - first + 1}")
    return Axis(key, tuple(range(first, last + 1)))


def _real_range(text: str, key: Key, parts: Sequence[str]) -> Axis:
    spacing = parts[3].strip() if len(parts) == 4 else "log"
    if len(parts) not in (3, 4) or spacing not in ("log", "linear"):
        raise InputError(
            f"--vary {text!r}: {key.name} is a real number: {key.name}=START:STOP:POINTS[:log|"
            "linear]"
        )
    first, last = (_number(text, key, part) for part in parts[:2])
    if not (parts[2].strip().isdecimal() and 2 <= int(parts[2]) <= MAX_VALUES):
        raise InputError(
            f"--vary {text!r}: POINTS must be from 2 to {MAX_VALUES}, got {parts[2]!r}"
        )
    if spacing == "log" and first <= 0:
        raise InputError(f"--vary {text!r}: START must be > 0 for log spacing, got {first:g}")
    space = np.geomspace if spacing == "log" else np.linspace
    return Axis(key, tuple(space(first, last, int(parts[2])).tolist()), spacing == "log")


def _number(text: str, key: Key, written: str) -> float:
    try:
        value = int(written) if key.whole else quantity(written, None)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        allowed = "whole numbers" if key.whole else "finite numbers"
        raise InputError(f"--vary {text!r}: {key.name} takes {allowed}, got {written.strip()!r}")
    return value


def _distinct(text: str, values: list[float]) -> tuple[float, ...]:
    if len(set(values)) < len(values):
        raise InputError(f"--vary {text!r}: a value is given twice")
    return tuple(sorted(values))
