"""Readings of presses on the pixels of one skin, of one material."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from ..arrays import Complex, Real
from ..bounds.likelihood import Likelihood
from ..measure.skins import DrawnSkin
from ..models.network_skin import NetworkSkin
from ..models.reduced.reduced_model import Reduced
from ..models.reduced.reduced_skin import ReducedSkin
from ..press.batch import PressBatch
from ..scene.contacts import Interface
from ..scene.parts import Setup, Skin


@dataclass(frozen=True)
class Material:
    """Sheet resistances in ohm/sq, and the foam's capacitance over that of the scene."""

    top: float
    bottom: float
    foam: float = 1.0

    def times(self, factor: float) -> Material:
        """Both sheets that many times as resistive."""
        return replace(self, top=factor * self.top, bottom=factor * self.bottom)


def material_of(skin: Skin) -> Material:
    """The material of a scene."""
    return Material(skin.top.sheet_resistance, skin.bottom.sheet_resistance)


class SkinReadout:
    """One skin with some readings: its model, and what the meter observes of presses."""

    def __init__(self, reduced: Reduced, readings: Sequence[Interface], drawn: DrawnSkin) -> None:
        self.parts, self._readings, self._leads = reduced.parts, readings, drawn.leads
        self.skin: ReducedSkin = reduced.skin(drawn.variation)

    def reading(self, frequency: Real) -> Setup:
        """Its readings at these frequencies in Hz, behind its own leads."""
        return Setup(tuple(self._readings), frequency, self._leads)

    def likelihood(self, frequency: Real, against_rest: int) -> Likelihood:
        """Likelihood of presses by these readings; frequency in Hz."""
        network = NetworkSkin(self.skin, frequency)
        wiring = network.wiring(self._readings)

        def solve(batch: PressBatch) -> Complex:
            return network.impedances(wiring, network.admittances(batch))

        return Likelihood(solve, self.reading(frequency), self.parts.meter, against_rest)
