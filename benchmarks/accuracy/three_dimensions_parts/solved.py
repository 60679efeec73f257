"""What a static solve found, kept in a file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .layers import EPS0
from .lines import Array
from .sheets import Axis, Sheet


@dataclass(frozen=True)
class Solved:
    """Charges C of both sheets by their potentials, F, shape (2 node, 2 node), the top sheet first.

    thickness in m and relative permittivity of the foam at rest; sheet: the nodes.
    """

    sheet: Sheet
    thickness: float
    permittivity: float
    charges: Array

    @property
    def per_area(self) -> float:
        """Capacitance of the foam between sheets far from the edges, F/m²."""
        return EPS0 * self.permittivity / self.thickness

    def save(self, path: Path) -> None:
        """Into a file of NumPy's arrays (.npz)."""
        x, y = self.sheet.x, self.sheet.y
        foam = np.array([self.thickness, self.permittivity, x.order])
        np.savez(path, x=x.cells, y=y.cells, foam=foam, charges=self.charges)

    @staticmethod
    def load(path: Path) -> Solved:
        """As it was saved."""
        with np.load(path, allow_pickle=False) as kept:
            thickness, permittivity, order = kept["foam"]
            axes = (Axis(kept[name], int(order)) for name in "xy")
            return Solved(Sheet(*axes), float(thickness), float(permittivity), kept["charges"])
