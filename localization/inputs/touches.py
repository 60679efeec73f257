"""Where a sweep's press lies and how strong it is: from a data set's own numbers, or its text."""

from __future__ import annotations

import math
import re
import tomllib
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...simulator.sweeps import UNPRESSED, InputError

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

MOST = 2
"""Touches that a localizer tells apart."""
NUMBERS = ("touches", "touch_x", "touch_y", "touch_factor")
"""Variables of data sets."""
JOINT = re.compile(r"(?<!\de)\+", re.IGNORECASE)
TOUCH = re.compile(
    r"\s*(?:(?P<row>\d+)\s*,\s*(?P<column>\d+)|(?:rect|disc)\s*\((?P<place>[^()]*)\))"
    r"\s*(?::\s*(?P<factor>\S+)\s*)?"
)
"""As texts of presses name a touch; a place begins with X,Y in m."""


@dataclass(frozen=True, eq=False)
class Touches:
    """How many touches each sweep has, shape (sweep,), and their centres and strengths.

    x, y [m], factor [capacitance over that at rest]: shape (sweep, MOST); 0, 0 and 1 where there is
    none.
    """

    count: NDArray[np.int64]
    x: NDArray[np.float64]
    y: NDArray[np.float64]
    factor: NDArray[np.float64]


class Plan(NamedTuple):
    """What places a scene's pixels: sides in m, numbers; and the factor where none is told."""

    length: float
    width: float
    rows: int
    columns: int
    factor: float


def touches_of(sweeps: xr.Dataset) -> Touches:
    """The touches of each sweep.

    Raises InputError naming a sweep whose press is of another syntax or of more than MOST touches,
    and where a pixel is to be placed on a scene that the sweeps do not carry.
    """
    if all(name in sweeps for name in NUMBERS):
        count, x, y, factor = (sweeps[name].values for name in NUMBERS)
        return Touches(count.astype(int), *(a.astype(np.float64) for a in (x, y, factor)))
    texts, index = np.unique(sweeps["press"].values.astype(str), return_inverse=True)
    plan = plan_of(sweeps)
    told = [_touches(str(text), plan) for text in texts]
    numbers = np.zeros((3, len(texts), MOST)) + np.array([0, 0, 1.0]).reshape(3, 1, 1)
    for k, touches in enumerate(told):
        for t, touch in enumerate(touches):
            numbers[:, k, t] = touch
    return Touches(np.array([len(each) for each in told])[index], *numbers[:, index])


def pressed_pixels(text: str) -> list[tuple[int, int]] | None:
    """(row, column) of each touch, ascending; none at rest; None where a touch is no pixel.

    Raises InputError on another syntax.
    """
    found = [(match["row"], match["column"]) for match in _matches(text)]
    if any(row is None for row, _ in found):
        return None
    return sorted((int(row), int(column)) for row, column in found)


def plan_of(sweeps: xr.Dataset) -> Plan | None:
    """Of the scene that the sweeps carry; None where they carry none of that much."""
    try:
        table = tomllib.loads(str(sweeps.attrs.get("scene", "")))
        skin, pixels = table["skin"], table["pixels"]
        return Plan(
            float(skin["length"]),
            float(skin["width"]),
            int(pixels["rows"]),
            int(pixels["columns"]),
            float(table.get("press", {}).get("capacitance_factor", math.nan)),
        )
    except (tomllib.TOMLDecodeError, KeyError, TypeError, ValueError):
        return None


def _matches(text: str) -> list[re.Match[str]]:
    if text.strip() in (UNPRESSED, "0,0"):
        return []
    found = [TOUCH.fullmatch(part) for part in JOINT.split(text)]
    matches = [match for match in found if match is not None]
    if len(matches) < len(found) or len(found) > MOST:
        raise InputError(f"press {text!r}: must be at most {MOST} touches, joined by '+'")
    return matches


def _touches(text: str, plan: Plan | None) -> list[tuple[float, float, float]]:
    """x and y in m and factor of each touch."""
    return [(*_centre(match, text, plan), _factor(match, text, plan)) for match in _matches(text)]


def _centre(match: re.Match[str], text: str, plan: Plan | None) -> tuple[float, float]:
    if match["row"] is None:
        x, y, *_ = [_number(part, text) for part in (match["place"] + ",").split(",")[:2]]
        return x, y
    if plan is None:
        raise InputError(f"press {text!r}: its pixels have no place, the sweeps carry no scene")
    row, column = int(match["row"]), int(match["column"])
    return (column - 0.5) * plan.length / plan.columns, (row - 0.5) * plan.width / plan.rows


def _factor(match: re.Match[str], text: str, plan: Plan | None) -> float:
    if match["factor"] is None and plan is not None:
        return plan.factor
    return _number(match["factor"] or "", text)


def _number(given: str, text: str) -> float:
    try:
        value = float(given)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"press {text!r}: places and factors must be finite numbers")
    return value
