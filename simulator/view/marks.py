"""Marks drawn on the skin: foils, pixels, pressed places, arrows of current."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Real
from ..mesh.drawing import polygon_of, polygonal
from ..press.pixels import cell_centres, pixel_lines
from ..press.touch import Disc, Touch, place_of
from ..scene.planar import sides
from .foils import Foil, SkinMesh, foils

if TYPE_CHECKING:
    from ..press.press import Press
    from ..press.touch import AnyTouch
    from ..scene.contacts import Interface
    from ..scene.parts import Skin
    from .skin_surface import SkinSurface

Point = Real | tuple[float, float]

STEPS = 60
"""Pieces of a line, so that it follows a curved skin."""
CIRCLE = 120
EDGE_ON = 0.15
"""Component of a normal towards the eye up to which marks cannot be read."""
ARROWS_ALONG = 16
"""Number of arrows along the longer side."""
MIN_ARROW_CURRENT = 0.02
"""Current over the largest one up to which arrows are left out."""


@dataclass(frozen=True)
class Marks:
    """Lines (3, n) in space, the foils, and the middles of pixels.

    middles: in space, m, (3, row, column); nan off the skin. grid_lines: positions along x and y of
    the lines between pixels, m; None where pixels are groups of a mesh's elements.
    """

    foils: tuple[Foil, ...]
    pixels: tuple[Real, ...]
    pressed: tuple[Real, ...]
    rim: tuple[Real, ...]
    middles: Real
    grid_lines: tuple[Real, Real] | None


@dataclass(frozen=True)
class Arrows:
    """Arrows along the skin.

    places: m, (3, n). directions: unit vectors, (3, n). length: drawn length of each, m.
    """

    places: Real
    directions: Real
    length: float

    def facing(self, surface: SkinSurface, towards: Real | None) -> Arrows:
        """Arrows on the side of the skin that faces an eye (3,); all if it may move."""
        if towards is None or not self.places.size:
            return self
        visible = towards @ surface.normals[:, surface.nearest(self.places)] > EDGE_ON
        return replace(self, places=self.places[:, visible], directions=self.directions[:, visible])


def marks(
    skin: Skin,
    press: Press,
    interface: Interface,
    surface: SkinSurface,
    to_space: Callable[[Real], Real],
) -> Marks:
    """Marks on the skin, without the field; `to_space` as for `foils`."""
    mesh = SkinMesh(skin, press, surface) if skin.mesh else None
    if mesh and skin.pixels.groups:
        grid, middles = list(mesh.pixel_lines()), mesh.middles()
    else:
        grid = [line for flat in pixel_grid(skin) for line in _on_skin(flat, surface)]
        middles = _middles(skin, surface)
    rim = surface.points[:, surface.rim]
    return Marks(
        foils=foils(skin, interface, surface, to_space, mesh),
        pixels=tuple(grid),
        pressed=tuple(_pressed_outlines(skin, press, surface, mesh)),
        rim=tuple(rim.transpose(2, 0, 1)),
        middles=middles.reshape(3, skin.pixels.rows, skin.pixels.columns),
        grid_lines=None if skin.pixels.groups else _grid_lines(skin, to_space),
    )


def _grid_lines(skin: Skin, to_space: Callable[[Real], Real]) -> tuple[Real, Real]:
    x, y = pixel_lines(skin, 0), pixel_lines(skin, 1)
    along, across = np.stack([x, 0 * x]), np.stack([0 * y, y])
    return to_space(along)[0], to_space(across)[1]


def _middles(skin: Skin, surface: SkinSurface) -> Real:
    """Middles of pixels in a grid, in space, m, (3, pixel); nan off the skin."""
    flat = cell_centres(skin, skin.pixels.shape).reshape(2, -1)
    places, _, _ = surface.carry(flat)
    return np.where(surface.covers(flat), places, np.nan)


def _pressed_outlines(
    skin: Skin, press: Press, surface: SkinSurface, mesh: SkinMesh | None
) -> Iterator[Real]:
    """Lines (3, n) around the pressed places."""
    for touch in press.touches:
        place = place_of(touch)
        if mesh and skin.pixels.groups and isinstance(place, Touch):
            yield from mesh.around(place)
        else:
            yield from _on_skin(outline(touch, skin), surface)


def pixel_grid(skin: Skin) -> list[Real]:
    """Lines between pixels, flat (2, n)."""
    length, width = skin.length, skin.width
    upright = [_between((x, 0.0), (x, width)) for x in pixel_lines(skin, 0)[1:-1]]
    return upright + [_between((0.0, y), (length, y)) for y in pixel_lines(skin, 1)[1:-1]]


def outline(touch: AnyTouch, skin: Skin) -> Real:
    """Closed flat line (2, n) around a touch."""
    place = place_of(touch)
    corners = polygon_of(skin, polygonal(place, CIRCLE))
    steps = 1 if isinstance(place, Disc) else STEPS
    return np.hstack([_between(low, high, steps) for low, high in sides(corners)])


def _between(low: Point, high: Point, steps: int = STEPS) -> Real:
    return np.linspace(np.asarray(low), np.asarray(high), steps + 1).T


def _on_skin(flat: Real, surface: SkinSurface) -> list[Real]:
    """Parts of a flat line that lie on the skin, in space."""
    middle = surface.x.mean(axis=1, keepdims=True)
    inside = surface.covers(flat + 1e-6 * (middle - flat))
    places, _, _ = surface.carry(flat)
    ends = np.flatnonzero(np.diff(np.concatenate([[False], inside, [False]])))
    return [places[:, low:high] for low, high in ends.reshape(-1, 2) if high - low > 1]


def arrows(surface: SkinSurface, current: Real, highest: float) -> Arrows:
    """Arrows along a real current density (2, point), except where it is faint.

    highest: density that it is compared with.
    """
    spans = np.ptp(surface.x, axis=1)
    step = spans.max() / ARROWS_ALONG
    axes = [
        low + (np.arange(int(span / step)) + 0.5) * span / int(max(span / step, 1))
        for low, span in zip(surface.x.min(axis=1), spans, strict=True)
    ]
    flat = np.stack([axis.ravel() for axis in np.meshgrid(*axes)])
    flat = flat[:, surface.covers(flat)]
    strength = surface.at(flat, current)
    size = np.hypot(*strength)
    kept = size > MIN_ARROW_CURRENT * highest
    flat, along = flat[:, kept], strength[:, kept] / size[kept]
    places, normals, _ = surface.carry(flat)
    ahead, _, _ = surface.carry(flat + 1e-3 * surface.size * along)
    behind, _, _ = surface.carry(flat - 1e-3 * surface.size * along)
    directions = (ahead - behind) / np.linalg.norm(ahead - behind, axis=0)
    return Arrows(places + 2e-3 * surface.size * normals, directions, 0.72 * step)
