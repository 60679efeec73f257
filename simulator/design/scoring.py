"""Scores of a design: the best accuracy of any classifier, or position error, on skin samples."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Real
from ..bounds.bayes import CommonDraws
from ..measure.experiment import own_presses
from ..scene.contacts import Interface
from ..scene.design_goals import Design
from ..scene.parts import SceneParts
from ..scene.scene import Scene
from .skin_readout import Material, SkinReadout
from .touch_positions import TouchPositions
from .trained_skins import TrainedSkins

TENTH = 0.1


@dataclass(frozen=True)
class Layout:
    """Material, readings and frequencies of a design.

    frequencies: Hz, ascending, for all readings without own frequencies.
    """

    material: Material
    readings: tuple[Interface, ...]
    frequencies: tuple[float, ...]

    @property
    def frequencies_of_each(self) -> list[tuple[float, ...]]:
        """Frequencies in Hz at which each reading is taken, ascending."""
        return [each.frequencies or self.frequencies for each in self.readings]

    @property
    def has_own_frequencies(self) -> bool:
        """True if readings have frequencies of their own."""
        return any(each.frequencies is not None for each in self.readings)

    @property
    def count(self) -> int:
        """Number of readings, each counted at all its frequencies."""
        return sum(map(len, self.frequencies_of_each))


class AccuracyScorer:
    """Scores the accuracy of designs, with the same draws for all of them."""

    def __init__(self, parts: SceneParts, request: Design, draws: int, seed: int) -> None:
        presses = own_presses(parts.skin, parts.plan.press)
        self._common = CommonDraws(parts, request.target, presses, seed=seed, draws=draws)
        self._against_rest = request.against_rest

    def merit(self, on: SkinReadout, frequency: Real) -> float:
        """Best share of correct sweeps of one skin; frequency in Hz.

        Raises InputError where the meter's noise is too small.
        """
        known = on.likelihood(frequency, self._against_rest)
        return float(self._common.score(known).accuracy.share)


class PositionScorer:
    """Scores the position error of designs, relative to that of a guess."""

    def __init__(self, touches: TouchPositions, against_rest: int) -> None:
        self._touches, self._against_rest = touches, against_rest

    def merit(self, on: SkinReadout, frequency: Real) -> float:
        """1 minus the median error of one skin over that of a guess; frequency in Hz.

        Raises InputError for a meter without noise.
        """
        bounds = self._touches.slopes(on, frequency, self._against_rest).bounds()
        return 1 - bounds.median_error() / self._touches.merit.guess


def merits(
    scorer: AccuracyScorer | PositionScorer, trained: TrainedSkins, layout: Layout, casts: int
) -> list[float]:
    """Merits of the nominal skin, then of each of a number of samples."""
    skins = [None, *(trained.sample(number) for number in range(casts))]
    ons = (trained.readout(skin, layout.material, layout.readings) for skin in skins)
    return [scorer.merit(on, np.array(layout.frequencies)) for on in ons]


def lowest_tenth(shares: Sequence[float]) -> float:
    """Merit that nine of ten samples reach at least."""
    return sorted(shares)[math.ceil(TENTH * len(shares)) - 1]


def designed(scene: Scene, layout: Layout) -> Scene:
    """The scene with a layout's material, readings and frequencies."""
    foam, factor = scene.skin.foam, layout.material.foam
    of_foam: dict[str, object] = {}
    if factor != 1 and foam.thickness is not None:
        of_foam = {"skin.foam.thickness": foam.thickness / factor}
    return scene.with_(
        {
            "skin.top.sheet_resistance": layout.material.top,
            "skin.bottom.sheet_resistance": layout.material.bottom,
            **of_foam,
            "interface": [each.model_dump(mode="json") for each in layout.readings],
            "sweep.frequencies": list(layout.frequencies),
        }
    )
