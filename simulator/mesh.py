"""Meshes of rectangles that conform to pixels and contact ends, finer where the field is steep."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from skfem import MeshQuad

from simulator.scene import Contact, Scene, Skin
from simulator.wiring import touch_at

GRADING = 0.2
SAME_LINE = 1e-9


@dataclass(frozen=True)
class Resolution:
    """How finely a sheet is resolved.

    order: polynomial order of the elements. cells: cells between neighbouring conforming lines.
    layers: how often the cells next to a contact's end are divided, each time at GRADING of their
    length, for the square-root singularity there. edge_cell: cells next to contacted edges are no
    wider than this, in m, for the layer of the field there.
    """

    order: int
    cells: int = 1
    layers: int = 0
    edge_cell: float = np.inf

    def __str__(self) -> str:
        return f"Q{self.order}, {self.cells} cells a pixel, {self.layers} layers at contact ends"


@dataclass(frozen=True)
class PixelMesh:
    """A mesh of rectangles with the pixel that every element lies in.

    pixel: row * columns + column, both from 0, shape (element,).
    """

    skin: Skin
    mesh: MeshQuad
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
        first, second = self.mesh.p[:, np.asarray(self.mesh.facets)[:, facets]].transpose(1, 0, 2)
        return element, (is_edge * np.linalg.norm(second - first, axis=0)).T


@dataclass(frozen=True)
class _Axis:
    """Conforming lines of one axis, and the width that cells beside some of them should have."""

    length: float
    lines: NDArray[np.float64]
    finest: dict[float, float]

    def nodes(self, cells: int) -> NDArray[np.float64]:
        pieces = [
            _graded(low, high, cells, self._finest_at(low), self._finest_at(high))
            for low, high in itertools.pairwise(self.lines)
        ]
        return np.concatenate([[self.lines[0]], *(piece[1:] for piece in pieces)])

    def _finest_at(self, line: float) -> float:
        near = SAME_LINE * self.length
        widths = [width for at, width in self.finest.items() if abs(at - line) <= near]
        return min(widths, default=np.inf)


def pixel_mesh(scene: Scene, contacts: Sequence[Contact], resolution: Resolution) -> PixelMesh:
    """The mesh of a scene at a resolution, conforming to its pixels and the ends of `contacts`."""
    x, y = (axis.nodes(resolution.cells) for axis in _axes(scene, contacts, resolution))
    mesh = MeshQuad.init_tensor(x, y)
    middle = mesh.p[:, mesh.t].mean(axis=1)
    row = _interval(middle[1], scene.skin.width, scene.pixels.rows)
    column = _interval(middle[0], scene.skin.length, scene.pixels.columns)
    return PixelMesh(scene.skin, mesh, row * scene.pixels.columns + column)


def _axes(scene: Scene, contacts: Sequence[Contact], resolution: Resolution) -> tuple[_Axis, _Axis]:
    skin, pixels = scene.skin, scene.pixels
    ends = [end for contact in contacts for end in contact.ends(skin)]
    singular = singular_ends(contacts, skin) if resolution.layers else []
    return (
        _axis(skin.length, pixels.columns, 0, ends, singular, contacts, resolution),
        _axis(skin.width, pixels.rows, 1, ends, singular, contacts, resolution),
    )


def _axis(
    length: float,
    pixels: int,
    direction: int,
    ends: Sequence[tuple[float, float]],
    singular: Sequence[tuple[float, float]],
    contacts: Iterable[Contact],
    resolution: Resolution,
) -> _Axis:
    lines = _distinct([*np.linspace(0, length, pixels + 1), *(end[direction] for end in ends)])
    finest: dict[float, float] = {}
    for contact in contacts:
        normal = 0 if contact.edge in ("left", "right") else 1
        if normal == direction:
            finest[length if contact.edge in ("right", "top") else 0.0] = resolution.edge_cell
    step = np.diff(lines).min() / resolution.cells * GRADING**resolution.layers
    for end in singular:
        finest[end[direction]] = min(step, finest.get(end[direction], np.inf))
    return _Axis(length, lines, finest)


def singular_ends(contacts: Sequence[Contact], skin: Skin) -> list[tuple[float, float]]:
    """Ends of foils within an edge, and where a foil meets another that it is not joined with."""
    return [
        end
        for contact in contacts
        for fraction, end in zip(contact.span, contact.ends(skin), strict=True)
        if _is_singular(contact, fraction, end, contacts, skin)
    ]


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


def _distinct(lines: Sequence[float]) -> NDArray[np.float64]:
    ascending = np.sort(np.asarray(lines))
    apart = np.diff(ascending) > SAME_LINE * ascending[-1]
    return ascending[np.append(True, apart)]


def _graded(
    low: float, high: float, cells: int, finest_low: float, finest_high: float
) -> NDArray[np.float64]:
    """Nodes of an interval: even cells, the outermost ones shrinking towards fine ends."""
    even = max(cells, 2) if np.isfinite(finest_low) and np.isfinite(finest_high) else cells
    nodes = np.linspace(low, high, even + 1)
    width = (high - low) / even
    below = low + width * _geometric(finest_low / width)
    above = high - width * _geometric(finest_high / width)[::-1]
    return np.concatenate([nodes[:1], below, nodes[1:-1], above, nodes[-1:]])


def _geometric(finest: float) -> NDArray[np.float64]:
    """GRADING^n, ..., GRADING², GRADING, the first not above `finest`; fractions of a cell."""
    if finest >= 1:
        return np.empty(0)
    layers = int(np.ceil(np.log(finest) / np.log(GRADING) - 1e-9))
    return GRADING ** np.arange(layers, 0, -1, dtype=float)


def _interval(position: NDArray[np.float64], length: float, count: int) -> NDArray[np.int64]:
    return np.clip((position / length * count).astype(np.int64), 0, count - 1)
