"""Strengths of the touches of a press as factors of capacitance, from factors, depths, forces."""

from __future__ import annotations

import numpy as np

from ..models.mechanics.indentation import deformation
from ..press.press import parse_press, press_on, strength_of
from ..scene.parts import Pressing, Skin
from ..sweeps.press_text import JOINT

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
