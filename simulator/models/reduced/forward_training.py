"""Training of a forward model: random presses on skins of any parameters, and frequencies."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ...arrays import Real
from ...press.parts import parts_of
from ...press.press import Press
from ...press.random_presses import random_presses
from ...press.rasterized import touched_cells
from ...scene.parts import Plan, SceneParts, Setup, Skin
from ...scene.readout.meter import FrequencyGrid
from ..cosine_modes import random_amplitudes, variation_with_modes
from ..parameters import Variation, own_values, variation_of
from .cases import Case, Draw, pixel_touches, strongest_finger

REACH = 3.0
"""Largest factor on parameters and frequencies that a model is trained for, both ways."""
PIXEL_FACTORS = (0.5, 3.0)
BAND_POINTS = 20


def training_band(setup: Setup) -> Real:
    """Frequencies from the lowest of a scene over REACH to the highest times REACH, Hz."""
    low, high = setup.frequency[0], setup.frequency[-1]
    return np.array(
        FrequencyGrid(start=low / REACH, stop=high * REACH, points=BAND_POINTS).values()
    )


def uniform_variation(skin: Skin, values: Mapping[str, float], modes: int) -> Variation:
    """Variation of these parameters, with modes of the sheets but not of the foam."""
    return variation_with_modes(variation_of(skin, values), values, modes)


def training_draw(parts: SceneParts, cells_per_pixel: int, modes: int, varied: bool) -> Draw:
    """Draw of presses on skins of any parameters.

    Presses are on pixels, or anywhere if pixels are divided into several cells. modes: of each
    sheet's conductance. varied: False if the model needs the scene's own skin only.
    """
    skin, divided = parts.skin, parts.divided(cells_per_pixel).skin
    on_pixels = pixel_touches(divided, parts.plan, PIXEL_FACTORS)
    own = own_values(skin, parts.setup)
    fixed = [name for name in dict.fromkeys(parts_of(divided).fixed) if name in own]

    def draw(random: np.random.Generator) -> Case:
        mismatch, film = random.uniform(-1, 1, 2) * math.log(REACH)
        drawn = own | {"sheet_mismatch": mismatch, "contact_resistance": film}
        drawn |= random_amplitudes(random) if modes > 1 else {}
        factors = random.uniform(-1, 1, len(fixed)) * math.log(REACH)
        drawn |= dict(zip(fixed, factors.tolist(), strict=True))
        variation = uniform_variation(divided, drawn, modes) if varied else None
        if cells_per_pixel == 1:
            return replace(on_pixels(random), variation=variation)
        press = random_presses(divided, random, 2)[int(random.integers(2))]
        return Case(
            variation,
            *touched_cells(divided, _by_fingers(skin, divided, parts.plan, press, random)),
        )

    return draw


def _by_fingers(
    skin: Skin, divided: Skin, plan: Plan, press: Press, random: np.random.Generator
) -> Press:
    """Press with the same touches by fingers, if the scene has an earth that they reach."""
    if not parts_of(divided).fingers:
        return press
    strongest = strongest_finger(skin, plan)
    fingers = random.uniform(0.0, strongest, len(press.touches)).tolist()
    touches = zip(press.touches, fingers, strict=True)
    return press.of(replace(touch, finger=finger) for touch, finger in touches)
