"""Panels of the foam and its two sheets, narrower at edges, where charge is dense."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from ..arrays import Mask, Real
from ..mesh.arcs import edges_of
from ..mesh.domain import Domain
from ..mesh.refinement import refined
from ..mesh.skin_mesh import domain
from ..press.press import Press
from ..scene.foam import VACUUM_PERMITTIVITY, Foam
from ..scene.parts import Skin
from ..scene.skin import Sheet
from ..sweeps import InputError

PANELS = (6, 10)
"""Panels from the edge of a rectangle to its middle, of a coarse and of a fine block."""
LAYERS = (2, 4)
"""Layers of triangles at an outline, coarse and fine."""
MAX_EDGE, MIN_EDGE_COUNT = 2.0, 100
"""Longest edge along outlines over the foam's thickness, and count of such edges.

Edges may be longer than that, up to the length of all outlines over the count.
"""
ACROSS = 4
"""Minimum count of triangles across the shorter side of a skin away from its outline."""
SLICES = 3
PAIRS = [0, 1], [1, 2], [2, 0]
PLACEHOLDER_SHEET = Sheet(sheet_resistance=1.0)


@dataclass(frozen=True)
class Shape:
    """Geometry of a block: sides in m as the skin is stretched, foam, and outline.

    drawn: skin of the same outline or mesh, before it is stretched by `ratios`; its sheets and
    foam do not count. It is None for a rectangle.
    """

    length: float
    width: float
    thickness: float
    permittivity: float
    ratios: tuple[float, float] = (1.0, 1.0)
    drawn: Skin | None = None


def shape_of(skin: Skin, key: str) -> Shape:
    """Shape of a scene's skin.

    key: the key that needs it. Raises InputError for a mesh that is not flat.
    """
    foam = skin.foam
    thickness = foam.thickness_or_assumed
    if skin.mesh is not None and len(skin.mesh.surface.p) == 3:
        raise InputError(f"{skin.name}: `{key}` needs a flat skin; `skin.mesh` lies in space")
    permittivity = foam.unpressed_capacitance_per_area * thickness / VACUUM_PERMITTIVITY
    ratios, thinner = (1.0, 1.0), 1.0
    if skin.stretch is not None:
        ratios, power = skin.stretch.ratios, skin.stretch.thinning[1]
        thinner = (ratios[0] * ratios[1]) ** power
    drawn = None if skin.rectangular else _outlined(skin)
    return Shape(*skin.stretched_sides, thickness / thinner, permittivity, ratios, drawn)


def blocks(shape: Shape) -> list[tuple[PanelBlock, float]]:
    """Coarse and fine block, each with the size of its panels, in any unit."""
    if shape.drawn is None:
        sides = shape.length, shape.width, shape.thickness
        return [(quarter(*sides, count), 1 / count) for count in PANELS]
    size = min(shape.drawn.sides) / ACROSS
    mesh = domain(shape.drawn, Press(), size, between=False)
    return [(_of_triangles(mesh, shape, layers), 1 / layers) for layers in LAYERS]


def _outlined(skin: Skin) -> Skin:
    """Skin of the same outline with other sheets and foam.

    All skins with one outline then share their blocks.
    """
    return replace(
        skin,
        name="",
        top=PLACEHOLDER_SHEET,
        bottom=PLACEHOLDER_SHEET,
        foam=Foam(thickness=1e-3, relative_permittivity=1.0),
        stretch=None,
        around=None,
    )


def _of_triangles(mesh: Domain, shape: Shape, layers: int) -> PanelBlock:
    """Block of a mesh, refined as MAX_EDGE requires. layers: as for `layered`."""
    scale = np.array(shape.ratios)[:, None]
    longest = MAX_EDGE * shape.thickness
    while True:
        p = mesh.p * scale
        edges, of_triangle = edges_of(mesh.t)
        outer = np.bincount(of_triangle.ravel()) == 1
        lengths = outer * np.linalg.norm(p[:, edges[1]] - p[:, edges[0]], axis=0)
        coarse = (lengths > max(longest, lengths.sum() / MIN_EDGE_COUNT))[of_triangle].any(axis=0)
        if not coarse.any():
            break
        mesh = refined(mesh, np.flatnonzero(coarse))
    rim = np.zeros(p.shape[1], dtype=bool)
    rim[edges[:, outer]] = True
    panels = layered(p[:, mesh.t].transpose(2, 1, 0), rim[mesh.t].T, layers)
    return PanelBlock(panels, _around(mesh, p), shape.thickness, SLICES)


def _around(mesh: Domain, p: Points) -> Points:
    """Edges of exactly one triangle, anticlockwise around the skin, (edge, end, 2).

    They are in m.
    """
    edges, of_triangle = edges_of(mesh.t)
    outer = np.bincount(of_triangle.ravel()) == 1
    side, triangle = np.nonzero(outer[of_triangle])
    ends = p[:, edges[:, of_triangle[side, triangle]]].transpose(2, 1, 0)
    across = p[:, mesh.t[:, triangle]].mean(axis=1).T - ends[:, 0]
    along = ends[:, 1] - ends[:, 0]
    right = along[:, 0] * across[:, 1] - along[:, 1] * across[:, 0] < 0
    ends[right] = ends[right, ::-1]
    return ends


def layered(triangles: Points, rim: Mask, layers: int) -> Points:
    """Panels of triangles, those at an outline cut along it, shape (panel, 4, 2).

    They become thinner towards the outline. triangles: m, shape (triangle, 3, 2). rim: True for
    their corners on the outline, shape (triangle, 3). Cuts are where a function that is linear in
    each triangle, 0 on the outline and 1 at all other corners, has the squares of n / layers. A
    triangle with all corners on the outline is cut in three first.
    """
    triangles, rim = _cut_in_three(triangles, rim)
    count = rim.sum(axis=1)
    inner = triangles[count == 0]
    found = [inner[:, [0, 1, 2, 2]]]
    levels = np.linspace(0, 1, layers + 1) ** 2
    for number, start, stop in ((1, (0, 0), (1, 2)), (2, (0, 1), (2, 2))):
        own = count == number
        turned = np.argsort(~rim[own], axis=1, kind="stable")
        corners = np.take_along_axis(triangles[own], turned[..., None], axis=1)
        low, high = corners[:, start], corners[:, stop]
        for at, to in pairwise(levels):
            one, other = (low + level * (high - low) for level in (at, to))
            found.append(np.stack([one[:, 0], one[:, 1], other[:, 1], other[:, 0]], axis=1))
    return np.concatenate(found)


def _cut_in_three(triangles: Points, rim: Mask) -> tuple[Points, Mask]:
    """Triangles, those with all corners on an outline cut in three about their middle.

    Also returns which corners of each are on the outline.
    """
    whole = rim.all(axis=1)
    middle = triangles[whole].mean(axis=1)
    thirds = [
        np.stack([*triangles[whole][:, pair].swapaxes(0, 1), middle], axis=1) for pair in PAIRS
    ]
    on = np.tile([True, True, False], (3 * len(middle), 1))
    return np.concatenate([triangles[~whole], *thirds]), np.concatenate([rim[~whole], on])


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
