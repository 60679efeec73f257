"""Panels of the foam and its two sheets, narrower at edges, where charge is dense."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from ..arrays import Real

Points = Real
SIGNS = 1.0, -1.0
ITSELF = np.array([[1.0, 1.0, 0.0, 0.0]])


@dataclass(frozen=True)
class PanelBlock:
    """Panels of both sheets and of the foam's side faces; the bottom sheet is at z = 0.

    panels: those of either sheet, in the plane, m, shape (panel, 4, 2); a triangle has one corner
    twice. edges: those of the outline and of holes, anticlockwise around the foam, m, shape (edge,
    end, 2). thickness: of the foam, m. slices: number of panels of the side faces from each sheet
    to the middle between them. mirrors: signs and shifts in m, of x and of y, of the symmetric
    parts that the foam consists of, shape (part, 4).
    """

    panels: Points
    edges: Points
    thickness: float
    slices: int
    mirrors: Points = field(default_factory=lambda: ITSELF)

    @property
    def perimeter(self) -> float:
        """Length of all edges of the foam, m."""
        own = np.linalg.norm(self.edges[:, 1] - self.edges[:, 0], axis=-1).sum()
        return len(self.mirrors) * float(own)

    @property
    def area(self) -> float:
        """Area of a whole sheet, m²."""
        return len(self.mirrors) * float(self.areas[: len(self.panels)].sum())

    @property
    def size(self) -> float:
        """Diagonal of the box around a whole sheet, m."""
        sx, sy, dx, dy = self.mirrors.T[:, :, None]
        x, y = self.panels[..., 0].ravel(), self.panels[..., 1].ravel()
        return float(np.hypot(np.ptp(sx * x + dx), np.ptp(sy * y + dy)))

    @cached_property
    def corners(self) -> Points:
        """Corners of the panels of bottom sheet, top sheet and side faces, (panel, 4, 3).

        They are in m. On side faces they run anticlockwise as seen from outside.
        """
        return np.concatenate([self._sheet(0.0), self._sheet(self.thickness), self._sides])

    @cached_property
    def areas(self) -> Real:
        """Areas of all panels, m², shape (panel,)."""
        return self._halves[0].sum(axis=0)

    @property
    def points(self) -> Points:
        """Centroids of all panels, m, shape (panel, 3)."""
        areas, middles = self._halves
        return (areas[..., None] * middles).sum(axis=0) / self.areas[:, None]

    @property
    def moments(self) -> Real:
        """Integrals of products of distances from the centroids, m⁴, shape (panel, 3, 3)."""
        a, b, c, d = np.moveaxis(self.corners, 1, 0)
        sides = np.array([[a + b, b + c, c + a], [a + c, c + d, d + a]]) / 2 - self.points
        weights = self._halves[0] / 3
        return np.einsum("hp,hspi,hspj->pij", weights, sides, sides)

    @property
    def middles(self) -> Points:
        """Centroids projected along z, shape (2, panel)."""
        return self.points[:, :2].T

    @property
    def _halves(self) -> tuple[Real, Points]:
        """Areas and middles of the triangles on both sides of a diagonal.

        Shapes (2, panel) and (2, panel, 3).
        """
        a, b, c, d = np.moveaxis(self.corners, 1, 0)
        twice = [np.cross(u - a, v - a) for u, v in ((b, c), (c, d))]
        middles = np.stack([(a + b + c) / 3, (a + c + d) / 3])
        return np.linalg.norm(twice, axis=-1) / 2, middles

    @property
    def normals(self) -> Points:
        """Unit vectors out of the side faces, zero on sheets, shape (panel, 3)."""
        sides = self._sides
        along = sides[:, 1, :2] - sides[:, 0, :2]
        across = np.stack([along[:, 1], -along[:, 0]], axis=1)
        found = np.zeros((2 * len(self.panels) + len(sides), 3))
        found[2 * len(self.panels) :, :2] = across / np.linalg.norm(across, axis=1)[:, None]
        return found

    def _sheet(self, height: float) -> Points:
        z = np.full((*self.panels.shape[:2], 1), height)
        return np.concatenate([self.panels, z], axis=-1)

    @property
    def _sides(self) -> Points:
        z = lines(self.thickness, self.thickness, self.slices)
        low, high = z[:-1], z[1:]
        found = np.empty((len(self.edges), len(low), 4, 3))
        found[..., :2] = self.edges[:, None, [0, 1, 1, 0]]
        found[..., 2] = np.stack([low, low, high, high], axis=-1)
        return found.reshape(-1, 4, 3)


def quarter(
    length: float, width: float, thickness: float, count: int, equidistant: float = 0.0
) -> PanelBlock:
    """Quarter of a rectangular skin, all in m, and its mirrors.

    count: panels along each side of the quarter. equidistant: as for `lines`.
    """
    x, y = (lines(side, thickness, count, equidistant)[: count + 1] for side in (length, width))
    left, bottom = (each.ravel() for each in np.meshgrid(x[:-1], y[:-1], indexing="ij"))
    right, top = (each.ravel() for each in np.meshgrid(x[1:], y[1:], indexing="ij"))
    corners = [(left, bottom), (right, bottom), (right, top), (left, top)]
    panels = np.stack([np.stack(each, axis=-1) for each in corners], axis=1)
    around = np.concatenate([np.stack([0 * y, y])[:, ::-1], np.stack([x, 0 * x])[:, 1:]], axis=1).T
    mirrors = np.array([[a, b, (a < 0) * length, (b < 0) * width] for a in SIGNS for b in SIGNS])
    slices = max(2, count // 2)
    return PanelBlock(
        panels, np.stack([around[:-1], around[1:]], axis=1), thickness, slices, mirrors
    )


def lines(side: float, thickness: float, count: int, equidistant: float = 0.0) -> Real:
    """Ends of the panels along a side, m, shape (2 * count + 1,), symmetric.

    Within the foam's thickness of an end they grow with the square of their number, to suit a
    charge proportional to one over the root of the distance, and by a constant factor beyond.
    equidistant: fraction of them that is equidistant, which bounds the width of those in the
    middle.
    """
    a = np.arcsinh(np.sqrt(side / (2 * thickness)))
    number = np.linspace(0, 1, 50 * count + 1)
    along = (np.sinh(a * number) / np.sinh(a)) ** 2
    both = (1 - equidistant) * number + equidistant * along
    half = side / 2 * np.interp(np.linspace(0, 1, count + 1), both, along)
    return np.concatenate([half, (side - half)[-2::-1]])
