"""The skin of a scene on a uniform lattice: its area, its conductances, and the law of its foam."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.sparse.csgraph import connected_components

from ...arrays import Integer, Real
from ...scene.foam import Foam
from ...scene.foam_mechanics import Mechanics
from ...scene.parts import Skin
from ...scene.skin_region import covers
from .foam_law import FoamTables, foam_tables
from .relaxation_kernel import Bodies, Nodes

FINE, OF_TOUCH = 4, 16
"""Minimum number of steps per length of the skins' spread, and along the smallest applicator."""
MAX_NODES_ALONG = 800
SAMPLES = 8
"""Samples along each side of a node's area where an edge of the skin passes."""
PROFILE = 2048
Window = tuple[slice, slice]
"""Rows and columns of cells."""
FOLLOWED = 3e-4
"""Smallest deflection that is followed, over an applicator's depth."""


@dataclass(frozen=True)
class Lattice:
    """Nodes in the middles of equal areas, and the conductances between them.

    law: of the foam; deflections stay within its largest. x, y: of nodes, m. part: share of each
    node's area that is skin, shape (row, column). right, up: conductance of a node to the next
    along x and y, over the tension. within: nodes along x and y in each cell of the grid of
    factors. distance, w: profile of the deflection next to a straight edge, m, beginning where
    cells are closed.
    """

    foam: Foam
    law: FoamTables
    x: Real
    y: Real
    part: Real
    right: Real
    up: Real
    within: tuple[int, int]
    distance: Real
    w: Real

    @property
    def grid(self) -> tuple[int, int]:
        """Rows and columns of cells."""
        return len(self.y) // self.within[1], len(self.x) // self.within[0]

    @property
    def steps(self) -> tuple[float, float]:
        """Distance between nodes along x and y, m."""
        return 2 * float(self.x[0]), 2 * float(self.y[0])

    @property
    def mechanics(self) -> Mechanics:
        """Mechanics of the foam."""
        assert self.foam.mechanics is not None
        return self.foam.mechanics

    def rises(self, w: Real) -> Real:
        """Rise of c at deflections in m, shape (...)."""
        return self.foam.factor_at(w / self.law.thickness) - 1

    def in_cells(self, rise: Real, here: Window) -> Real:
        """Mean of nodal values over the skin in each cell of a window, shape (row, column)."""
        part = self.part[self.nodes(here)]
        area, total = self.summed(part), self.summed(part * rise)
        return np.divide(total, area, out=np.zeros_like(total), where=area > 0)

    def summed(self, values: Real) -> Real:
        """Sum over the nodes of each cell."""
        (along, across), (rows, columns) = self.within, values.shape
        return values.reshape(rows // across, across, columns // along, along).sum(axis=(1, 3))

    def window(self, bodies: Bodies) -> Window:
        """Cells that any of the bodies influences."""
        far = max(self.reach(depth) for depth in bodies.depth)
        low, high = bodies.boxes[:, ::2].min(axis=0) - far, bodies.boxes[:, 1::2].max(axis=0) + far
        size = np.multiply(self.steps, self.within)
        first = np.floor(low / size).astype(int).clip(0)
        last = np.minimum(np.ceil(high / size).astype(int), self.grid[::-1])
        return slice(first[1], last[1]), slice(first[0], last[0])

    def groups(self, bodies: Bodies, reach: float | None = None) -> list[Integer]:
        """Numbers of the bodies of each group that may influence each other.

        reach: distance of that influence, m; by default that of each body's depth.
        """
        far = [self.reach(depth) if reach is None else reach for depth in bodies.depth]
        low = bodies.boxes[:, ::2] - np.array(far)[:, None]
        high = bodies.boxes[:, 1::2] + np.array(far)[:, None]
        meet = np.all((low[:, None] < high) & (low < high[:, None]), axis=-1)
        _, group = connected_components(meet)
        return [np.flatnonzero(group == number) for number in range(max(group, default=-1) + 1)]

    def nodes_of(self, here: Window) -> Nodes:
        """Nodes of a window, as kernels take and change them."""
        rows, columns = own = self.nodes(here)
        tension = self.mechanics.tension
        load = math.prod(self.steps) / tension * self.part[own]
        right, up = self.right[own].copy(), self.up[own].copy()
        return Nodes(self.x[columns], self.y[rows], right, up, load, self.steps, tension)

    def nodes(self, here: Window) -> tuple[slice, slice]:
        """Rows and columns of nodes in those of cells."""
        rows, columns = (
            slice(cells.start * within, cells.stop * within)
            for cells, within in zip(here, self.within[::-1], strict=True)
        )
        return rows, columns

    def edge_profile(self, depth: float, away: Real) -> Real:
        """Deflection at a distance from the straight edge of an applicator of a depth, all in m."""
        return np.interp(self._where(depth) + away, self.distance, self.w)

    def reach(self, depth: float) -> float:
        """Distance at which the straight edge of an applicator of a depth has no more influence,
        m."""
        return self._where(FOLLOWED * depth) - self._where(depth)

    def falls_within(self, depth: float) -> float:
        """Distance over which a deflection falls from a depth to a tenth of it, m."""
        return self._where(depth / 10) - self._where(depth)

    def _where(self, w: float) -> float:
        return float(np.interp(-w, -self.w, self.distance))


def lattice_of(skin: Skin, grid: tuple[int, int], smallest: float) -> Lattice:
    """Lattice of a scene whose foam has mechanics and whose skins have a tension.

    grid: rows and columns of cells for factors. smallest: side of the smallest applicator, m.
    """
    return _lattice_of(skin, grid, smallest)  # pyright: ignore[reportArgumentType]


@lru_cache(maxsize=8)
def _lattice_of(skin: Skin, grid: tuple[int, int], smallest: float) -> Lattice:
    mechanics, thickness = skin.foam.mechanics, skin.foam.thickness
    assert mechanics is not None and thickness is not None
    coarsest = min(mechanics.spread(thickness) / FINE, smallest / OF_TOUCH)
    (length, width), (rows, columns) = skin.sides, grid
    along, across = (
        max(1, min(math.ceil(side / cells / coarsest), MAX_NODES_ALONG // cells))
        for side, cells in ((length, columns), (width, rows))
    )
    step_x, step_y = length / columns / along, width / rows / across
    x, y = _nodes(columns * along, step_x), _nodes(rows * across, step_y)
    part, right, up = _skin_shares(skin, x, y)
    distance, w = _profile(mechanics, thickness)
    ratio = step_y / step_x
    shares = part, right * ratio, up / ratio
    law = foam_tables(skin.foam)
    return Lattice(skin.foam, law, x, y, *shares, (along, across), distance, w)


def _nodes(count: int, step: float) -> Real:
    return (np.arange(count, dtype=np.float64) + 0.5) * step


def _profile(mechanics: Mechanics, thickness: float) -> tuple[Real, Real]:
    """Distance from where cells are closed, and the deflection there, both m.

    Next to a straight edge T w'² / 2 = d W(w / d), with W the foam's energy per volume.
    """
    strain = mechanics.elastic.greatest_strain * np.geomspace(1.0, FOLLOWED**2, PROFILE)
    slope = np.sqrt(2 * thickness * mechanics.elastic.energy(strain) / mechanics.tension)
    falls = -np.diff(strain * thickness) * (1 / slope[1:] + 1 / slope[:-1]) / 2
    return np.concatenate([[0.0], np.cumsum(falls)]), strain * thickness


def _skin_shares(skin: Skin, x: Real, y: Real) -> tuple[Real, ...]:
    """Share of each node's area that is skin, and of each edge to the next node along x and y."""
    shape = len(y), len(x)
    if skin.rectangular:
        part, right, up = (np.ones(shape) for _ in range(3))
    else:
        part, right, up = _cut(skin, x, y)
    right[:, -1], up[-1] = 0.0, 0.0
    return part, right, up


def _cut(skin: Skin, x: Real, y: Real) -> tuple[Real, ...]:
    """Shares as in `_skin_shares` for a skin of any outline, from samples near its edges."""
    skin, (step_x, step_y) = skin, (x[1] - x[0], y[1] - y[0])
    middle = covers(skin, np.stack(np.broadcast_arrays(x, y[:, None])))
    around = np.pad(middle, 1, mode="edge")
    views = [around[i : i + len(y), j : j + len(x)] for i in range(3) for j in range(3)]
    row, column = np.nonzero(np.logical_or.reduce(views) & ~np.logical_and.reduce(views))
    part, right, up = (middle.astype(np.float64) for _ in range(3))
    off, half = (np.arange(SAMPLES) + 0.5) / SAMPLES - 0.5, np.full(SAMPLES, 0.5)

    def share(along: Real, across: Real) -> Real:
        at_x = x[column][:, None] + step_x * along
        at_y = y[row][:, None] + step_y * across
        return covers(skin, np.stack([at_x, at_y])).mean(axis=1)

    part[row, column] = share(np.tile(off, SAMPLES), np.repeat(off, SAMPLES))
    right[row, column], up[row, column] = share(half, off), share(off, half)
    right[:, :-1] *= (part[:, 1:] > 0) & (part[:, :-1] > 0)
    up[:-1] *= (part[1:] > 0) & (part[:-1] > 0)
    return part, right, up
