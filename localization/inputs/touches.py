"""Where a sweep's press lies and how strong it is: from a data set's own numbers, or its text."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...simulator.sweeps import InputError, inputs
from ...simulator.sweeps.press_text import WrittenTouch, parse_touches

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

MOST = 2
"""Touches that a localizer tells apart."""
NUMBERS = ("touches", "touch_x", "touch_y", "touch_factor")
"""Variables of data sets."""


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
    return _of_texts(sweeps, None)


def with_factors(sweeps: xr.Dataset) -> xr.Dataset:
    """The sweeps, with touches as numbers where a press says a depth or a force; none of presses of
    more than MOST.

    Raises InputError as `touches_of` and, where neither the press nor the scene says a factor, as
    `factors_under`.
    """
    from ...simulator.measure.under_touches import factors_under

    texts, plan = np.unique(sweeps["press"].values.astype(str)), plan_of(sweeps)
    if all(name in sweeps for name in NUMBERS) or all(_said(str(each), plan) for each in texts):
        return sweeps
    count = counts_of(sweeps)
    told, asked = count <= MOST, partial(factors_under, str(sweeps.attrs.get("scene", "")))
    found = _of_texts(sweeps.isel(sweep=told), asked)
    numbers = np.zeros((3, len(count), MOST))
    numbers[:, told] = found.x, found.y, found.factor
    arrays = {name: (("sweep", "touch"), a) for name, a in zip(NUMBERS[1:], numbers, strict=True)}
    return sweeps.assign({NUMBERS[0]: ("sweep", count), **arrays})


def _of_texts(sweeps: xr.Dataset, factors: Callable[[str], Sequence[float]] | None) -> Touches:
    texts, index = np.unique(sweeps["press"].values.astype(str), return_inverse=True)
    plan = plan_of(sweeps)
    told = [_touches(str(text), plan, factors) for text in texts]
    numbers = np.zeros((3, len(texts), MOST)) + np.array([0, 0, 1.0]).reshape(3, 1, 1)
    for k, touches in enumerate(told):
        for t, touch in enumerate(touches):
            numbers[:, k, t] = touch
    return Touches(np.array([len(each) for each in told])[index], *numbers[:, index])


def counts_of(sweeps: xr.Dataset) -> NDArray[np.int64]:
    """How many touches each sweep has, however many, shape (sweep,); raises as `parse_touches`."""
    if NUMBERS[0] in sweeps:
        return sweeps[NUMBERS[0]].values.astype(int)
    texts, index = np.unique(sweeps["press"].values.astype(str), return_inverse=True)
    return np.array([len(parse_touches(str(text))) for text in texts])[index]


def pressed_pixels(text: str) -> list[tuple[int, int]] | None:
    """(row, column) of each touch, ascending; none at rest; None of more than MOST, or no pixel.

    Raises InputError on another syntax.
    """
    touches = parse_touches(text)
    if len(touches) > MOST or any(touch.kind != "pixel" for touch in touches):
        return None
    return sorted(touch.pixel for touch in touches)


def plan_of(sweeps: xr.Dataset) -> Plan | None:
    """Of the scene that the sweeps carry; None where they carry none of that much."""
    return plan_of_scene(str(sweeps.attrs.get("scene", "")))


def plan_of_scene(text: str) -> Plan | None:
    """Of a scene's TOML text; None where it does not tell that much."""
    try:
        table = inputs.tables(text)
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


def _written(text: str) -> list[WrittenTouch]:
    touches = parse_touches(text)
    if len(touches) > MOST:
        raise InputError(f"press {text!r}: must be at most {MOST} touches, joined by '+'")
    return touches


def _touches(
    text: str, plan: Plan | None, factors: Callable[[str], Sequence[float]] | None
) -> list[tuple[float, float, float]]:
    """x and y in m and factor of each touch."""
    written = _written(text)
    if factors is None or _said(text, plan):
        own = [_factor(each, text, plan) for each in written]
    else:
        own = factors(text)
    centres = [_centre(each, text, plan) for each in written]
    return [(*centre, factor) for centre, factor in zip(centres, own, strict=True)]


def _said(text: str, plan: Plan | None) -> bool:
    """Whether the text or the scene says the factor of each touch."""
    known = plan is not None and math.isfinite(plan.factor)
    return all(
        known if each.strength is None else not each.strength.unit for each in parse_touches(text)
    )


def _centre(touch: WrittenTouch, text: str, plan: Plan | None) -> tuple[float, float]:
    if touch.kind == "poly":
        return _centroid(np.reshape(touch.numbers, (-1, 2)), text)
    if touch.kind != "pixel":
        return touch.numbers[0], touch.numbers[1]
    if plan is None:
        raise InputError(f"press {text!r}: its pixels have no place, the sweeps carry no scene")
    row, column = touch.pixel
    return (column - 0.5) * plan.length / plan.columns, (row - 0.5) * plan.width / plan.rows


def _centroid(corners: NDArray[np.float64], text: str) -> tuple[float, float]:
    """Of the area of a polygon, m."""
    x, y = (corners - corners[0]).T
    twice = x * np.roll(y, -1) - np.roll(x, -1) * y
    if not abs(twice.sum()) > 0:
        raise InputError(f"press {text!r}: poly has no area")
    away = [((each + np.roll(each, -1)) * twice).sum() / (3 * twice.sum()) for each in (x, y)]
    return float(corners[0, 0] + away[0]), float(corners[0, 1] + away[1])


def _factor(touch: WrittenTouch, text: str, plan: Plan | None) -> float:
    if touch.strength is None:
        factor = math.nan if plan is None else plan.factor
        if not math.isfinite(factor):
            raise InputError(
                f"press {text!r}: says no capacitance factor, nor does a scene of the sweeps"
            )
        return factor
    if touch.strength.unit:
        other = "depth" if touch.strength.unit == "m" else "force"
        raise InputError(f"press {text!r}: needs a capacitance factor here, not a {other}")
    return touch.strength.value
