"""Meshes of rectangles that conform to pixels and contact ends, finer where the field is steep."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from skfem import MeshQuad

from simulator.grid import GRADING, NONE, Refinement, distinct, nodes
from simulator.scene import Contact, Scene, Skin
from simulator.wiring import touch_at


@dataclass(frozen=True)
class Resolution:
    """How finely a sheet is resolved.

    order: polynomial order of the elements. cells: cells between neighbouring conforming lines.
    layers: how often the narrowest cells are divided towards the ends of foils, and the others as
    far, for the square-root singularity there. edge_cell: width in m that cells do not exceed next
    to contacted edges and, along them, next to pixel edges, for the layer of the field there.
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


def pixel_mesh(scene: Scene, contacts: Sequence[Contact], resolution: Resolution) -> PixelMesh:
    """The mesh of a scene at a resolution, conforming to its pixels and the ends of `contacts`."""
    skin, pixels = scene.skin, scene.pixels
    mesh = MeshQuad.init_tensor(
        _nodes(0, skin.length, pixels.columns, contacts, skin, resolution),
        _nodes(1, skin.width, pixels.rows, contacts, skin, resolution),
    )
    middle = mesh.p[:, mesh.t].mean(axis=1)
    row = _interval(middle[1], skin.width, pixels.rows)
    column = _interval(middle[0], skin.length, pixels.columns)
    return PixelMesh(skin, mesh, row * pixels.columns + column)


def _nodes(
    axis: int,
    length: float,
    pixels: int,
    contacts: Sequence[Contact],
    skin: Skin,
    resolution: Resolution,
) -> NDArray[np.float64]:
    """Nodes along x (axis 0) or y (axis 1).

    A field that reaches no farther than `edge_cell` from a contact changes as fast across the
    contacted edge as, along it, where the capacitance jumps between pixels.
    """
    pixel_lines = np.linspace(0, length, pixels + 1)
    refinements: dict[float, Refinement] = {}

    def refine(line: float, refinement: Refinement) -> None:
        refinements[line] = refinements.get(line, NONE).merged(refinement)

    layer = Refinement(width=resolution.edge_cell)
    for contact in contacts:
        across = 0 if contact.edge in ("left", "right") else 1
        if across == axis:
            refine(length if contact.edge in ("right", "top") else 0.0, layer)
        else:
            for line in pixel_lines[1:-1]:
                refine(float(line), layer)
    lines = distinct([*pixel_lines, *(end[axis] for c in contacts for end in c.ends(skin))])
    narrowest = np.diff(lines).min() / resolution.cells
    if resolution.layers:
        for end in singular_ends(contacts, skin):
            refine(end[axis], Refinement(tip=narrowest * GRADING**resolution.layers))
    return nodes(lines, resolution.cells, refinements)


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


def _interval(position: NDArray[np.float64], length: float, count: int) -> NDArray[np.int64]:
    return np.clip((position / length * count).astype(np.int64), 0, count - 1)
