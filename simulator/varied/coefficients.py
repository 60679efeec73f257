"""What a pressed skin is made of at the points of one mesh: conductance of sheets, capacitance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from simulator.materials import Materials, strain_of
from simulator.scene import Electrode

if TYPE_CHECKING:
    from simulator.mechanics import Pressed

ELECTRODES: tuple[Electrode, Electrode] = ("top", "bottom")


@dataclass(frozen=True)
class Coefficients:
    """Of one press on one mesh; x stands for points of all its cells, m, shape (2, cell, point).

    factors: c over that at rest by touches with sharp edges, shape (cell,). pressed: by what
    mechanics spreads, None for nothing of that kind. fields: 1 where both sheets are one.
    """

    materials: Materials
    factors: NDArray[np.float64]
    pressed: Pressed | None
    fields: int

    def conductance(self, field: int, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """S in S by its xx, yy and xy, shape (3, cell, point)."""
        S = self.conductance_of(ELECTRODES[field], x)
        return S * self._share if self.fields == 1 else S

    def conductance_of(self, electrode: Electrode, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """The same of one sheet."""
        return self.materials.conductance(electrode, x, self.strain(x))

    def of_both_sheets(self, potential: NDArray) -> NDArray:
        """Top and bottom sheet's from those of the fields, shape (field, ...) to (2, ...).

        The difference of both falls to each sheet as its resistance is of both in series.
        """
        if self.fields == 2:
            return potential
        return np.concatenate([self._share * potential, (self._share - 1) * potential])

    def capacitance(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """c in F/m², shape (cell, point)."""
        return self.materials.capacitance(x) * self.factor(x)

    def factor(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """c over that at rest, shape (cell, point)."""
        spread = self.pressed.factor(x) if self.pressed else np.ones(x.shape[1:])
        return self.factors[:, None] * spread

    def strain(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """How far the foam is compressed, of its thickness at rest, shape (cell, point).

        Where only a factor is given it is what would bring it about at constant permittivity.
        """
        sharp = strain_of(self.factors)[:, None]
        spread = self.pressed.strain(x) if self.pressed else np.zeros(x.shape[1:])
        return np.maximum(sharp, spread)

    def deflection(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """How far the skin is pushed in where mechanics tells, m, shape (cell, point)."""
        return self.pressed.deflection(x) if self.pressed else np.zeros(x.shape[1:])

    def line_stretch(
        self, x: NDArray[np.float64], direction: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Length along an edge over that of the flat skin at rest."""
        return self.materials.line_stretch(x, direction)

    @property
    def _share(self) -> float:
        """Of the top sheet's conductance, of both in series: the sheets vary alike."""
        corner = np.zeros((2, 1))
        top, bottom = (self.materials.conductance(each, corner)[0, 0] for each in ELECTRODES)
        return float(bottom / (top + bottom))
