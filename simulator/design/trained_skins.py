"""Reduced model for all skins of a search: any sample, sheets, foam and readings."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from ..measure.skins import DrawnSkin, drawn_skin
from ..models.parameters import HALF_WAVES, nominal
from ..models.reduced.cases import Case, pixel_touches
from ..models.reduced.reduced_model import Reduced
from ..models.terminals import read, require_no_spread, trained
from ..progress import ProgressCallback, silent
from ..scene.contacts import Interface
from ..scene.design_goals import Design
from ..scene.parts import SceneParts, Setup, Skin
from .skin_readout import Material, SkinReadout, material_of
from .touch_positions import TouchPositions

RTOL = 1e-2
"""Certified tolerance of Rs and Cp for every reading; ln Z is about ten times more accurate."""
RTOL_OF_TOUCHES = 2e-3
"""Tolerance for positions: slopes are less accurate than values; bounds are so to some percent."""
FACTORS = (0.5, 3.0)
BEYOND = 2.0
"""Factor by which training exceeds the bounds of the sheets, for the spread of samples."""
BEYOND_LOG = math.log(BEYOND)


class TrainedSkins:
    """All skins that the constraints allow, with fixed foils."""

    def __init__(
        self,
        parts: SceneParts,
        request: Design,
        band: tuple[float, float],
        seed: int,
        progress: ProgressCallback = silent,
        touches: TouchPositions | None = None,
    ) -> None:
        """band: range of all frequencies, Hz. progress: see `ProgressCallback`. touches: at
        any position, instead of presses of whole pixels.

        Raises InputError where a tension spreads presses.
        """
        require_no_spread(parts.skin, parts.plan.press)
        self.parts, self._request, self._band, self._seed = parts, request, band, seed
        self._progress, self._touches = progress, touches
        self._divided = parts if touches is None else touches.divided
        self.modes = len(HALF_WAVES) if parts.plan.draws.session.unevenness else 1

    def sample(self, number: int) -> DrawnSkin:
        """A skin sample drawn from [dataset.session], as factors on the scene's."""
        return drawn_skin(
            self.parts, self._seed, number, self._divided.skin.pixels.shape, self.modes
        )

    def readout(
        self, cast: DrawnSkin | None, material: Material, readings: Sequence[Interface]
    ) -> SkinReadout:
        """Readout of a skin of a material with some readings; None for the nominal skin."""
        own = read(self.reduced, readings)
        drawn = cast or _nominal(self._divided.skin, self._divided.setup, self.modes)
        top, bottom = self.parts.skin.top, self.parts.skin.bottom
        variation = replace(
            drawn.variation,
            top=drawn.variation.top * (top.sheet_resistance / material.top),
            bottom=drawn.variation.bottom * (bottom.sheet_resistance / material.bottom),
            capacitance=drawn.variation.capacitance * material.foam,
            beyond_pixels=drawn.variation.beyond_pixels * material.foam,
        )
        return SkinReadout(own, readings, DrawnSkin(variation, drawn.leads))

    @cached_property
    def reduced(self) -> Reduced:
        """The model, trained at first use for all that the constraints allow."""
        rtol = RTOL if self._touches is None else RTOL_OF_TOUCHES
        return trained(
            self._divided,
            rtol,
            self._draw,
            modes=self.modes,
            progress=self._progress,
            frequency=np.unique(self._band),
        )

    def _draw(self, random: np.random.Generator) -> Case:
        request = self._request
        draw = (
            pixel_touches(self.parts.skin, self.parts.plan, FACTORS)
            if self._touches is None
            else self._touches.training_touch
        )
        press, grid = draw(random), self._divided.skin.pixels.shape
        skin = drawn_skin(self.parts, int(random.integers(2**62)), 0, grid, self.modes)
        own = material_of(self.parts.skin)
        lowest = np.log(min(*request.sheet_resistance, own.top, own.bottom))
        highest = np.log(max(*request.sheet_resistance, own.top, own.bottom))
        half = math.log(BEYOND * request.sheet_ratio) / 2
        mean, turn = (
            random.uniform(lowest - BEYOND_LOG, highest + BEYOND_LOG),
            random.uniform(-half, half),
        )
        foam = random.uniform(*np.log(foam_bounds(self.parts.skin, request)))
        top, bottom = own.top / math.exp(mean + turn), own.bottom / math.exp(mean - turn)
        drawn = skin.variation
        variation = replace(
            drawn,
            top=drawn.top * top,
            bottom=drawn.bottom * bottom,
            capacitance=drawn.capacitance * math.exp(foam),
            beyond_pixels=drawn.beyond_pixels * math.exp(foam),
        )
        return replace(press, variation=variation)


def foam_bounds(skin: Skin, request: Design) -> tuple[float, float]:
    """Bounds of the foam's capacitance over the scene's, from those of its thickness."""
    thickness = skin.foam.thickness
    if request.foam_thickness is None or thickness is None:
        return 1.0, 1.0
    low, high = request.foam_thickness
    return thickness / max(high, thickness), thickness / min(low, thickness)


def _nominal(skin: Skin, setup: Setup, modes: int) -> DrawnSkin:
    return DrawnSkin(nominal(skin, modes), setup.leads)
