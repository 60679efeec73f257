"""All readings of a sweep as one vector of named numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...arrays import Mask, Real
from ...sweeps.reading_quantities import DESCRIBED, kind_of, reading_name
from ...sweeps.reading_subset import read_mask
from ...sweeps.schema import DIMENSIONS

if TYPE_CHECKING:
    import xarray as xr

SCALED = {"F": ("pF", 1e12)}
"""Units in which learners get a quantity, and the factor: learners add about 1e-8 to a standard
deviation before they divide by it, which is more than all capacitances in F."""


@dataclass(frozen=True, eq=False)
class ReadingVector:
    """Names, units and factors of the readings in a vector; skipped readings are left out.

    quantities: names. read: mask, shape (interface, frequency).
    """

    quantities: tuple[str, ...]
    interfaces: tuple[str, ...]
    frequencies: tuple[float, ...]
    read: Mask

    @property
    def names(self) -> list[str]:
        """Name of each number, as in `Sensor.names`."""
        return [
            reading_name(quantity, self.interfaces[i], self.frequencies[k])
            for quantity in self.quantities
            for i, k in np.argwhere(self.read)
        ]

    @property
    def units(self) -> list[str]:
        """Unit of each number."""
        count = int(self.read.sum())
        return [unit for name in self.quantities for unit in count * [_scale(name)[0]]]

    def values(self, sweeps: xr.Dataset) -> NDArray[np.float32]:
        """The vector of each sweep, shape (sweep, number)."""
        return np.concatenate(
            [
                sweeps[name].transpose(*DIMENSIONS).values[:, self.read] * _scale(name)[1]
                for name in self.quantities
            ],
            axis=1,
        ).astype(np.float32)

    def repeated(self, of_each: Real) -> list[float]:
        """Values of shape (interface, frequency), one for each number of the vector."""
        return len(self.quantities) * of_each[self.read].tolist()


def reading_vector(sweeps: xr.Dataset) -> ReadingVector:
    """The vector of the sweeps' quantities."""
    return ReadingVector(
        kind_of(sweeps).names,
        tuple(map(str, sweeps["interface"].values)),
        tuple(sweeps["frequency"].values.tolist()),
        read_mask(sweeps),
    )


def _scale(quantity: str) -> tuple[str, float]:
    unit = DESCRIBED[quantity].units
    return SCALED.get(unit, (unit, 1.0))


def quantities(sweeps: xr.Dataset) -> Mapping[str, NDArray[np.floating]]:
    """The quantities of sweeps by name, shape (sweep, interface, frequency)."""
    return {name: sweeps[name].transpose(*DIMENSIONS).values for name in kind_of(sweeps).names}
