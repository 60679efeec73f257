"""Nodes of a window of a lattice, with arms that end at the edges of flat indenters."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...arrays import Real
from ...models.mechanics.lattice.relaxation_kernel import rasterized
from ...models.mechanics.lattice.relaxed_presses import LatticeApplicators, Window
from ...models.mechanics.lattice.skin_lattice import Lattice


class WindowNodes(NamedTuple):
    """Nodes at x and y, m, `steps` apart.

    right, up: conductance of each to the next along x and y; load: area; all over the tension.
    """

    x: Real
    y: Real
    right: Real
    up: Real
    load: Real
    steps: tuple[float, float]

    @classmethod
    def of(cls, lattice: Lattice, here: Window) -> WindowNodes:
        """Nodes of a window."""
        rows, columns = own = lattice.nodes(here)
        load = lattice.area * lattice.part[own]
        x, y = lattice.x[columns], lattice.y[rows]
        right, up = lattice.right[own].copy(), lattice.up[own].copy()  # as cut, for one kernel
        return cls(x, y, right, up, load, lattice.steps)

    def cut_at_edges(self, flat: LatticeApplicators, area: float) -> tuple[WindowNodes, float]:
        """Nodes with arms that end at the edges of flat indenters, and the share of the arms'
        halves at the edges that is foam under neither nodes nor indenters.

        area: under the indenters, over the tension.
        """
        cut = self._replace(right=self.right.copy(), up=self.up.copy(), load=self.load.copy())
        inside = rasterized(*flat, *cut[:5]) > 0
        whole = float(self.load.max())
        along, across = np.zeros(inside.shape, bool), np.zeros(inside.shape, bool)
        along[:, :-1], across[:-1] = inside[:, 1:] != inside[:, :-1], inside[1:] != inside[:-1]
        arms = sum(
            (old[at] / new[at])[old[at] > 0].sum()
            for old, new, at in zip(self[2:4], cut[2:4], (along, across), strict=True)
        )
        left = float(self.load.sum() - cut.load[~inside].sum()) - area
        return cut, min(max(left / (arms * whole / 2), 0.0), 2.0) if arms else 0.0
