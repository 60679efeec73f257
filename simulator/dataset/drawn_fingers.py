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
from ..scene.scene import Scene
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

    def over(self, scene: Scene, area: Real, there: Mask) -> Real:
        """Capacitance to earth in F of touches with these areas in m²; 0 without a touch."""
        how = scene.press.finger
        return self._rounded(
            finger_over(scene.parts.skin, area, how) if self.drawn is None else None, there
        )

    def of_pixels(self, scene: Scene, pixel: Integer, there: Mask) -> Real:
        """Capacitance to earth in F of touches of whole pixels, by pixel number."""
        own = self.drawn is None and scene.press.finger
        return self._rounded(_on_pixels(scene)[pixel] if own else None, there)

    def _rounded(self, own: Real | None, there: Mask) -> Real:
        """Rounded capacitance. own: of the scene's fingers, F; None if drawn, or for rods."""
        finger = (0.0 if self.drawn is None else self.drawn) if own is None else own
        return np.where(there, np.round(finger, FINGER_DECIMALS), 0.0)


def _on_pixels(scene: Scene) -> Real:
    """Capacitance of the scene's finger on each pixel, F; 0 where there is no skin."""
    how, found = scene.press.finger, np.zeros(scene.pixels.rows * scene.pixels.columns)
    assert how is not None
    for row, column in pixels_with_skin(scene.parts.skin):
        touch = Touch(row, column, 1.0)
        found[(row - 1) * scene.pixels.columns + column - 1] = finger_capacitance(
            scene.parts.skin, touch, how
        )
    return found


def drawn_fingers(
    scene: Scene, random: np.random.Generator, shape: tuple[int, ...]
) -> DrawnFingers:
    """Draws the fingers of touches, shape (press, touch); fixed values use no random numbers."""
    drawn = scene.dataset.press
    finger = None if drawn.finger is None else drawn.finger.at(random.random(shape))
    share = drawn.without_press
    alone = random.random(shape) < share if share else np.zeros(shape, dtype=bool)
    return DrawnFingers(finger, alone)


OWN_FINGERS = DrawnFingers(None, np.zeros((1, 1), dtype=bool))
"""The fingers of the scene's `press`; every touch presses."""


def check_surroundings(scene: Scene) -> None:
    """Raises InputError if fingers, bodies or rims are drawn that the scene lacks.

    Also raises it if touches with walls are not whole pixels.
    """
    press, session, around = scene.dataset.press, scene.dataset.session, scene.surroundings
    drawn = {
        "press.finger": press.finger,
        "press.without_press": press.without_press,
        "session.body": session.body,
        "session.rim": session.rim,
    }
    named = [f"{scene.name}: `dataset.{key}`" for key, each in drawn.items() if each is not None]
    if press.rasterized:
        require_no_walls(
            scene.parts.skin, f"a data set of touches next to pixels (`{_off_pixel_key(press)}`)"
        )
    if not named:
        return
    if around is None:
        fingers = press.finger is not None or press.without_press is not None
        raise InputError(f"{named[0]} {NO_EARTH if fingers else 'needs the table [surroundings]'}")
    if press.finger is not None and around.no_finger_reason:
        raise InputError(f"{named[0]}: {around.no_finger_reason}")
    if session.body is not None and around.solved:
        raise InputError(
            f"{scene.name}: `dataset.session.body` cannot vary the body of `surroundings.solved`, "
            "whose charges are solved for once; leave one of both out"
        )
    if session.body is not None and not around.body:
        raise InputError(f"{scene.name}: `dataset.session.body` needs a `surroundings.body`")
    if session.rim is not None and not around.rim:
        raise InputError(f"{scene.name}: `dataset.session.rim` needs `surroundings.rim`")
    if press.without_press:
        _check_touching(scene)


def _off_pixel_key(press: DrawnPress) -> str:
    return "dataset.press.offset" if press.place == "pixel" else "dataset.press.place"


def _check_touching(scene: Scene) -> None:
    drawn = scene.dataset.press.finger
    fingers = scene.press.finger if drawn is None else drawn.high
    if not fingers:
        raise InputError(
            f"{scene.name}: `dataset.press.without_press` needs fingers, without which such a "
            "touch changes nothing: give `dataset.press.finger`"
        )
    if not scene.press.by_factor:
        raise InputError(
            f"{scene.name}: `dataset.press.without_press` needs `press.capacitance_factor` in "
            "place of `press.depth` or `press.force`"
        )
