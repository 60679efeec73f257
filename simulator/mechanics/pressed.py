"""What depth or force of a press does to the skin: deflection, strain, and factor on c."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from simulator.foam_properties import Mechanics
from simulator.planar import Circle
from simulator.press import Press


@dataclass(frozen=True)
class Pressed:
    """The skin under the touches of a press that have a depth or a force.

    What touches of a given factor add is not in it: they multiply it. thickness: of the foam, m.
    w: deflection in m at flat positions (2, ...) in m. depth [m], force [N]: of each applicator, in
    order. error: bound on the relative error of `factor` anywhere. kinks: circles and closed
    polylines (point, 2) in m, the edges of applicators, across which `factor` has a kink, or jumps
    where nothing is spread. sharp: there the same press with factors instead, unless applicators
    overlap, else None. out_of_round: relative error of Rs and Cp by applicators that are polygons
    in place of discs. unsure: by how much w may be off, m, as w. closer: the same press within
    another `error`.
    """

    mechanics: Mechanics | None
    thickness: float
    w: Callable[[NDArray[np.float64]], NDArray[np.float64]]
    depth: tuple[float, ...]
    force: tuple[float, ...]
    error: float
    kinks: tuple[Circle | NDArray[np.float64], ...]
    sharp: Press | None
    out_of_round: float = 0.0
    unsure: Callable[[NDArray[np.float64]], NDArray[np.float64]] | None = None
    closer: Callable[[float], Pressed] | None = None

    def deflection(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Of the upper electrode towards the lower at flat positions x (2, ...) in m; m, (...)."""
        return np.clip(self.w(x), 0.0, max(self.depth, default=0.0))

    def deeper(self, times: float) -> Pressed:
        """With the deflection larger by so many times what it may be off by."""
        w, unsure = self.w, self.unsure
        if unsure is None:
            return self
        return replace(self, w=lambda x: w(x) + times * unsure(x))

    def strain(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Compressive strain of the foam at flat positions x (2, ...) in m, shape (...)."""
        return self.deflection(x) / self.thickness

    def factor(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Capacitance over that at rest at flat positions x (2, ...) in m, shape (...)."""
        strain = self.strain(x)
        return np.ones_like(strain) if self.mechanics is None else self.mechanics.factor(strain)
