"""A skin set up to be looked at: flat from above, deformed from the side, wrapped on its mug."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .camera import Camera, from_above, from_the_side, obliquely
from .figure import Panel
from .marks import marks
from .painting import Scenery
from .surface import Surface, curved, polygons, readable_exaggeration, surface

if TYPE_CHECKING:
    import pyvista as pv

    from ..models.fields import Fields
    from ..press.press import Press
    from ..scene.contacts import Interface
    from ..scene.scene import Scene
    from .quantities import Quantity
    from .shown import Shown

Real = NDArray[np.float64]
MARGIN = 0.025
"""Of the skin's size: around all that is in the picture."""
BENEATH = 0.985
"""Of its radius: the mug or ball that is drawn under a skin."""
MUG_MARGIN = 0.25
"""Of the skin's extent along it: how far a mug reaches beyond."""
AROUND = 180


@dataclass(frozen=True)
class Stage:
    """What is looked at and how: the fields of a press at an interface of a scene.

    wrapped: where the skin is in space; None is so wherever it is curved. exaggeration: of the
    deflection; None is chosen for deformation, and none for all else.
    """

    scene: Scene
    press: Press
    interface: Interface
    fields: Fields
    wrapped: bool | None = None
    exaggeration: float | None = None

    def plain_skin(self) -> Surface:
        """The surface, deflected only where that is asked for."""
        wrapped = curved(self.fields) if self.wrapped is None else self.wrapped
        return surface(self.fields, wrapped, self.exaggeration or 0.0)

    def skin(self, quantity: Quantity) -> Surface:
        """The surface that a quantity is drawn on."""
        if quantity.name != "deformation" or self.exaggeration is not None:
            return self.plain_skin()
        return replace(self, exaggeration=readable_exaggeration(self.fields)).plain_skin()

    def panels(self, skin: Surface, frames: list[Shown]) -> list[Panel]:
        """Each frame on the skin, all from the same place."""
        drawn = marks(self.scene, self.press, self.interface, skin)
        scenery = Scenery(skin, drawn, tuple(self._bodies(skin)))
        camera = _camera(scenery)
        return [Panel(scenery, frame, camera) for frame in frames]

    def _bodies(self, skin: Surface) -> list[pv.PolyData]:
        shape = getattr(self.scene.skin, "shape", None)
        if np.ptp(skin.points[2]) > 0 and shape is not None and self.wrapped is not False:
            return [_ball(skin, shape.radius) if shape.kind == "sphere" else _mug(skin, shape)]
        thickness = self.scene.skin.foam.thickness
        if skin.exaggeration and thickness is not None:
            return [_foam(skin, skin.exaggeration * thickness)]
        return []


def _camera(scenery: Scenery) -> Camera:
    skin = scenery.skin
    bodies = [np.asarray(body.points, dtype=float).T for body in scenery.bodies]
    foils = scenery.marks.foils
    ribbons = [foil.quads.reshape(3, -1) for foil in foils]
    places = np.hstack([skin.points, *bodies, *ribbons])
    margin = MARGIN * skin.size
    if np.ptp(skin.points[2]) == 0:
        camera = from_above(places, margin)
    elif skin.exaggeration and not _far_from_flat(skin):
        camera = obliquely(places, margin)
    else:
        camera = from_the_side(places, _facing(scenery), margin)
    return camera.including([foil.named_at(camera) for foil in foils], margin)


def _facing(scenery: Scenery) -> Real:
    """Between the middle of the skin and the places pressed."""
    skin = scenery.skin
    facing = skin.normals.mean(axis=1)
    if scenery.marks.pressed:
        pressed = skin.nearest(np.hstack(scenery.marks.pressed))
        facing = facing + skin.normals[:, pressed].mean(axis=1)
    return facing


def _far_from_flat(skin: Surface) -> bool:
    return bool(np.abs(skin.points[:2] - skin.x).max() > 1e-9 * skin.size)


def _foam(skin: Surface, thickness: float) -> pv.PolyData:
    """The foam's sides, down to the sheet beneath."""
    upper = skin.points[:, skin.rim]
    lower = np.array(upper)
    lower[2] = -thickness
    n = upper.shape[2]
    corners = np.arange(n)
    cells = np.stack([corners, corners + n, corners + 3 * n, corners + 2 * n])
    return polygons(np.hstack([*upper.transpose(1, 0, 2), *lower.transpose(1, 0, 2)]), cells)


def _mug(skin: Surface, shape) -> pv.PolyData:
    """A cylinder just beneath the skin, longer than it."""
    along = np.array([1.0, 0.0, 0.0] if shape.axis == "x" else [0.0, 1.0, 0.0])
    radial = skin.normals - np.outer(along, along @ skin.normals)
    middle = _centre(skin, radial / np.linalg.norm(radial, axis=0), shape.radius)
    reach = along @ skin.points
    margin = MUG_MARGIN * np.ptp(reach)
    across = np.stack([np.roll(along, 1), np.roll(along, 2)])
    angle = np.linspace(0, 2 * np.pi, AROUND)
    circle = BENEATH * shape.radius * (across.T @ np.stack([np.cos(angle), np.sin(angle)]))
    base = middle[:, None] - along[:, None] * (along @ middle)
    ends = [base + circle + end * along[:, None] for end in _mug_ends(reach, margin)]
    first = np.arange(AROUND - 1)
    cells = np.stack([first, first + 1, first + 1 + AROUND, first + AROUND])
    return polygons(np.hstack(ends), cells)


def _mug_ends(reach: Real, margin: float) -> tuple[float, float]:
    return float(reach.min() - margin), float(reach.max() + margin)


def _ball(skin: Surface, radius: float) -> pv.PolyData:
    import pyvista as pv

    middle = _centre(skin, skin.normals, radius)
    return pv.Sphere(BENEATH * radius, middle, theta_resolution=120, phi_resolution=120)


def _centre(skin: Surface, outwards: Real, radius: float) -> Real:
    """The place a radius behind every point, or before it where normals point inwards."""
    either = [skin.points + sign * radius * outwards for sign in (-1, 1)]
    nearest = min(either, key=lambda places: places.std(axis=1).sum())
    return np.median(nearest, axis=1)
