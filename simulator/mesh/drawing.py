"""Drawing of what a mesh conforms to, from the scene and the press; all in m."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Integer
from ..press.capacitance import touched_box
from ..press.pixels import pixel_lines
from ..press.press import Press
from ..press.touch import Disc, Place, Polygon, Rectangle, Touch
from ..scene.contacts import Contact
from ..scene.parts import Skin
from ..scene.pixel_grid import Pixels
from ..scene.planar import Circle, Points, regular, sides
from ..scene.skin import SheetsAndFoam
from ..scene.wiring_checks import strip

Shape = Circle | Points
"""Circle, or the corners of a polygon or polyline, shape (corner, 2)."""
Angular = Touch | Rectangle | Polygon


@dataclass(frozen=True)
class Drawing:
    """Skin with its foils, the grid of its pixels, and the pressed places.

    lines: grid lines across x and across y, those around pixels included. touches: shapes of the
    touches that have a factor and are no pixels, in order. creases: circles and polylines. between:
    True if the lines between pixels are drawn.
    """

    skin: SheetsAndFoam
    foils: tuple[Contact, ...]
    pixels: Pixels
    lines: tuple[Points, Points]
    touches: tuple[Shape, ...]
    creases: tuple[Shape, ...]
    between: bool = True

    @property
    def edges(self) -> list[Shape]:
        """Edges of touches, and the creases: circles, and segments (segment, 2, 2)."""
        creases = [
            crease if isinstance(crease, Circle) else np.stack([crease[:-1], crease[1:]], axis=1)
            for crease in self.creases
        ]
        return [*map(closed, self.touches), *creases]

    def angular(self, sides: int) -> Drawing:
        """Drawing with regular polygons of equal area in place of circular touches.

        sides: number of sides of a polygon.
        """
        return replace(
            self,
            touches=tuple(
                regular(*touch, sides) if isinstance(touch, Circle) else touch
                for touch in self.touches
            ),
        )

    def pixel_at(self, x: Points) -> Integer:
        """Number of the pixel at positions x, (2, point) to (point,); -1 off the grid."""
        column, row = (
            np.searchsorted(lines, along, side="right") - 1
            for lines, along in zip(self.lines, x, strict=True)
        )
        rows, columns = self.pixels.shape
        within = (row >= 0) & (row < rows) & (column >= 0) & (column < columns)
        return np.where(within, row * columns + column, -1)


def drawing_of(skin: Skin, press: Press, creases: Sequence[Shape], between: bool = True) -> Drawing:
    """Drawing of a press on a scene."""
    return Drawing(
        skin,
        skin.contacts,
        skin.pixels,
        (pixel_lines(skin, 0), pixel_lines(skin, 1)),
        tuple(shape_of(skin, touch) for touch in sharp_touches(press)),
        (*creases, *_strips(skin)),
        between,
    )


def sharp_touches(press: Press) -> list[Rectangle | Disc | Polygon]:
    """Touches of a press that have a factor and are no pixels, in order."""
    return [each for each in press.touches if isinstance(each, Rectangle | Disc | Polygon)]


def around_pixels(skin: Skin, press: Press) -> list[Points]:
    """Edges of the pixels that a press presses, closed polylines of shape (5, 2)."""
    boxes = [polygon_of(skin, each) for each in press.touches if isinstance(each, Touch)]
    return [np.concatenate([box, box[:1]]) for box in boxes]


def _strips(skin: Skin) -> list[Points]:
    """Edges of foils that have a width, closed polylines of shape (5, 2)."""
    corners = [strip(contact, skin) for contact in skin.contacts if contact.width]
    return [np.array([(a, b), (c, b), (c, d), (a, d), (a, b)]) for (a, b), (c, d) in corners]


def shape_of(skin: Skin, place: Place) -> Shape:
    """Circle of a disc; corners of any other place."""
    if isinstance(place, Disc):
        return Circle(place.x, place.y, place.radius)
    return polygon_of(skin, place)


def polygon_of(skin: Skin, place: Angular) -> Points:
    """Corners of a place that is no disc, shape (corner, 2)."""
    if isinstance(place, Polygon):
        return np.array(place.points, dtype=float)
    left, right, bottom, top = touched_box(skin, place)
    return np.array([(left, bottom), (right, bottom), (right, top), (left, top)])


def polygonal(place: Place, sides: int) -> Angular:
    """Place itself; for a disc the regular polygon of `sides` sides and equal area."""
    if not isinstance(place, Disc):
        return place
    corners = regular(place.x, place.y, place.radius, sides)
    return Polygon(tuple((x, y) for x, y in corners.tolist()), place.factor, place.finger)


def closed(shape: Shape) -> Shape:
    """A circle itself; for corners (corner, 2) their sides, shape (segment, 2, 2)."""
    return shape if isinstance(shape, Circle) else sides(shape)
