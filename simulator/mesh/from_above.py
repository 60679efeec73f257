"""Skin from above, as charts draw it: its outline, pixels and foils, in mm."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import Real
from ..chart_style import FOIL_COLOURS, foil_offset
from ..press.press import Press
from ..scene.contacts import Contact, outwards, path
from ..scene.parts import Skin
from ..scene.skin_region import curves, on_skin
from .arcs import edges_of
from .skin_mesh import domain

if TYPE_CHECKING:
    from matplotlib.axes import Axes

CIRCLE_PLACES = 260
"""Number of places around a circle."""
LINE_PLACES = 1001
"""Number of places along a line between pixels that are tested for skin."""
MM = 1e3

Places = Real


class Ribbon(NamedTuple):
    """Foil's line along the edge.

    path: places, m. out: directions off the skin there. Both are of shape (2, place).
    """

    path: Places
    out: Places

    @property
    def closed(self) -> bool:
        """True if it goes all around a curve."""
        return np.allclose(self.path[:, 0], self.path[:, -1], rtol=0, atol=1e-9)

    def beside(self, gap: float) -> Places:
        """Line at that distance off the skin, m."""
        return self.path + gap * self.out


def outline(skin: Skin) -> list[Places]:
    """Curves that bound a skin, the outer one first, m, each of shape (2, place)."""
    if skin.mesh is not None:
        return [_line_with_gaps(_mesh_edges(skin)[1])]
    found = []
    for curve in curves(skin):
        corners = curve.marks
        marks = corners if len(corners) > 2 else np.linspace(0, corners[-1], CIRCLE_PLACES)
        found.append(np.array([curve.at(mark) for mark in marks]).T)
    return found


def ribbon(foil: Contact, skin: Skin) -> Ribbon:
    """Line of a foil; on a mesh its facets one after the other, on the edge itself."""
    if skin.mesh is None:
        along = path(foil, skin)
        return Ribbon(along, outwards(along, skin))
    mesh = domain(skin, Press(), max(skin.sides))
    along = _line_with_gaps(mesh.p[:2][:, mesh.foils[foil.name]].transpose(0, 2, 1))
    return Ribbon(along, np.zeros_like(along))


def draw_outline(axes: Axes, skin: Skin, **looks: Any) -> None:
    """Draws the curves that bound a skin. looks: those of lines, as for matplotlib."""
    for curve in outline(skin):
        axes.plot(*(MM * curve), **{"color": "black", "linewidth": 1, **looks})


def draw_pixels(axes: Axes, skin: Skin, **looks: Any) -> None:
    """Draws the lines between pixels where there is skin. looks: those of lines."""
    for line in _between_pixels(skin):
        axes.plot(*(MM * line), **{"color": "0.4", "linewidth": 0.5, **looks})


def draw_foils(axes: Axes, skin: Skin, linewidth: float = 2.5, **looks: Any) -> None:
    """Draws foils in the colour of their sheet.

    The first of each sheet has a label for legends. Foils of the bottom sheet lie outside those of
    the top sheet; on a mesh, where both lie on the edge itself, they lie within them.
    """
    named, meshed = set[str](), skin.mesh is not None
    for foil in skin.foils:
        sheet, gap = foil.electrode, foil_offset(foil.electrode, max(skin.sides))
        wide = linewidth * (2 if meshed and sheet == "top" else 1)
        label = "_" if sheet in named else f"foil on the {sheet} sheet"
        (line,) = axes.plot(
            *(MM * ribbon(foil, skin).beside(gap)), color=FOIL_COLOURS[sheet], label=label
        )
        below = 0.1 if sheet == "top" else 0.0
        zorder = looks.get("zorder", 4) - below
        line.set(**{"solid_capstyle": "butt", **looks, "linewidth": wide, "zorder": zorder})
        named.add(sheet)


def _between_pixels(skin: Skin) -> list[Places]:
    if skin.mesh is not None:
        return [_line_with_gaps(_mesh_edges(skin)[0])]
    (length, width), (rows, columns) = skin.sides, skin.pixels.shape
    parts, ends = np.linspace(0, 1, LINE_PLACES), np.ones(LINE_PLACES)
    upright = [np.array([x * ends, width * parts]) for x in length * _inner(columns)]
    level = [np.array([length * parts, y * ends]) for y in width * _inner(rows)]
    return [np.where(on_skin(skin, line), line, np.nan) for line in [*upright, *level]]


def _inner(count: int) -> Places:
    """Fractions of a side at which lines between `count` pixels stand."""
    return np.arange(1, count) / count


def _mesh_edges(skin: Skin) -> tuple[Places, Places]:
    """Edges between pixels and on the rim, m, each of shape (2, edge, end)."""
    mesh = domain(skin, Press(), max(skin.sides))
    edges, of_triangle = edges_of(mesh.t)
    of_pixel, times = np.tile(mesh.pixel, 3), np.bincount(of_triangle.ravel())
    low, high = np.full((2, edges.shape[1]), [[mesh.pixel.max()], [-1]])
    np.minimum.at(low, of_triangle.ravel(), of_pixel)
    np.maximum.at(high, of_triangle.ravel(), of_pixel)
    ends = mesh.p[:2][:, edges].transpose(0, 2, 1)
    return ends[:, low < high], ends[:, times == 1]


def _line_with_gaps(ends: Places) -> Places:
    """Edges of shape (2, edge, end) as one line with gaps, (2, place)."""
    gaps = np.full((*ends.shape[:2], 1), np.nan)
    return np.concatenate([ends, gaps], axis=2).reshape(2, -1)
