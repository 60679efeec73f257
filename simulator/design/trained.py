"""One skin trained for all that a search asks of it: any cast, sheets, foam and readings."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from ..measure.skins import DrawnSkin, drawn_skin
from ..models.network.terminals import read, require_no_spread, trained
from ..models.parameters import HALF_WAVES, nominal
from ..models.reduced.cases import Case, pixel_touches
from ..models.reduced.model import Reduced
from ..progress import ProgressCallback, silent
from ..scene.contacts import Interface
from ..scene.design_goals import Design
from ..scene.scene import Scene
from .on_skin import Material, OnSkin, material_of
from .places import Touches

RTOL = 1e-2
"""Of Rs and Cp, certified for every reading; ln Z is then some ten times closer."""
RTOL_OF_TOUCHES = 2e-3
"""As slopes are known less closely than what they are slopes of: bounds to some percent."""
FACTORS = (0.5, 3.0)
BEYOND = 2.0
"""Times the bounds of sheets that training reaches, for what a cast may be off by."""
BEYOND_LOG = math.log(BEYOND)


class Trained:
    """The skins that a scene's bounds allow, with the foils where they are."""

    def __init__(
        self,
        scene: Scene,
        asked: Design,
        band: tuple[float, float],
        seed: int,
        progress: ProgressCallback = silent,
        touches: Touches | None = None,
    ) -> None:
        """band: of all frequencies that are asked for, Hz. progress: as of `ProgressCallback`.
        touches: anywhere, in place of pixels pressed whole.

        Raises InputError where a tension spreads presses."""
        require_no_spread(scene)
        self.scene, self._asked, self._band, self._seed = scene, asked, band, seed
        self._progress, self._touches = progress, touches
        self._divided = scene if touches is None else touches.divided
        self.modes = len(HALF_WAVES) if scene.dataset.session.unevenness else 1

    def cast(self, number: int) -> DrawnSkin:
        """One of the skins as [dataset.session] spreads them, as factors on the scene's."""
        return drawn_skin(self.scene, self._seed, number, self._divided.pixels.shape, self.modes)

    def on(
        self, cast: DrawnSkin | None, material: Material, readings: Sequence[Interface]
    ) -> OnSkin:
        """One skin of a material under readings; None for the cast as it was meant."""
        own = read(self.reduced, readings)
        drawn = cast or _nominal(self._divided, self.modes)
        top, bottom = self.scene.skin.top, self.scene.skin.bottom
        variation = replace(
            drawn.variation,
            top=drawn.variation.top * (top.sheet_resistance / material.top),
            bottom=drawn.variation.bottom * (bottom.sheet_resistance / material.bottom),
            capacitance=drawn.variation.capacitance * material.foam,
            beside=drawn.variation.beside * material.foam,
        )
        return OnSkin(own, readings, DrawnSkin(variation, drawn.leads))

    @cached_property
    def reduced(self) -> Reduced:
        """The model, trained at first use on all that the bounds allow."""

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
        scene, asked = self.scene, self._asked
        draw = pixel_touches(scene, FACTORS) if self._touches is None else self._touches.drawn
        press, grid = draw(random), self._divided.pixels.shape
        skin = drawn_skin(scene, int(random.integers(2**62)), 0, grid, self.modes)
        own = material_of(scene)
        least = np.log(min(*asked.sheet_resistance, own.top, own.bottom))
        most = np.log(max(*asked.sheet_resistance, own.top, own.bottom))
        half = math.log(BEYOND * asked.sheet_ratio) / 2
        mean, turn = (
            random.uniform(least - BEYOND_LOG, most + BEYOND_LOG),
            random.uniform(-half, half),
        )
        foam = random.uniform(*np.log(foam_bounds(scene, asked)))
        top, bottom = own.top / math.exp(mean + turn), own.bottom / math.exp(mean - turn)
        drawn = skin.variation
        variation = replace(
            drawn,
            top=drawn.top * top,
            bottom=drawn.bottom * bottom,
            capacitance=drawn.capacitance * math.exp(foam),
            beside=drawn.beside * math.exp(foam),
        )
        return replace(press, variation=variation)


def foam_bounds(scene: Scene, asked: Design) -> tuple[float, float]:
    """Of capacitance over the scene's own, by the bounds of thickness at the same permittivity."""
    thickness = scene.skin.foam.thickness
    if asked.foam_thickness is None or thickness is None:
        return 1.0, 1.0
    low, high = asked.foam_thickness
    return thickness / max(high, thickness), thickness / min(low, thickness)


def _nominal(scene: Scene, modes: int) -> DrawnSkin:
    return DrawnSkin(nominal(scene, modes), scene.leads)
