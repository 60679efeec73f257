"""Places and strengths of touches, from numbers of a data set or the text of a press."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..models.mechanics.indentation import deformation
from ..press.press import parse_press, press_on, strength_of
from ..scene.parts import Pressing, Skin
from ..scene.scene_files import scene_of_sweeps
from ..sweeps import InputError
from ..sweeps.press_text import JOINT, WrittenTouch, parse_touches

if TYPE_CHECKING:
    import xarray as xr

    from ..arrays import Integer, Real
    from ..scene.parts import SceneParts

FACTOR_RTOL = 1e-3
"""Tolerance of the deflection next to an applicator of a given force, which sets its depth."""


def factors_under(skin: Skin, pressing: Pressing, press: str) -> list[float]:
    """Factor under each touch, in their order in the text.

    Raises InputError for a press that does not fit the scene, and what `deformation` raises.
    """
    whole, default = press_on(skin, pressing, press), strength_of(pressing)
    known = {str(touch): touch.factor for touch in whole.sharp.touches}
    if whole.indented:
        under = skin.pressed_factors(np.array(deformation(skin, whole, FACTOR_RTOL).depth))
        known |= dict(zip(map(str, whole.indented), under.tolist(), strict=True))
    return [known[str(parse_press(part, default, skin, pressing))] for part in JOINT.split(press)]


MAX_TOUCHES = 2
"""Maximum number of touches that a localizer distinguishes."""
NUMBERS = ("touches", "touch_x", "touch_y", "touch_factor")
"""Variables of data sets that store touches."""


@dataclass(frozen=True, eq=False)
class SweepTouches:
    """Number of touches of each sweep, shape (sweep,), and their centres and strengths.

    x, y [m], factor [capacitance over that of the unpressed skin]: shape (sweep, MAX_TOUCHES); 0, 0
    and 1 for no touch.
    """

    count: Integer
    x: Real
    y: Real
    factor: Real


def touches_of(sweeps: xr.Dataset) -> SweepTouches:
    """The touches of each sweep; depths and forces become factors on the sweeps' scene.

    Raises InputError that names a press with invalid syntax or with more than MAX_TOUCHES touches,
    if a place or a factor needs a scene and the sweeps have none, and as `factors_under`.
    """
    if all(name in sweeps for name in NUMBERS):
        count, x, y, factor = (sweeps[name].values for name in NUMBERS)
        return SweepTouches(count.astype(int), *(a.astype(np.float64) for a in (x, y, factor)))
    texts, index = np.unique(sweeps["press"].values.astype(str), return_inverse=True)
    scene = scene_of_sweeps(sweeps)
    parts = None if scene is None else scene.parts
    touches_of_text = [_touches(str(text), parts) for text in texts]
    numbers = np.zeros((3, len(texts), MAX_TOUCHES)) + np.array([0, 0, 1.0]).reshape(3, 1, 1)
    for k, touches in enumerate(touches_of_text):
        for t, touch in enumerate(touches):
            numbers[:, k, t] = touch
    return SweepTouches(
        np.array([len(each) for each in touches_of_text])[index], *numbers[:, index]
    )


def counts_of(sweeps: xr.Dataset) -> Integer:
    """Number of touches of each sweep, without a limit, shape (sweep,).

    Raises InputError as `parse_touches`.
    """
    if NUMBERS[0] in sweeps:
        return sweeps[NUMBERS[0]].values.astype(int)
    texts, index = np.unique(sweeps["press"].values.astype(str), return_inverse=True)
    return np.array([len(parse_touches(str(text))) for text in texts])[index]


def pressed_pixels(text: str) -> list[tuple[int, int]] | None:
    """(row, column) of each touch, ascending; None for more than MAX_TOUCHES, or no pixel.

    The list is empty for the unpressed skin. Raises InputError for invalid syntax.
    """
    touches = parse_touches(text)
    if len(touches) > MAX_TOUCHES or any(touch.kind != "pixel" for touch in touches):
        return None
    return sorted(touch.pixel for touch in touches)


def pixel_pitch(skin: Skin) -> tuple[float, float]:
    """Distance between rows of pixels, and between columns, m."""
    return skin.width / skin.pixels.rows, skin.length / skin.pixels.columns


def _written(text: str) -> list[WrittenTouch]:
    touches = parse_touches(text)
    if len(touches) > MAX_TOUCHES:
        raise InputError(f"press {text!r}: must be at most {MAX_TOUCHES} touches, joined by '+'")
    return touches


def _touches(text: str, parts: SceneParts | None) -> list[tuple[float, float, float]]:
    """x and y in m and factor of each touch."""
    written = _written(text)
    centres = [_centre(each, text, parts) for each in written]
    return [
        (*at, factor) for at, factor in zip(centres, _factors(written, text, parts), strict=True)
    ]


def _factors(written: list[WrittenTouch], text: str, parts: SceneParts | None) -> list[float]:
    known = parts is not None and parts.plan.press.by_factor
    stated = (known if each.strength is None else not each.strength.unit for each in written)
    if parts is None or all(stated):
        return [_factor(each, text, parts) for each in written]

    return factors_under(parts.skin, parts.plan.press, text)


def _centre(touch: WrittenTouch, text: str, parts: SceneParts | None) -> tuple[float, float]:
    if touch.kind == "poly":
        return _centroid(np.reshape(touch.numbers, (-1, 2)), text)
    if touch.kind != "pixel":
        return touch.numbers[0], touch.numbers[1]
    if parts is None:
        raise InputError(
            f"press {text!r}: the place of its pixels is unknown, because the sweeps store no scene"
        )
    row, column = touch.pixel
    height, width = pixel_pitch(parts.skin)
    return (column - 0.5) * width, (row - 0.5) * height


def _centroid(corners: Real, text: str) -> tuple[float, float]:
    """Centroid of a polygon, m."""
    x, y = (corners - corners[0]).T
    twice = x * np.roll(y, -1) - np.roll(x, -1) * y
    if not abs(twice.sum()) > 0:
        raise InputError(f"press {text!r}: poly has no area")
    away = [((each + np.roll(each, -1)) * twice).sum() / (3 * twice.sum()) for each in (x, y)]
    return float(corners[0, 0] + away[0]), float(corners[0, 1] + away[1])


def _factor(touch: WrittenTouch, text: str, parts: SceneParts | None) -> float:
    if touch.strength is None:
        if parts is None:
            raise InputError(
                f"press {text!r}: has no capacitance factor, and the sweeps store no scene with one"
            )
        return parts.plan.press.capacitance_factor
    if touch.strength.unit:
        other = "depth" if touch.strength.unit == "m" else "force"
        raise InputError(f"press {text!r}: needs a capacitance factor here, not a {other}")
    return touch.strength.value
