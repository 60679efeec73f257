"""Touches of a given size rasterized on the cells of a grid, with their derivatives.

Touches by factors end at their edges and cover part of each cell. Touches by depth are spread by
the tension of the sheets: the rise of a cell is the mean over its skin, from the deflection on a
uniform lattice; see `models.mechanics.lattice_presses`. Their strength is the rise under them.

A shift of a touch raises c at some nodes of the lattice and lowers it at others, partly within one
cell. The derivative at a node is distributed to the cells around it as if potentials were linear
between their middles. With the mean of each cell alone, slopes by position would be wrong by a
tenth or more where a touch is a few cells wide.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..arrays import Real
from ..models.mechanics.deformation import check_plane
from ..models.mechanics.lattice_presses import STILL, deflected
from ..models.mechanics.relaxation_kernel import Bodies
from ..models.mechanics.skin_lattice import Lattice, Window, lattice_of
from ..models.reduced.touches import scene_spreads_presses
from ..press.batch import TouchedCells
from ..press.cell_kernel import covered_with_slopes
from ..press.pixels import GridCells
from ..press.touch import Rectangle
from ..scene.parts import Pressing, Skin

Point = tuple[float, float]
RISE_SPREAD = 0.2
"""Largest relative deviation of the rise of a random touch."""


class TouchSize(NamedTuple):
    """Rectangular touch: sides along x and y in m, and rise of c.

    finger: capacitance to earth, F, uniform over the touch; 0 for a rod.
    """

    width: float
    height: float
    rise: float
    finger: float = 0.0


class RasterizedTouch(NamedTuple):
    """Map of a touch and its derivatives.

    factors: c over the unpressed c. changes: derivatives by x and y [1/m] and by the rise
    ("strength"). Each has shape (row, column). For a finger each has shape (2, row, column), c and
    then the F in each cell, and there is also the derivative by its capacitance ("finger", 1/F).
    """

    factors: Real
    changes: dict[str, Real]


@dataclass(frozen=True)
class AreaRasterizer:
    """Touches that end at their edges, rasterized by the area of each cell that they cover."""

    cells: GridCells

    @classmethod
    def of(cls, skin: Skin, grid: tuple[int, int]) -> AreaRasterizer:
        """Rasterizer on a grid of rows and columns over a skin."""
        return cls(GridCells.of(skin, grid))

    def raised(self, place: Point, touch: TouchSize) -> dict[str, Real]:
        """Derivatives of c over the unpressed c by x, y [1/m] and rise, shape (row, column)."""
        box = Rectangle(*place, touch.width, touch.height, 1.0).box
        covered, by_x, by_y = covered_with_slopes(box, 0.0, self.cells)
        return {"x": touch.rise * by_x, "y": touch.rise * by_y, "strength": covered}

    def drawn(self, touch: TouchSize, random: np.random.Generator) -> TouchedCells:
        """A touch at a random position with a rise within RISE_SPREAD, to train a model."""
        sides = (self.cells.x[-1], touch.width), (self.cells.y[-1], touch.height)
        x, y = (own / 2 + random.uniform(0, side - own) for side, own in sides)
        rise = touch.rise * random.uniform(1 - RISE_SPREAD, 1 + RISE_SPREAD)
        rises = (rise * self.raised((x, y), touch)["strength"]).ravel()
        cells = np.flatnonzero(rises)
        return TouchedCells(cells, rises[cells])

    def rasterized(self, place: Point, touch: TouchSize) -> RasterizedTouch:
        """Map of a touch around a point, m."""
        changes = self.raised(place, touch)
        return RasterizedTouch(1 + touch.rise * changes["strength"], changes)

    def with_finger(
        self, rasterized: RasterizedTouch, place: Point, touch: TouchSize
    ) -> RasterizedTouch:
        """The map with the touch's finger added; unchanged for a rod."""
        if not touch.finger:
            return rasterized
        areas = np.multiply.outer(np.diff(self.cells.y), np.diff(self.cells.x))
        own = self.raised(place, touch._replace(rise=touch.finger))
        fingers = {name: own[name] * areas / (touch.width * touch.height) for name in own}
        none = np.zeros_like(rasterized.factors)
        changes = {
            name: np.stack([change, none if name == "strength" else fingers[name]])
            for name, change in rasterized.changes.items()
        }
        changes["finger"] = np.stack([none, fingers["strength"]])
        return RasterizedTouch(
            np.stack([rasterized.factors, touch.finger * fingers["strength"]]), changes
        )


DEFLECTION_RTOL = 1e-7
"""Tolerance of the deflection over the depth, where presses are subtracted."""
RISE_STEP = 0.01
"""Relative step of the rise for the difference by strength."""
SAME = 1e-6
"""Smallest distinct difference of positions, in steps. Applicators are wider by this, so that
rounding does not decide whether nodes on an edge are inside."""


class DepthRasterizer:
    """Rectangular touches of one size at any position on a scene.

    Differences by position are over one step of the lattice, which keeps the position of a touch
    relative to the nodes.
    """

    def __init__(self, skin: Skin, grid: tuple[int, int], sides: tuple[float, float]) -> None:
        """sides: of a touch along x and y, m. Raises InputError where the skin is not plane."""
        check_plane(skin)
        self._skin, self._sides = skin, sides
        self.lattice: Lattice = lattice_of(skin, grid, min(sides))
        self._cache: dict[tuple[object, ...], Real] = {}

    def rasterized(self, place: Point, touch: TouchSize) -> RasterizedTouch:
        """Map of a touch around a point, m.

        Raises InputError where the foam cannot be pressed so far, and ToleranceError where the
        deflection does not converge.
        """
        (x, y), rise = place, touch.rise
        step_x, step_y = self.lattice.steps
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
    return AreaRasterizer.of(skin, grid)


def distributed_to_cells(lattice: Lattice, values: Real, here: Window) -> Real:
    """Cell values in a window that weight linear functions as the nodes do.

    A function that is linear between the middles of cells has the same weighted sum with the cell
    values as with the node values. A node next to a cell without skin contributes to its own cell
    only, as in `Lattice.in_cells`.
    """
    (along, across), (rows, columns) = lattice.within, here
    by_x = _weights(columns.stop - columns.start, along)
    by_y = _weights(rows.stop - rows.start, across)
    part = lattice.part[lattice.nodes(here)]
    skin = lattice.in_cells(np.ones_like(part), here)
    amid = np.isclose(by_y @ skin @ by_x.T, 1.0)
    area = lattice.summed(part)
    total = by_y.T @ (part * np.where(amid, values, 0.0)) @ by_x
    shared = np.divide(total, area, out=np.zeros_like(total), where=area > 0)
    return shared + lattice.in_cells(np.where(amid, 0.0, values), here)


def _weights(cells: int, within: int) -> Real:
    """Weights of linear interpolation from the cells' middles to each node, shape (node, cell).

    They extrapolate beyond the first and the last middle.
    """
    if cells == 1:
        return np.ones((within, 1))
    at = (np.arange(cells * within) + 0.5) / within - 0.5
    first = np.clip(np.floor(at).astype(np.int64), 0, cells - 2)
    found = np.zeros((len(at), cells))
    node = np.arange(len(at))
    found[node, first], found[node, first + 1] = first + 1 - at, at - first
    return found
