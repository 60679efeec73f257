"""Skin set up for viewing: flat from above, deformed from the side, or on its mug."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Real
from ..models.heterogeneous.materials import position
from ..press.press import label_of
from ..sweeps.press_text import displayed_press
from .camera import Camera, from_above, from_the_side, obliquely
from .figure import Panel
from .marks import marks
from .painting import Scenery
from .skin_surface import SkinSurface, is_curved, polygons, readable_exaggeration, surface

if TYPE_CHECKING:
    import pyvista as pv

    from ..models.solution import SolutionFields
    from ..press.press import Press
    from ..scene.contacts import Interface
    from ..scene.parts import SceneParts
    from .displayed_quantity import DisplayedQuantity
    from .quantities import ViewedQuantity

MARGIN = 0.012
"""Margin around all that is in the picture, over the skin's size."""
BODY_RADIUS = 0.985
"""Radius of the mug or ball drawn under a skin, over the radius of the skin."""
BODY_CLEARANCE = 1.05
"""Distance of a mug or ball below the skin, over the deepest place as drawn."""
MIN_BODY_RADIUS = 0.2
"""Smallest radius of a drawn mug or ball, over the radius of the skin."""
MUG_MARGIN = 0.25
"""Length of a mug beyond the skin, over the skin's extent along it."""
AROUND = 180


@dataclass(frozen=True)
class ViewedPress:
    """Fields of a press at an interface of a scene, and how they are viewed.

    wrapped: True for the skin as it is in space; None for that wherever it is curved. exaggeration:
    factor on the deflection; None for a chosen one with deformation, and for no deflection with all
    else.
    """

    parts: SceneParts
    press: Press
    interface: Interface
    fields: SolutionFields
    wrapped: bool | None = None
    exaggeration: float | None = None

    @property
    def press_text(self) -> str:
        """Text of the press for titles and messages."""
        return displayed_press(label_of(self.press, self.parts.skin, self.parts.plan.press))

    def plain_skin(self) -> SkinSurface:
        """Surface, deflected only if that is requested."""
        return surface(self.fields, self._in_space, self.exaggeration or 0.0)

    def surface(self, quantity: ViewedQuantity) -> SkinSurface:
        """Surface that a quantity is drawn on."""
        if quantity.name != "deformation" or self.exaggeration is not None:
            return self.plain_skin()
        return replace(self, exaggeration=readable_exaggeration(self.fields)).plain_skin()

    def panels(self, surface: SkinSurface, frames: list[DisplayedQuantity]) -> list[Panel]:
        """Panels of the frames on the skin, all seen from the same place."""
        drawn = marks(self.parts.skin, self.press, self.interface, surface, self.to_space)
        scenery = Scenery(surface, drawn, tuple(self._bodies(surface)))
        camera = _camera(scenery)
        return [Panel(scenery, frame, camera) for frame in frames]

    @property
    def _in_space(self) -> bool:
        return is_curved(self.fields) if self.wrapped is None else self.wrapped

    def to_space(self, x: Real) -> Real:
        """Flat places (2, n) where they are drawn, (3, n), on the skin and off its edges."""
        if self._in_space:
            return position(self.parts.skin, x)
        return np.vstack([x, np.zeros_like(x[:1])])

    def _bodies(self, skin: SkinSurface) -> list[pv.PolyData]:
        """Body under the skin, and the foam's sides where heights are exaggerated."""
        shape, thickness = self.parts.skin.shape, self.parts.skin.foam.thickness
        foam = skin.exaggeration * thickness if thickness is not None else 0.0
        sides = [_foam(skin, surface(self.fields, self._in_space), foam)] if foam else []
        if shape is None or not self._in_space:
            return sides
        deepest = skin.exaggeration * float(self.fields.deflection.max())
        free = shape.radius - max(foam, BODY_CLEARANCE * deepest)
        radius = max(MIN_BODY_RADIUS * shape.radius, min(BODY_RADIUS * shape.radius, free))
        length, width = self.parts.skin.stretched_sides
        middle = np.array([length / 2, width / 2, -shape.radius])
        if shape.kind == "sphere":
            return [*sides, _ball(middle, radius)]
        return [*sides, _mug(skin, middle, radius, shape.axis)]


def _camera(scenery: Scenery) -> Camera:
    skin = scenery.skin
    bodies = [np.asarray(body.points, dtype=float).T for body in scenery.bodies]
    ribbons = [foil.quads.reshape(3, -1) for foil in scenery.marks.foils]
    places = np.hstack([skin.points, *bodies, *ribbons])
    margin = MARGIN * skin.size
    if np.ptp(skin.points[2]) == 0:
        return from_above(places, margin)
    if skin.exaggeration and np.abs(skin.points[:2] - skin.x).max() <= 1e-9 * skin.size:
        return obliquely(places, margin)
    return from_the_side(places, _facing(scenery), margin)


def _facing(scenery: Scenery) -> Real:
    """Direction between those of the skin's middle and of the pressed places."""
    skin = scenery.skin
    facing = skin.normals.mean(axis=1)
    if scenery.marks.pressed:
        pressed = skin.nearest(np.hstack(scenery.marks.pressed))
        facing = facing + skin.normals[:, pressed].mean(axis=1)
    return facing


def _foam(skin: SkinSurface, rest: SkinSurface, thickness: float) -> pv.PolyData:
    """Sides of the foam, from the skin's rim down to the sheet beneath."""
    upper = skin.points[:, skin.rim]
    lower = (rest.points - thickness * rest.normals)[:, skin.rim]
    n = upper.shape[2]
    corners = np.arange(n)
    cells = np.stack([corners, corners + n, corners + 3 * n, corners + 2 * n])
    return polygons(np.hstack([*upper.transpose(1, 0, 2), *lower.transpose(1, 0, 2)]), cells)


def _mug(skin: SkinSurface, middle: Real, radius: float, axis: str) -> pv.PolyData:
    """Cylinder beneath the skin, longer than it. middle: anywhere on its axis."""
    along = np.array([1.0, 0.0, 0.0] if axis == "x" else [0.0, 1.0, 0.0])
    reach = along @ skin.points
    margin = MUG_MARGIN * np.ptp(reach)
    across = np.stack([np.roll(along, 1), np.roll(along, 2)])
    angle = np.linspace(0, 2 * np.pi, AROUND)
    circle = radius * (across.T @ np.stack([np.cos(angle), np.sin(angle)]))
    base = middle[:, None] - along[:, None] * (along @ middle)
    span = reach.min() - margin, reach.max() + margin
    ends = [base + circle + end * along[:, None] for end in span]
    first = np.arange(AROUND - 1)
    cells = np.stack([first, first + 1, first + 1 + AROUND, first + AROUND])
    return polygons(np.hstack(ends), cells)


def _ball(middle: Real, radius: float) -> pv.PolyData:
    import pyvista as pv

    return pv.Sphere(radius, middle, theta_resolution=120, phi_resolution=120)
