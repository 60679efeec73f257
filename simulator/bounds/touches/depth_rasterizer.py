"""Touches by depth into foam whose sheets have a tension, rasterized on the cells of a grid.

The rise of a cell is the mean over its skin, from the deflection on a uniform lattice; see
`models.mechanics.lattice_presses`. The strength of a touch is the rise under it.

A shift of a touch raises c at some nodes and lowers it at others, partly within one cell. The
derivative at a node is distributed to the cells around it as if potentials were linear between
their middles. With the mean of each cell alone, slopes by position would be wrong by a tenth or
more where a touch is a few cells wide.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ...arrays import Real
from ...models.mechanics.deformation import check_plane
from ...models.mechanics.lattice_presses import STILL, deflected
from ...models.mechanics.relaxation_kernel import Bodies
from ...models.mechanics.skin_lattice import Lattice, Window, lattice_of
from ...models.reduced.indentation.indentation_draws import scene_spreads_presses
from ...scene.parts import Pressing, Skin
from .area_rasterizer import AreaRasterizer, Point, RasterizedTouch, TouchSize
from .node_sharing import distributed_to_cells

STRIDE = 1
"""Steps of the lattice for central differences by position: whole steps keep a touch's position
relative to the nodes."""
DEFLECTION_RTOL = 1e-7
"""Tolerance of the deflection over the depth, where presses are subtracted."""
RISE_STEP = 0.01
"""Relative step of the rise for the difference by strength."""
SAME = 1e-6
"""Smallest distinct difference of positions, in steps. Applicators are wider by this, so that
rounding does not decide whether nodes on an edge are inside."""


class DepthRasterizer:
    """Rectangular touches of one size at any position on a scene."""

    def __init__(
        self, skin: Skin, grid: tuple[int, int], sides: tuple[float, float], stride: int = STRIDE
    ) -> None:
        """sides: of a touch along x and y, m. stride: see STRIDE.

        Raises InputError where the skin is not plane.
        """
        check_plane(skin)
        self._skin, self._sides, self._stride = skin, sides, stride
        self.lattice: Lattice = lattice_of(skin, grid, min(sides))
        self._cache: dict[tuple[object, ...], Real] = {}

    def rasterized(self, place: Point, touch: TouchSize) -> RasterizedTouch:
        """Map of a touch around a point, m.

        Raises InputError where the foam cannot be pressed so far, and ToleranceError where the
        deflection does not converge.
        """
        (x, y), rise = place, touch.rise
        step_x, step_y = np.multiply(self._stride, self.lattice.steps).tolist()
        corners = [(x + i * step_x, y + j * step_y) for i in (-1, 1) for j in (-1, 1)]
        here = enclosing_window([self.window(corner, rise) for corner in corners])

        def found() -> Real:
            ends = rise * (1 - RISE_STEP), min(rise * (1 + RISE_STEP), self._skin.max_factor - 1)
            own = self._at_nodes(place, rise, here)
            each = [self.lattice.in_cells(own, here)]
            for by_x, by_y in ((step_x, 0.0), (0.0, step_y)):
                ahead, behind = (
                    self._at_nodes((x + side * by_x, y + side * by_y), rise, here)
                    for side in (1, -1)
                )
                slope = (ahead - behind) / (2 * (by_x + by_y))
                each.append(distributed_to_cells(self.lattice, slope, here))
            weak, strong = (self._at_nodes(place, end, here) for end in ends)
            slope = (strong - weak) / (ends[1] - ends[0])
            return np.stack([*each, self.lattice.in_cells(slope, here)])

        rises, by_x, by_y, by_strength = self._everywhere(
            self._cached("rasterized", self.applied(place, rise), here, found), here
        )
        return RasterizedTouch(1 + rises, {"x": by_x, "y": by_y, "strength": by_strength})

    def applied(self, place: Point, rise: float, beyond: float = SAME) -> Bodies:
        """The applicator under which c rises by `rise`.

        beyond: margin on each side, in steps. Raises InputError as `rasterized` does.
        """
        (x, y), steps = place, np.array(self.lattice.steps)
        wide, high = np.divide(self._sides, 2) + beyond * steps
        box = [[x - wide, x + wide, y - high, y + high]]
        return Bodies.by_depth(
            np.array(box), np.zeros(1), np.array([self._skin.pressed_depth(1 + rise)])
        )

    def window(self, place: Point, rise: float) -> Window:
        """The cells that a touch changes."""
        return self.lattice.window(self.applied(place, rise))

    def rises(self, place: Point, rise: float, here: Window) -> Real:
        """Rises of c in the cells of a window by a touch, shape (row, column)."""
        applied = self.applied(place, rise)
        if not rise:
            return np.zeros([part.stop - part.start for part in here])
        return self._cached(
            "rises",
            applied,
            here,
            lambda: self.lattice.in_cells(self._at_nodes(place, rise, here, STILL), here),
        )

    def _at_nodes(
        self, place: Point, rise: float, here: Window, still: float = DEFLECTION_RTOL
    ) -> Real:
        w, _ = deflected(self.lattice, self.applied(place, rise), here, still)
        return self.lattice.rises(w)

    def _cached(self, what: str, applied: Bodies, here: Window, found: Callable[[], Real]) -> Real:
        """Cached result of `found` for a touch in a window.

        On a rectangle, touches at the same position relative to their windows share it.
        """
        if not self._skin.rectangular:
            return found()
        rows, columns = here
        step = np.repeat(self.lattice.steps, 2)
        first = np.repeat([columns.start, rows.start], 2) * np.repeat(self.lattice.within, 2)
        position = np.rint((applied.boxes[0] / step - first) / SAME).astype(np.int64).tolist()
        sizes = rows.stop - rows.start, columns.stop - columns.start
        key = what, *position, *sizes, float(applied.depth[0])
        if key not in self._cache:
            self._cache[key] = found()
        return self._cache[key]

    def _everywhere(self, found: Real, here: Window) -> Real:
        """Values in a window placed among all cells, shape (..., row, column)."""
        every = np.zeros((*found.shape[:-2], *self.lattice.grid))
        every[..., *here] = found
        return every


def enclosing_window(windows: Sequence[Window]) -> Window:
    """The smallest window that contains all of these."""
    rows, columns = (
        slice(min(part.start for part in own), max(part.stop for part in own))
        for own in zip(*windows, strict=True)
    )
    return rows, columns


def rasterizer_for(
    skin: Skin, pressing: Pressing, grid: tuple[int, int], touch: TouchSize
) -> AreaRasterizer | DepthRasterizer:
    """Rasterizer of touches of one size on a grid of rows and columns over a scene."""
    if scene_spreads_presses(skin, pressing):
        return DepthRasterizer(skin, grid, (touch.width, touch.height))
    return AreaRasterizer.of(skin.length, skin.width, grid)
