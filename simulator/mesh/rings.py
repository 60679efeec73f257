"""Cells around a singular point: rings that shrink towards it by a constant ratio.

A square cell with a corner at the point becomes a small square there and, around it, layers of two
trapezoids each. All layers have the same shape, and nothing outside the cell changes. Cells stay as
wide as they are high, however small, and each layer costs only a few unknowns.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Integer, Real

RATIO = 0.2
PARTNER_ALONG = (1, 0, 3, 2)
PARTNER_ACROSS = (3, 2, 1, 0)


@dataclass(frozen=True)
class QuadrilateralCells:
    """Quadrilaterals x0 + a along + b across + a b twist, a and b in [0, 1].

    p: points in m, shape (2, point). t: the points of each cell, at (a, b) = (0, 0), (1, 0), (1, 1)
    and (0, 1), shape (4, cell). along, across, twist: m, shape (2, cell); they keep the shape of a
    cell that is too small for its points to resolve. Cells that share an edge run along it in the
    same direction.
    """

    p: Real
    t: Integer
    along: Real
    across: Real
    twist: Real

    def some(self, which: Integer | slice) -> QuadrilateralCells:
        """Some of the cells, on the same points."""
        along, across, twist = (v[:, which] for v in (self.along, self.across, self.twist))
        return QuadrilateralCells(self.p, self.t[:, which], along, across, twist)


def rectangles(x: Real, y: Real) -> QuadrilateralCells:
    """Cells between lines, row after row. x, y: ascending, m."""
    rows, columns = len(y) - 1, len(x) - 1
    low = (np.arange(rows)[:, None] * len(x) + np.arange(columns)).ravel()
    along, across = np.zeros((2, 2, rows * columns))
    along[1], across[0] = np.repeat(np.diff(y), columns), np.tile(np.diff(x), rows)
    return QuadrilateralCells(
        p=np.stack([np.tile(x, len(y)), np.repeat(y, len(x))]),
        t=np.stack([low, low + len(x), low + len(x) + 1, low + 1]),
        along=along,
        across=across,
        twist=np.zeros((2, rows * columns)),
    )


def ringed(cells: QuadrilateralCells, tips: Integer, layers: ArrayLike) -> QuadrilateralCells:
    """Rectangles, divided into rings where a corner is one of the points `tips`.

    layers: number of rings, one for all tips or one for each.
    """
    around = np.broadcast_to(layers, tips.shape)
    tips, around = tips[around > 0], around[around > 0]
    if not tips.size:
        return cells
    cornered = [(k, cell) for k in range(4) for cell in np.flatnonzero(np.isin(cells.t[k], tips))]
    scales = {int(tip): RATIO ** np.arange(n + 1.0) for tip, n in zip(tips, around, strict=True)}
    builder = _Builder(cells, scales)
    for corner, cell in cornered:
        builder.divide(int(cell), corner)
    return builder.built(np.array([cell for _, cell in cornered]))


class _Builder:
    def __init__(self, cells: QuadrilateralCells, scales: dict[int, Real]) -> None:
        """Starts with undivided cells.

        scales: sizes of the rings around each tip, the outermost 1.
        """
        self.cells, self.scales = cells, scales
        self.points = [cells.p]
        self.count = cells.p.shape[1]
        self.parts: list[tuple[NDArray, NDArray, NDArray, NDArray]] = []
        self._chains: dict[tuple[int, int], Integer] = {}

    def divide(self, cell: int, corner: int) -> None:
        cells, t = self.cells, self.cells.t[:, cell]
        tip, a, b = t[corner], t[PARTNER_ALONG[corner]], t[PARTNER_ACROSS[corner]]
        scale = self.scales[int(tip)]
        opposite = t[PARTNER_ALONG[PARTNER_ACROSS[corner]]]
        away_a = cells.along[:, cell] * (1 if corner in (0, 3) else -1)
        away_b = cells.across[:, cell] * (1 if corner in (0, 1) else -1)
        chain_a, chain_b, diagonal = (self._chain(int(tip), int(p)) for p in (a, b, opposite))
        self._trapezoids(scale, chain_a, diagonal, away_a, away_b)
        self._trapezoids(scale, chain_b, diagonal, away_b, away_a)
        inner = np.empty((4, 1), dtype=np.int64)
        inner[corner], inner[PARTNER_ALONG[corner]] = tip, chain_a[-1]
        inner[PARTNER_ACROSS[corner]] = chain_b[-1]
        inner[PARTNER_ALONG[PARTNER_ACROSS[corner]]] = diagonal[-1]
        shape = (cells.along, cells.across, cells.twist)
        along, across, twist = (scale[-1] * each[:, [cell]] for each in shape)
        self.parts.append((inner, along, across, twist))

    def _trapezoids(
        self, scale: NDArray, side: NDArray, diagonal: NDArray, away: NDArray, sideways: NDArray
    ) -> None:
        """Adds the layers on one side of the diagonal: a outwards, b as x or y grows."""
        outer, inner = scale[:-1], scale[1:]
        if sideways.sum() > 0:
            first, second, start = side, diagonal, away
        else:
            first, second, start = diagonal, side, away + sideways
        step = np.abs(sideways)[:, None]
        t = np.stack([first[1:], first[:-1], second[:-1], second[1:]])
        along = start[:, None] * (outer - inner)
        self.parts.append((t, along, step * inner, step * (outer - inner)))

    def _chain(self, tip: int, towards: int) -> Integer:
        """Points from `towards`, which is the first, to the tip, which is left out."""
        if (tip, towards) not in self._chains:
            start, end = self.cells.p[:, [tip]], self.cells.p[:, [towards]]
            scale = self.scales[tip]
            new = self.count + np.arange(len(scale) - 1)
            self.points.append(start + (end - start) * scale[1:])
            self.count += len(new)
            self._chains[tip, towards] = np.concatenate([[towards], new])
        return self._chains[tip, towards]

    def built(self, divided: Integer) -> QuadrilateralCells:
        cells = self.cells
        whole = np.setdiff1d(np.arange(cells.t.shape[1]), divided)
        shapes = (cells.t, cells.along, cells.across, cells.twist)
        kept = tuple(each[:, whole] for each in shapes)
        joined = (np.concatenate(each, axis=1) for each in zip(kept, *self.parts, strict=True))
        return QuadrilateralCells(np.concatenate(self.points, axis=1), *joined)
