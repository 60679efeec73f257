"""Reduced model for all skins of a search: any sample, sheets, foam and readings."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from ..arrays import Complex, Real
from ..bounds.likelihood import Likelihood
from ..measure.skins import DrawnSkin, drawn_skin
from ..models.network_skin import Network
from ..models.parameters import HALF_WAVES, nominal
from ..models.reduced.cases import Case
from ..models.reduced.reduced_model import Reduced
from ..models.reduced.reduced_skin import ReducedSkin
from ..models.terminals import read, trained
from ..press.batch import PressBatch
from ..progress import ProgressCallback, silent
from ..scene.contacts import Interface
from ..scene.design_goals import Design
from ..scene.parts import SceneParts, Setup, Skin
from .goals import Goal
from .layout import Material, material_of

BEYOND = 2.0
"""Factor by which training exceeds the bounds of the sheets, for the spread of samples."""
BEYOND_LOG = math.log(BEYOND)


class SkinReadout:
    """One skin with some readings: its model, and what the meter observes of presses."""

    def __init__(self, reduced: Reduced, readings: Sequence[Interface], drawn: DrawnSkin) -> None:
        self.parts, self._readings, self._leads = reduced.parts, readings, drawn.leads
        self.skin: ReducedSkin = reduced.at(drawn.variation)

    def reading(self, frequency: Real) -> Setup:
        """Its readings at these frequencies in Hz, behind its own leads."""
        return Setup(tuple(self._readings), frequency, self._leads)

    def likelihood(self, frequency: Real, against_rest: int) -> Likelihood:
        """Likelihood of presses by these readings; frequency in Hz."""
        network = Network(self.skin, self._readings)

        def solve(batch: PressBatch) -> Complex:
            return network.solve(batch, frequency).Z

        meter, skin = self.parts.meter, self.parts.skin
        return Likelihood(skin, solve, self.reading(frequency), meter, against_rest)


class TrainedSkins:
    """All skins that the constraints allow, with fixed foils."""

    def __init__(
        self,
        parts: SceneParts,
        request: Design,
        band: tuple[float, float],
        seed: int,
        goal: Goal,
        progress: ProgressCallback = silent,
    ) -> None:
        """band: range of all frequencies, Hz. progress: see `ProgressCallback`."""
        self.parts, self._request, self._band, self._seed = parts, request, band, seed
        self._progress, self._goal, self._divided = progress, goal, goal.divided
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
        return trained(
            self._divided,
            self._goal.rtol,
            self._draw,
            modes=self.modes,
            progress=self._progress,
            frequency=np.unique(self._band),
        )

    def _draw(self, random: np.random.Generator) -> Case:
        request = self._request
        press, grid = self._goal.training_touch(random), self._divided.skin.pixels.shape
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
