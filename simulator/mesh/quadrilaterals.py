"""Quadrilateral meshes that conform to pixels and foil ends, finer where the field is steep.

At a singular point rings of cells shrink towards it by a constant ratio. A square cell with a
corner at the point becomes a small square there and, around it, layers of two trapezoids each. All
layers have the same shape, and nothing outside the cell changes. Cells stay as wide as they are
high, however small, and each layer costs only a few unknowns.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from skfem import MeshQuad

from ..arrays import Integer, Real
from ..press.pixels import pixel_lines
from ..scene.contacts import Contact
from ..scene.parts import Skin
from ..scene.planar import NO_LINES, SAME_LINE, Lines, distinct
from ..scene.skin import SheetsAndFoam
from ..scene.wiring_checks import ACROSS, strip, touch_at


def nodes(lines: Real, cells: int, widths: Mapping[float, float], growth: float = np.inf) -> Real:
    """Nodes on all `lines`, `cells` equal cells between them, finer where requested.

    widths: by line (given to within rounding) the largest width in m of the cells next to it; cells
    are halved towards the line until they are that narrow. growth: cells are divided until none is
    more than that many times as wide as its neighbour.
    """
    if cells == 1 and growth == np.inf and all(width == np.inf for width in widths.values()):
        return lines
    at_lines = [_narrowest(line, lines[-1], widths) for line in lines]
    pieces = [
        _halved(low, high, cells, at_low, at_high)
        for (low, high), (at_low, at_high) in zip(
            itertools.pairwise(lines), itertools.pairwise(at_lines), strict=True
        )
    ]
    return _growing(np.concatenate([lines[:1], *(piece[1:] for piece in pieces)]), growth)


def _narrowest(line: float, length: float, widths: Mapping[float, float]) -> float:
    same = [width for at, width in widths.items() if abs(at - line) <= SAME_LINE * length]
    return min(same, default=np.inf)


def _halved(low: float, high: float, cells: int, at_low: float, at_high: float) -> Real:
    width = (high - low) / cells
    both = width > at_low and width > at_high
    uniform = np.linspace(low, high, (max(cells, 2) if both else cells) + 1)
    width = uniform[1] - uniform[0]
    above_low, below_high = _steps(width, at_low), _steps(width, at_high)
    return np.concatenate(
        [uniform[:1], low + above_low, uniform[1:-1], high - below_high[::-1], uniform[-1:]]
    )


def _steps(cell: float, widest: float) -> Real:
    """Distances from the line at which a cell next to it is divided, ascending."""
    divisions = int(np.ceil(np.log2(max(1.0, cell / widest)) - SAME_LINE))
    return cell * 0.5 ** np.arange(divisions, 0.0, -1.0)


def _growing(nodes: Real, growth: float) -> Real:
    while True:
        width = np.diff(nodes)
        too_wide = growth * (1 + SAME_LINE)
        after = np.flatnonzero(width[1:] > too_wide * width[:-1]) + 1
        before = np.flatnonzero(width[:-1] > too_wide * width[1:])
        if after.size:
            cell = after[0]
            node = nodes[cell] + min(growth * width[cell - 1], width[cell] / 2)
        elif before.size:
            cell = before[0]
            node = nodes[cell + 1] - min(growth * width[cell + 1], width[cell] / 2)
        else:
            return nodes
        nodes = np.insert(nodes, cell + 1, node)


GROWTH = 4.0


@dataclass(frozen=True)
class Resolution:
    """Fineness of the elements of a sheet.

    order: polynomial order of the elements. cells: cells between neighbouring conforming lines.
    layers: rings around the ends of foils, for the square-root singularity there. edge_cell:
    largest width in m of cells next to contacted edges, for the layer of the field there.
    touch_cell: the same next to the lines `touched`, where the capacitance jumps. lines: those that
    the mesh conforms to in addition to the pixels' and the ends of foils. corners: other crossings
    of lines with rings around them: x, y in m and the number of rings.
    """

    order: int
    cells: int = 1
    layers: int = 0
    edge_cell: float = np.inf
    touch_cell: float = np.inf
    touched: Lines = NO_LINES
    lines: Lines = NO_LINES
    corners: tuple[tuple[float, float, int], ...] = ()

    def __str__(self) -> str:
        rings = f", {self.layers} rings at ends of foils" if self.layers else ""
        rings += f", rings at {len(self.corners)} corners" if self.corners else ""
        cells = f", {self.cells}x{self.cells} cells between lines" if self.cells > 1 else ""
        return f"Q{self.order}{cells}{rings}"


@dataclass(frozen=True)
class PixelMesh:
    """Mesh with the pixel of each element, or its part of one between other lines.

    pixel: row * columns + column, both from 0, of the tiles between `tile_lines`, shape (element,).
    """

    skin: SheetsAndFoam
    mesh: MeshQuad
    cells: QuadrilateralCells
    pixel: Integer

    def facets(self, contact: Contact) -> Integer:
        """Boundary facets under a foil."""
        start, stop = contact.ends(self.skin)
        along = 1 if contact.edge in ("left", "right") else 0
        boundary = self.mesh.boundary_facets()
        ends = self.mesh.p[:, np.asarray(self.mesh.facets)[:, boundary]]
        on_edge = (ends[1 - along] == start[1 - along]).all(axis=0)
        middle = ends[along].mean(axis=0)
        return boundary[on_edge & (start[along] < middle) & (middle < stop[along])]

    def edges(self, facets: Integer) -> tuple[Integer, Real]:
        """Element at each boundary facet, and which of its edges the facet is.

        Returns element, shape (facet,), and length in m at the edge and 0 at the other three, shape
        (facet, 4).
        """
        element = np.asarray(self.mesh.f2t, dtype=np.int64)[0, facets]
        is_edge = np.asarray(self.mesh.t2f)[:, element] == facets
        along, across, twist = (
            v[:, element] for v in (self.cells.along, self.cells.across, self.cells.twist)
        )
        length = np.linalg.norm([along, across + twist, along + twist, across], axis=1)
        return element, (is_edge * length).T


def pixel_mesh(skin: Skin, contacts: Sequence[Contact], resolution: Resolution) -> PixelMesh:
    """Mesh of a scene at a resolution, conforming to pixels and ends of `contacts`."""
    tips = singular_ends(contacts, skin) if resolution.layers else []
    rings = {(x, y): count for x, y, count in resolution.corners}
    rings |= dict.fromkeys(tips, resolution.layers)
    size = _patch(skin, contacts, resolution, tips) if tips else np.inf
    x = _nodes(skin, 0, contacts, resolution, tips, size)
    y = _nodes(skin, 1, contacts, resolution, tips, size)
    at = np.array(
        [np.abs(y - q).argmin() * len(x) + np.abs(x - p).argmin() for p, q in rings], dtype=np.int64
    )
    cells = ringed(rectangles(x, y), at, np.array(list(rings.values()), dtype=np.int64))
    middle = cells.p[:, cells.t].mean(axis=1)
    mesh = MeshQuad(cells.p, cells.t)
    tiles_x, tiles_y = tile_lines(skin, 0, resolution), tile_lines(skin, 1, resolution)
    column, row = np.searchsorted(tiles_x, middle[0]) - 1, np.searchsorted(tiles_y, middle[1]) - 1
    return PixelMesh(skin, mesh, cells, row * (len(tiles_x) - 1) + column)


def tile_lines(skin: Skin, axis: int, resolution: Resolution) -> Real:
    """Lines across x (axis 0) or y (axis 1) that the capacitance may jump at, m, ascending."""
    return np.sort([*pixel_lines(skin, axis), *resolution.lines[axis]])


def _lines(skin: Skin, axis: int, contacts: Sequence[Contact], resolution: Resolution) -> Real:
    """Lines across an axis that a mesh keeps: those of tiles and ends of foils."""
    ends = (end[axis] for contact in contacts for end in contact.ends(skin))
    return distinct([*tile_lines(skin, axis, resolution), *ends])


def _patch(
    skin: Skin,
    contacts: Sequence[Contact],
    resolution: Resolution,
    tips: Sequence[tuple[float, float]],
) -> float:
    """Width of the square cells around the tips, m; none reaches another line or tip."""
    widths = [resolution.edge_cell, resolution.touch_cell]
    for axis, length in enumerate((skin.length, skin.width)):
        lines = _lines(skin, axis, contacts, resolution)
        at_tip = np.array(
            [any(abs(line - tip[axis]) <= SAME_LINE * length for tip in tips) for line in lines]
        )
        shared = at_tip[:-1].astype(int) + at_tip[1:]
        widths.extend(np.diff(lines)[shared > 0] / shared[shared > 0])
    return float(min(widths))


def _nodes(
    skin: Skin,
    axis: int,
    contacts: Sequence[Contact],
    resolution: Resolution,
    tips: Sequence[tuple[float, float]],
    patch: float,
) -> Real:
    """Nodes along x (axis 0) or y (axis 1)."""
    length = skin.sides[axis]
    widths = dict.fromkeys(resolution.touched[axis], resolution.touch_cell)
    for contact in contacts:
        if axis == (0 if contact.edge in ("left", "right") else 1):
            line = length if contact.edge in ("right", "top") else 0.0
            widths[line] = min(widths.get(line, np.inf), resolution.edge_cell)
    for line in (0.0, length):
        if any(each[axis] == line and _at_corner(each, skin) for each in resolution.corners):
            widths[line] = min(widths.get(line, np.inf), resolution.edge_cell)
    patches = [tip[axis] + side * patch for tip in tips for side in (-1, 1)]
    lines = distinct(
        [
            *_lines(skin, axis, contacts, resolution),
            *(line for line in patches if 0 < line < length),
        ]
    )
    found = nodes(lines, resolution.cells, widths, GROWTH if tips else np.inf)
    if not resolution.corners:
        return found
    return _with_nodes_between(found, [each[axis] for each in (*tips, *resolution.corners)])


def _at_corner(ringed: tuple[float, float, int], skin: SheetsAndFoam) -> bool:
    return all(at in (0.0, side) for at, side in zip(ringed, skin.sides, strict=False))


def _with_nodes_between(nodes: Real, ringed: Sequence[float]) -> Real:
    """Nodes with one more in the middle of cells between two ringed ones.

    No cell then has rings twice.
    """
    at = np.zeros(len(nodes), dtype=bool)
    at[np.abs(nodes[:, None] - np.array(ringed)).argmin(axis=0)] = True
    shared = np.flatnonzero(at[:-1] & at[1:])
    return np.insert(nodes, shared + 1, (nodes[shared] + nodes[shared + 1]) / 2)


def singular_ends(contacts: Sequence[Contact], skin: SheetsAndFoam) -> list[tuple[float, float]]:
    """Ends of foils within an edge, and where foils meet that are not joined."""
    found = {
        _inwards(end, contact, skin): None
        for contact in contacts
        for fraction, end in zip(contact.span, contact.ends(skin), strict=True)
        if _is_singular(contact, fraction, end, contacts, skin)
    }
    return list(found)


def _inwards(
    end: tuple[float, float], contact: Contact, skin: SheetsAndFoam
) -> tuple[float, float]:
    """Inner corner of a foil with a width at its end; the end itself without a width."""
    if not contact.width:
        return end
    corners = strip(contact, skin)
    axis = ACROSS[contact.edge]
    inner = corners[1 if contact.edge in ("left", "bottom") else 0, axis]
    return (inner, end[1]) if axis == 0 else (end[0], inner)


def _is_singular(
    contact: Contact,
    fraction: float,
    end: tuple[float, float],
    contacts: Sequence[Contact],
    skin: SheetsAndFoam,
) -> bool:
    met = [other for other in contacts if other != contact and touch_at(end, contact, other, skin)]
    if met:
        return not all(contact.ideal and other.ideal for other in met)
    return 0 < fraction < 1


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
