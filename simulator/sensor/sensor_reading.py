"""Latest readings of a sensor at a moment."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ..arrays import Mask, Real
from ..scene.parts import Setup
from ..sweeps.reading_quantities import reading_name
from .given_press import PressLabel
from .reading_clock import DueReading


class TakenReading(NamedTuple):
    """A reading whose middle is past. values: shape (quantity, skin, frequency)."""

    due: DueReading
    values: Real
    labels: tuple[PressLabel, ...]


@dataclass(frozen=True, eq=False)
class VectorLayout:
    """Order of the numbers in `SensorReading.vector`: quantity by quantity, in the meter's order.

    read: mask of the readings, shape (interface, frequency).
    """

    quantities: tuple[str, ...]
    names: tuple[str, ...]
    units: tuple[str, ...]
    read: Mask

    @classmethod
    def of(cls, setup: Setup) -> VectorLayout:
        """Layout for the readings of a scene."""
        each = [
            (
                reading_name(quantity.name, setup.interfaces[i].name, float(setup.frequency[k])),
                quantity.units,
            )
            for quantity in setup.kind.quantities
            for i, k in np.argwhere(setup.read)
        ]
        names, units = zip(*each, strict=True)
        return cls(setup.kind.names, names, units, setup.read)


@dataclass(frozen=True, eq=False)
class SensorReading:
    """Latest value of each reading of a batch of skins, NaN before the first one.

    time: time by the sensor's clock, s. values: shape (quantity, skin, interface, frequency),
    read-only. taken_at: end of each reading, s, shape (interface, frequency), NaN before the first
    one. fresh: True for readings that ended within the last step, shape (interface, frequency).
    limited: True for skins whose contacts would compress the foam further than it can be, or than
    the model covers, and are limited to that, shape (skin,). beside: force that touches the body of
    a mounted skin and not the skin, N, shape (skin,).
    """

    time: float
    values: Real
    taken_at: Real
    fresh: Mask
    limited: Mask
    layout: VectorLayout
    beside: Real

    @property
    def Rs(self) -> Real:
        """Series resistance, ohm, shape (skin, interface, frequency)."""
        return self._quantity("Rs")

    @property
    def X(self) -> Real:
        """Series reactance, ohm, shape (skin, interface, frequency)."""
        return self._quantity("X")

    @property
    def Cp(self) -> Real:
        """Parallel capacitance, F, shape (skin, interface, frequency)."""
        return self._quantity("Cp")

    @property
    def gain(self) -> Real:
        """Gain at the node, |V / V_s|, shape (skin, interface, frequency)."""
        return self._quantity("gain")

    @property
    def gain_phase(self) -> Real:
        """Phase of V / V_s, rad, shape (skin, interface, frequency)."""
        return self._quantity("gain_phase")

    @cached_property
    def vector(self) -> Real:
        """All readings of each skin in the order of `Sensor.names`, shape (skin, n)."""
        read = self.values[:, :, self.layout.read]
        return np.ascontiguousarray(read.swapaxes(0, 1)).reshape(read.shape[1], -1)

    def _quantity(self, name: str) -> Real:
        if name not in self.layout.quantities:
            known = ", ".join(self.layout.quantities)
            raise AttributeError(f"readings of this scene have no {name}: they have {known}")
        return self.values[self.layout.quantities.index(name)]
