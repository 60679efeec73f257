"""Strengths of the presses of a data set, and the texts of presses."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from itertools import repeat

import numpy as np

from ..arrays import Integer, Real
from ..press.press import PICOFARAD_DECIMALS
from ..scene.parts import Plan, Pressing, Skin
from ..scene.pixel_grid import per_pixel
from ..sweeps import UNPRESSED

FACTOR_DECIMALS = 6
"""Decimals of drawn factors, so that the text of a press is exactly the press solved."""
DEPTH_DECIMALS = 9
"""Decimals of drawn depths in m, for the same reason."""
FINGER_DECIMALS = 16
"""Decimals of fingers' capacitances in F, for the same reason."""


def drawn_strengths(skin: Skin, plan: Plan, chances: Real) -> Real:
    """Random factors on c under touches, rounded as in the texts of factors or depths."""
    drawn = plan.draws.press
    if plan.press.adds:
        return _added_factors(skin, plan.draws.press.factor_within(skin.foam).at(chances))
    if plan.press.by_factor:
        return np.round(plan.draws.press.factor_within(skin.foam).at(chances), FACTOR_DECIMALS)
    if drawn.depth is not None:
        depth = drawn.depth.at(chances)
    else:
        depth = skin.pressed_depths(plan.draws.press.factor_within(skin.foam).at(chances))
    return skin.pressed_factors(np.round(depth, DEPTH_DECIMALS))


def _picofarads(skin: Skin, factor: Real) -> Real:
    """Capacitances that touches of pixels add, pF, as in their texts."""
    own = per_pixel(skin, skin.pixels)
    return np.round(1e12 * own * (factor - 1), PICOFARAD_DECIMALS)


def _added_factors(skin: Skin, factor: Real) -> Real:
    """Factors of the capacitances in the texts of touches."""
    return 1 + 1e-12 * _picofarads(skin, factor) / per_pixel(skin, skin.pixels)


def pixel_texts(
    touches: Integer,
    row: Integer,
    column: Integer,
    strength: Real,
    unit: str,
    finger: Real,
    rod: str = "",
) -> list[str]:
    """The text of each press, in the format of `label_of`.

    finger: capacitance to earth of each touch, F. rod: suffix from `rod_text`.
    """
    there = np.arange(row.shape[1]) < touches[:, None]
    rows, columns, strengths = (each[there].tolist() for each in (row, column, strength))
    numbers = repr(strengths)[1:-1].split(", ")  # all at once takes half the time
    parts = map(_place, rows, columns), numbers, repeat(unit), finger_texts(finger[there], rod)
    return joined_texts(touches, map("".join, zip(*parts, strict=False)))


def finger_texts(finger: Real, rod: str) -> Iterable[str]:
    """Suffix of the text of each touch: the capacitance to earth in F, or `rod` for 0 F."""
    if not finger.any():
        return repeat(rod)
    return [f":{each!r}F" if each else rod for each in finger.tolist()]


def joined_texts(touches: Integer, parts: Iterable[str]) -> list[str]:
    """Joins the texts of single touches into texts of presses with `touches` touches each."""
    each, first = np.array([*parts], dtype=object), np.cumsum(touches) - touches
    text = np.where(touches > 0, "", UNPRESSED).astype(object)
    for number in range(touches.max(initial=0)):
        here = touches > number
        text[here] += ("+" if number else "") + each[first[here] + number]
    return text.tolist()


@cache
def _place(row: int, column: int) -> str:
    return f"{row},{column}:"


def written_strength(skin: Skin, pressing: Pressing, factor: Real) -> tuple[Real, str]:
    """Strengths of touches as written in their texts, and the unit."""
    if pressing.adds:
        return _picofarads(skin, factor), "pF"
    if pressing.by_factor:
        return factor, ""
    return np.round(skin.pressed_depths(factor), DEPTH_DECIMALS), "m"
