"""What a design is judged by: the best accuracy of any classifier, on skins as they are cast."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..bounds.bayes import drawn, likeliest, templates
from ..bounds.readings import Hypothesis
from ..measure.experiment import own_presses
from ..scene.contacts import Interface
from ..scene.randomisation import AnyDistribution
from ..scene.scene import Scene
from .trained import CastReadings, Material, Trained

TENTH = 0.1


@dataclass(frozen=True)
class Layout:
    """What is read of a skin of a material: readings, and frequencies in Hz, ascending."""

    material: Material
    readings: tuple[Interface, ...]
    frequencies: tuple[float, ...]


@dataclass(frozen=True)
class Judge:
    """The same draws for all designs. among: what is to be told apart; casts: how many are drawn"""

    among: Sequence[Hypothesis]
    against_rest: int
    casts: int
    draws: int
    seed: int

    def shares(self, trained: Trained, layout: Layout) -> list[float]:
        """Told right at best: of the skin as it was meant, then of each cast. Raises InputError
        where the meter's noise is too small."""
        skins = [None, *(trained.cast(number) for number in range(self.casts))]
        presses = own_presses(trained.scene)
        found = []
        for skin in skins:
            on = trained.on(skin, layout.material, layout.readings)
            readings = CastReadings(on, np.array(layout.frequencies), self.against_rest)
            found.append(self._share(readings, presses))
        return found

    def _share(self, readings: CastReadings, presses: AnyDistribution) -> float:
        known = templates(readings, self.among, presses)
        random = np.random.default_rng(self.seed)
        measured = known.projected(drawn(readings, self.among, presses, random, self.draws))
        return float(likeliest(known, measured).mean())


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
