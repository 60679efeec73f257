"""Readings of presses on the pixels of one skin, of one material."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from ..arrays import Complex, Real
from ..measure.readout import ErrorModel, errors_of, observed
from ..measure.skins import DrawnSkin
from ..models.network.network_skin import NetworkSkin
from ..models.reduced.reduced_model import Reduced
from ..models.reduced.reduced_skin import ReducedSkin
from ..press.batch import NOTHING, PressBatch
from ..scene.parts import Setup, Skin
from ..scene.readings.contacts import Interface


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

    def errors(self, frequency: Real, against_rest: int) -> ErrorModel:
        """Errors of these readings, evaluated at the unpressed skin; frequency in Hz."""
        return errors_of(
            self.reading(frequency),
            self.parts.meter,
            against_rest,
            unpressed=lambda: self._impedances(PressBatch.of([NOTHING]), frequency)[0],
        )

    def observed(self, batch: PressBatch, frequency: Real) -> Real:
        """ln |Z| and phase of many presses, shape (press, 2 * readings)."""
        return observed(self._impedances(batch, frequency))

    def _impedances(self, batch: PressBatch, frequency: Real) -> Complex:
        """Z in ohm at the meter, shape (press, reading, frequency)."""
        network = NetworkSkin(self.skin, frequency)
        Y = network.admittances(batch)
        Z = network.impedances(network.wiring(self._readings), Y)
        return self.reading(frequency).at_meter(Z)
