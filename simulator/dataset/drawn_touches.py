"""Touches of data sets: their strengths and fingers."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from itertools import repeat
from typing import NamedTuple

import numpy as np

from ..arrays import Integer, Mask, Real
from ..press.finger import finger_capacitance, finger_over
from ..press.pixels import pixels_with_skin
from ..press.press import PICOFARAD_DECIMALS
from ..press.touch import Touch
from ..scene.parts import Plan, Pressing, SceneParts, Skin
from ..scene.pixel_grid import per_pixel
from ..scene.supports import require
from ..scene.surroundings import NO_EARTH
from ..sweeps import UNPRESSED, InputError

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


class DrawnFingers(NamedTuple):
    """Random properties of the fingers of many presses, shape (press, touch).

    drawn: capacitance to earth, F; None if fingers are those of the scene's `press`. alone: mask of
    touches without pressure.
    """

    drawn: Real | None
    alone: Mask

    def over(self, skin: Skin, pressing: Pressing, area: Real, there: Mask) -> Real:
        """Capacitance to earth in F of touches with these areas in m²; 0 without a touch."""
        how = pressing.finger
        return self._rounded(finger_over(skin, area, how) if self.drawn is None else None, there)

    def of_pixels(self, parts: SceneParts, pixel: Integer, there: Mask) -> Real:
        """Capacitance to earth in F of touches of whole pixels, by pixel number."""
        own = self.drawn is None and parts.plan.press.finger
        return self._rounded(
            _on_pixels(parts.skin, parts.plan.press)[pixel] if own else None, there
        )

    def _rounded(self, own: Real | None, there: Mask) -> Real:
        """Rounded capacitance. own: of the scene's fingers, F; None if drawn, or for rods."""
        finger = (0.0 if self.drawn is None else self.drawn) if own is None else own
        return np.where(there, np.round(finger, FINGER_DECIMALS), 0.0)


def _on_pixels(skin: Skin, pressing: Pressing) -> Real:
    """Capacitance of the scene's finger on each pixel, F; 0 where there is no skin."""
    how, found = pressing.finger, np.zeros(skin.pixels.rows * skin.pixels.columns)
    assert how is not None
    for row, column in pixels_with_skin(skin):
        touch = Touch(row, column, 1.0)
        found[(row - 1) * skin.pixels.columns + column - 1] = finger_capacitance(skin, touch, how)
    return found


def drawn_fingers(plan: Plan, random: np.random.Generator, shape: tuple[int, ...]) -> DrawnFingers:
    """Draws the fingers of touches, shape (press, touch); fixed values use no random numbers."""
    drawn = plan.draws.press
    finger = None if drawn.finger is None else drawn.finger.at(random.random(shape))
    share = drawn.without_press
    alone = random.random(shape) < share if share else np.zeros(shape, dtype=bool)
    return DrawnFingers(finger, alone)


OWN_FINGERS = DrawnFingers(None, np.zeros((1, 1), dtype=bool))
"""The fingers of the scene's `press`; every touch presses."""


def check_surroundings(skin: Skin, plan: Plan) -> None:
    """Raises InputError if fingers, bodies or rims are drawn that the scene lacks.

    Also raises it if touches with walls are not whole pixels.
    """
    press, session, around = plan.draws.press, plan.draws.session, skin.around
    drawn = {
        "press.finger": press.finger,
        "press.without_press": press.without_press,
        "session.body": session.body,
        "session.rim": session.rim,
    }
    named = [f"{skin.name}: `dataset.{key}`" for key, each in drawn.items() if each is not None]
    if press.rasterized:
        require("a data set of touches next to pixels", skin)
    if not named:
        return
    if around is None:
        fingers = press.finger is not None or press.without_press is not None
        raise InputError(f"{named[0]} {NO_EARTH if fingers else 'needs the table [surroundings]'}")
    if press.finger is not None and around.no_finger_reason:
        raise InputError(f"{named[0]}: {around.no_finger_reason}")
    if session.body is not None and not around.body:
        raise InputError(f"{skin.name}: `dataset.session.body` needs a `surroundings.body`")
    if session.rim is not None and not around.rim:
        raise InputError(f"{skin.name}: `dataset.session.rim` needs `surroundings.rim`")
    if press.without_press:
        _check_touching(skin, plan)


def _check_touching(skin: Skin, plan: Plan) -> None:
    drawn = plan.draws.press.finger
    fingers = plan.press.finger if drawn is None else drawn.high
    if not fingers:
        raise InputError(
            f"{skin.name}: `dataset.press.without_press` needs fingers, without which such a "
            "touch changes nothing: give `dataset.press.finger`"
        )
    if not plan.press.by_factor:
        raise InputError(
            f"{skin.name}: `dataset.press.without_press` needs `press.capacitance_factor` in "
            "place of `press.depth` or `press.force`"
        )
