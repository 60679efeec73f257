"""What a design is judged by: the best accuracy of any classifier, on skins as they are cast."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..bounds.common_draws import CommonDraws
from ..measure.experiment import own_presses
from ..scene.contacts import Interface
from ..scene.design_goals import Design
from ..scene.scene import Scene
from .on_skin import Material, OnSkin
from .places import Touches
from .trained import Trained

TENTH = 0.1


@dataclass(frozen=True)
class Layout:
    """What is read of a skin of a material: readings, and frequencies in Hz, ascending, of all of
    them that have none of their own."""

    material: Material
    readings: tuple[Interface, ...]
    frequencies: tuple[float, ...]

    @property
    def of_each(self) -> list[tuple[float, ...]]:
        """Frequencies in Hz at which each reading is taken, ascending."""
        return [each.frequencies or self.frequencies for each in self.readings]

    @property
    def own(self) -> bool:
        """Whether readings have frequencies of their own."""
        return any(each.frequencies is not None for each in self.readings)

    @property
    def numbers(self) -> int:
        """Readings at all their frequencies."""
        return sum(map(len, self.of_each))


class Judge:
    """The same draws for all designs of a scene's pixels and meter."""

    def __init__(self, scene: Scene, asked: Design, draws: int, seed: int) -> None:
        """Raises InputError for a meter without noise."""
        self._common = CommonDraws(
            scene,
            asked.target,
            own_presses(scene),
            seed=seed,
            draws=draws,
            against_rest=asked.against_rest,
        )

    def merit(self, on: OnSkin, frequency: NDArray[np.float64]) -> float:
        """The share of sweeps of one skin told right at best; frequency in Hz. Raises InputError
        where the meter's noise is too small."""
        return float(self._common.judged(on.skin, on.reading(frequency)).accuracy.share)


class PlaceJudge:
    """How near half of all answers come at best, over how near guesses come."""

    def __init__(self, touches: Touches, against_rest: int) -> None:
        self._touches, self._against_rest = touches, against_rest

    def merit(self, on: OnSkin, frequency: NDArray[np.float64]) -> float:
        """Of one skin, 1 less that; frequency in Hz. Raises InputError for no noise."""
        bounds = self._touches.slopes(on, frequency, self._against_rest).bounds()
        return 1 - bounds.median_error() / self._touches.near.guess


def merits(judge: Judge | PlaceJudge, trained: Trained, layout: Layout, casts: int) -> list[float]:
    """Of the skin as it was meant, then of each of so many casts."""
    skins = [None, *(trained.cast(number) for number in range(casts))]
    ons = (trained.on(skin, layout.material, layout.readings) for skin in skins)
    return [judge.merit(on, np.array(layout.frequencies)) for on in ons]


def tenth(shares: Sequence[float]) -> float:
    """What nine of ten casts reach at least: the least value that a tenth do not exceed."""
    return sorted(shares)[math.ceil(TENTH * len(shares)) - 1]


def designed(scene: Scene, layout: Layout) -> Scene:
    """The scene that is so read, of that material."""
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
