"""Fingers of a data set's touches: capacitance to earth, and touches without pressure."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..arrays import Integer, Mask, Real
from ..press.finger import finger_capacitance, finger_over
from ..press.pixels import pixels_with_skin
from ..press.touch import Touch
from ..press.walls import require_no_walls
from ..scene.draws.randomisation import DrawnPress
from ..scene.parts import Plan, Pressing, SceneParts, Skin
from ..scene.surroundings import NO_EARTH
from ..sweeps import InputError
from .strengths import FINGER_DECIMALS


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
        require_no_walls(skin, f"a data set of touches next to pixels (`{_off_pixel_key(press)}`)")
    if not named:
        return
    if around is None:
        fingers = press.finger is not None or press.without_press is not None
        raise InputError(f"{named[0]} {NO_EARTH if fingers else 'needs the table [surroundings]'}")
    if press.finger is not None and around.no_finger_reason:
        raise InputError(f"{named[0]}: {around.no_finger_reason}")
    if session.body is not None and around.solved:
        raise InputError(
            f"{skin.name}: `dataset.session.body` cannot vary the body of `surroundings.solved`, "
            "whose charges are solved for once; leave one of both out"
        )
    if session.body is not None and not around.body:
        raise InputError(f"{skin.name}: `dataset.session.body` needs a `surroundings.body`")
    if session.rim is not None and not around.rim:
        raise InputError(f"{skin.name}: `dataset.session.rim` needs `surroundings.rim`")
    if press.without_press:
        _check_touching(skin, plan)


def _off_pixel_key(press: DrawnPress) -> str:
    return "dataset.press.offset" if press.place == "pixel" else "dataset.press.place"


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
