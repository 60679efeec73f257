"""Skins of a batch with their leads: readings at the meter, without its errors, under presses."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..measure.skins import DrawnSkin, drawn_skin
from ..models.reduced.reduced_model import Reduced
from ..models.reduced.reduced_skin import ReducedSkin
from ..press.batch import PressBatch
from ..scene.meter import Leads
from ..scene.scene import Scene


class MountedSkins:
    """Skins of a family by number, each as a session of its scene draws it."""

    def __init__(self, scene: Scene, family: Reduced, seed: int, numbers: Sequence[int]) -> None:
        self.family, self.numbers = family, numbers
        self._drawn = [
            drawn_skin(scene, seed, number, family.grid, family.modes) for number in numbers
        ]
        self._reading = scene.reading.behind(_stacked_leads(self._drawn))

    def readings(self, batch: PressBatch) -> NDArray[np.complex128]:
        """Complex readings, shape (skin, interface, frequency).

        batch: one press for all skins, or one for each.
        """
        one = batch.one(0) if batch.count == 1 else None
        Z = [skin.sweep(*(one or batch.one(k))) for k, skin in enumerate(self._skins)]
        return self._reading.at_meter(np.stack(Z))

    @cached_property
    def _skins(self) -> list[ReducedSkin]:
        return [self.family.skin(drawn.variation) for drawn in self._drawn]


def _stacked_leads(drawn: Sequence[DrawnSkin]) -> Leads:
    """Leads of all skins as one table of arrays that broadcast to (skin, interface, frequency)."""
    each = [[skin.leads.resistance, skin.leads.stray_capacitance] for skin in drawn]
    resistance, stray = np.array(each).T[..., None, None]
    return Leads.model_construct(
        resistance=resistance,
        inductance=drawn[0].leads.inductance,
        stray_capacitance=stray,
        guard=0.0,
    )
