"""Cameras in parallel projection, so that lengths can be read off a picture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Real

if TYPE_CHECKING:
    import pyvista as pv

TILT, TURN = np.radians(26), np.radians(-24)
"""Angles of a view from the side: above the horizon, and about the vertical, rad."""


@dataclass(frozen=True)
class Camera:
    """Parallel projection of a picture.

    right, up, towards: unit vectors of the picture and to the eye, (3,). low, high: corners of the
    picture, m, coordinates (2,) along right and up. above: True for a view from above with x to the
    right and y up.
    """

    right: Real
    up: Real
    towards: Real
    low: Real
    high: Real
    above: bool

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """Left, right, bottom and top of the picture, mm."""
        left, bottom, right, top = 1e3 * np.concatenate([self.low, self.high])
        return left, right, bottom, top

    @property
    def aspect(self) -> float:
        """Height over width."""
        width, height = self.high - self.low
        return height / width

    def project(self, places: Real) -> Real:
        """Coordinates of places (3, ...) in the picture, m, (2, ...)."""
        return np.stack([np.tensordot(axis, places, 1) for axis in (self.right, self.up)])

    def aim(self, plotter: pv.Plotter) -> None:
        """Set a plotter's camera to this projection."""
        across, height = (self.low + self.high) / 2
        depth = float(self.towards @ np.array(plotter.bounds).reshape(3, 2).mean(axis=1))
        focus = across * self.right + height * self.up + depth * self.towards
        reach = 10 * float(np.max(self.high - self.low))
        plotter.camera.focal_point = focus
        plotter.camera.position = focus + reach * self.towards
        plotter.camera.up = self.up
        plotter.camera.parallel_projection = True
        plotter.camera.parallel_scale = float(self.high[1] - self.low[1]) / 2
        plotter.renderer.reset_camera_clipping_range()


def from_above(places: Real, margin: float) -> Camera:
    """Camera with x to the right and y up.

    places: (3, n) that must be in the picture, with a margin in m.
    """
    return _framed(np.eye(3), places, margin, above=True)


def from_the_side(places: Real, facing: Real, margin: float) -> Camera:
    """Camera on the side to which `facing` (3,) points, turned by TURN and raised by TILT, y up."""
    up = np.array([0.0, 1.0, 0.0])
    front = facing - (facing @ up) * up
    front = front / np.linalg.norm(front) if np.linalg.norm(front) > 1e-6 else np.eye(3)[2]
    side = np.cross(up, front)
    turned = np.cos(TURN) * front + np.sin(TURN) * side
    towards = np.cos(TILT) * turned + np.sin(TILT) * up
    return _camera_towards(towards, up, places, margin)


def obliquely(places: Real, margin: float) -> Camera:
    """Camera that looks down on a skin in the plane z = 0, from its front and right."""
    up = np.array([0.0, 0.0, 1.0])
    level = np.array([np.sin(-TURN), -np.cos(TURN), 0.0])
    towards = np.cos(1.4 * TILT) * level + np.sin(1.4 * TILT) * up
    return _camera_towards(towards, up, places, margin)


def _camera_towards(towards: Real, up: Real, places: Real, margin: float) -> Camera:
    right = np.cross(up, towards)
    right /= np.linalg.norm(right)
    axes = np.stack([right, np.cross(towards, right), towards])
    return _framed(axes, places, margin, above=False)


def _framed(axes: Real, places: Real, margin: float, above: bool) -> Camera:
    projected = axes[:2] @ places
    low, high = projected.min(axis=1) - margin, projected.max(axis=1) + margin
    return Camera(axes[0], axes[1], axes[2], low, high, above)
