"""Meshes that conform to pixels and contact ends, finer where the field is steep."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from skfem import MeshQuad

from simulator.grid import SAME_LINE, distinct, nodes
from simulator.rings import Cells, rectangles, ringed
from simulator.scene import Contact, Scene, Skin
from simulator.wiring import touch_at

GROWTH = 4.0


@dataclass(frozen=True)
class Resolution:
    """How finely a sheet is resolved.

    order: polynomial order of the elements. cells: cells between neighbouring conforming lines.
    layers: rings around the ends of foils, for the square-root singularity there. edge_cell: width
    in m that cells do not exceed next to contacted edges, for the layer of the field there.
    touch_cell: the same next to the edges of the pixels (row, column) in `touched`, where the
    capacitance jumps.
    """

    order: int
    cells: int = 1
    layers: int = 0
    edge_cell: float = np.inf
    touch_cell: float = np.inf
    touched: tuple[tuple[int, int], ...] = ()

    def __str__(self) -> str:
        rings = f", {self.layers} rings at ends of foils" if self.layers else ""
        cells = f", {self.cells}x{self.cells} cells between lines" if self.cells > 1 else ""
        return f"Q{self.order}{cells}{rings}"


@dataclass(frozen=True)
class PixelMesh:
    """A mesh with the pixel that every element lies in.

    pixel: row * columns + column, both from 0, shape (element,).
    """

    skin: Skin
    mesh: MeshQuad
    cells: Cells
    pixel: NDArray[np.int64]

    def facets(self, contact: Contact) -> NDArray[np.int64]:
        """The boundary facets under a foil."""
        start, stop = contact.ends(self.skin)
        along = 1 if contact.edge in ("left", "right") else 0
        boundary = self.mesh.boundary_facets()
        ends = self.mesh.p[:, np.asarray(self.mesh.facets)[:, boundary]]
        on_edge = (ends[1 - along] == start[1 - along]).all(axis=0)
        middle = ends[along].mean(axis=0)
        return boundary[on_edge & (start[along] < middle) & (middle < stop[along])]

    def edges(self, facets: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """The element at each boundary facet, and which of its edges that is.

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


def pixel_mesh(scene: Scene, contacts: Sequence[Contact], resolution: Resolution) -> PixelMesh:
    """The mesh of a scene at a resolution, conforming to its pixels and the ends of `contacts`."""
    skin, pixels = scene.skin, scene.pixels
    tips = singular_ends(contacts, skin) if resolution.layers else []
    size = _patch(scene, contacts, resolution, tips) if tips else np.inf
    x = _nodes(0, skin.length, pixels.columns, contacts, skin, resolution, tips, size)
    y = _nodes(1, skin.width, pixels.rows, contacts, skin, resolution, tips, size)
    at = np.array(
        [np.abs(y - q).argmin() * len(x) + np.abs(x - p).argmin() for p, q in tips], dtype=np.int64
    )
    cells = ringed(rectangles(x, y), at, resolution.layers)
    middle = cells.p[:, cells.t].mean(axis=1)
    row = _interval(middle[1], skin.width, pixels.rows)
    column = _interval(middle[0], skin.length, pixels.columns)
    mesh = MeshQuad(cells.p, cells.t)
    return PixelMesh(skin, mesh, cells, row * pixels.columns + column)


def _lines(
    axis: int, length: float, pixels: int, contacts: Sequence[Contact], skin: Skin
) -> NDArray[np.float64]:
    """Lines across an axis that a mesh keeps: pixel edges and ends of foils."""
    ends = (end[axis] for contact in contacts for end in contact.ends(skin))
    return distinct([*np.linspace(0, length, pixels + 1), *ends])


def _patch(
    scene: Scene,
    contacts: Sequence[Contact],
    resolution: Resolution,
    tips: Sequence[tuple[float, float]],
) -> float:
    """Width in m of the square cells around the tips: none reaches another line, or another tip."""
    skin, pixels = scene.skin, scene.pixels
    widths = [resolution.edge_cell, resolution.touch_cell]
    for axis, length, count in ((0, skin.length, pixels.columns), (1, skin.width, pixels.rows)):
        lines = _lines(axis, length, count, contacts, skin)
        at_tip = np.array(
            [any(abs(line - tip[axis]) <= SAME_LINE * length for tip in tips) for line in lines]
        )
        shared = at_tip[:-1].astype(int) + at_tip[1:]
        widths.extend(np.diff(lines)[shared > 0] / shared[shared > 0])
    return float(min(widths))


def _nodes(
    axis: int,
    length: float,
    pixels: int,
    contacts: Sequence[Contact],
    skin: Skin,
    resolution: Resolution,
    tips: Sequence[tuple[float, float]],
    patch: float,
) -> NDArray[np.float64]:
    """Nodes along x (axis 0) or y (axis 1)."""
    pixel_lines = np.linspace(0, length, pixels + 1)
    widths: dict[float, float] = {}
    for pixel in resolution.touched:
        for line in pixel_lines[pixel[1 - axis] - 1 : pixel[1 - axis] + 1]:
            widths[float(line)] = resolution.touch_cell
    for contact in contacts:
        if axis == (0 if contact.edge in ("left", "right") else 1):
            line = length if contact.edge in ("right", "top") else 0.0
            widths[line] = min(widths.get(line, np.inf), resolution.edge_cell)
    beside = [tip[axis] + side * patch for tip in tips for side in (-1, 1)]
    lines = distinct(
        [
            *_lines(axis, length, pixels, contacts, skin),
            *(line for line in beside if 0 < line < length),
        ]
    )
    return nodes(lines, resolution.cells, widths, GROWTH if tips else np.inf)


def singular_ends(contacts: Sequence[Contact], skin: Skin) -> list[tuple[float, float]]:
    """Ends of foils within an edge, and where a foil meets another that it is not joined with."""
    found = {
        end: None
        for contact in contacts
        for fraction, end in zip(contact.span, contact.ends(skin), strict=True)
        if _is_singular(contact, fraction, end, contacts, skin)
    }
    return list(found)


def _is_singular(
    contact: Contact,
    fraction: float,
    end: tuple[float, float],
    contacts: Sequence[Contact],
    skin: Skin,
) -> bool:
    met = [other for other in contacts if other != contact and touch_at(end, contact, other, skin)]
    if met:
        return not all(contact.ideal and other.ideal for other in met)
    return 0 < fraction < 1


def _interval(position: NDArray[np.float64], length: float, count: int) -> NDArray[np.int64]:
    return np.clip((position / length * count).astype(np.int64), 0, count - 1)
