"""Stretching of a skin and its mapping onto a cylinder or sphere.

The skin is first stretched flat, by `x` along its length and `y` along its width, then placed on
its shape with its middle at the top. A cylinder needs no further strain. On a sphere, distances
from the middle are kept (azimuthal equidistant), so that circles around the middle become shorter
with growing distance.
"""

from __future__ import annotations

import math
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from ...arrays import Real
from ..validation import Number, Table, by_kind, within

FARTHEST = 0.9
"""Largest distance of the corners from the middle, over half the girth of the sphere; circles are
9 times shorter there."""
ROUNDING = 1e-12

Ratio = Annotated[Number, Field(ge=0.1, le=10)]
PoissonRatio = Annotated[Number, Field(gt=-1, le=0.5)]
Radius = Annotated[Number, within(1e-5, 1e6, "m", "a larger radius is flat")]
Sides = tuple[float, float]


class Stretch(Table):
    """Stretch ratios along x and y, and the Poisson ratios of the materials.

    x: stretched length over the length. sheet_poisson_ratio: of both electrodes.
    foam_poisson_ratio: of the foam. y: default x ** -sheet_poisson_ratio, as for a strip pulled at
    its ends. The thickness of an electrode is proportional to J ** (-p / (1 - p)) with the area's
    stretch J and its Poisson ratio p; the same holds for the foam. Rubber electrodes keep their
    volume: p = 0.5.
    """

    x: Ratio = 1.0
    y: Ratio | None = None
    sheet_poisson_ratio: PoissonRatio = 0.5
    foam_poisson_ratio: PoissonRatio = 0.3

    @property
    def ratios(self) -> tuple[float, float]:
        """Stretch ratios along x and along y."""
        return self.x, self.x**-self.sheet_poisson_ratio if self.y is None else self.y

    @property
    def thinning(self) -> tuple[float, float]:
        """Powers of J in the sheets' resistance and in the foam's capacitance per area."""
        return thinning(self.sheet_poisson_ratio), thinning(self.foam_poisson_ratio)


def thinning(poisson_ratio: float) -> float:
    """p / (1 - p), the power of the area's stretch by which a layer's thickness decreases.

    It follows from Hencky strains in a layer with free faces: h = -p / (1 - p) (e_x + e_y).
    """
    return poisson_ratio / (1 - poisson_ratio)


class Cylinder(Table):
    """A cylinder of a radius [m] with its axis along the skin's x or y; the skin only bends.

    radius: of the surface on which the skin lies. axis: side of the skin along which it stays
    straight.
    """

    kind: Literal["cylinder"] = "cylinder"
    radius: Radius
    axis: Literal["x", "y"] = "y"

    @property
    def developable(self) -> bool:
        """True if all lengths within the skin are unchanged."""
        return True

    def check(self, sides: Sides) -> None:
        """Raises ValueError if a skin with these sides [m] wraps around more than once."""
        around = sides[0] if self.axis == "y" else sides[1]
        if around > 2 * np.pi * self.radius * (1 + ROUNDING):
            raise ValueError(
                f"`shape.radius` must be >= {around / (2 * np.pi):.4g} m, for the skin to go "
                f"around the cylinder at most once, got {self.radius:g}"
            )

    def position(self, x: Real, sides: Sides) -> Real:
        """Position in space, m, of points x of the flat skin, shape (2, ...) to (3, ...)."""
        bent, kept = self._axes
        middle = sides[bent] / 2
        angle = (x[bent] - middle) / self.radius
        found = np.empty((3, *np.shape(x)[1:]))
        found[bent], found[kept] = middle + self.radius * np.sin(angle), x[kept]
        found[2] = -2 * self.radius * np.sin(angle / 2) ** 2
        return found

    def tangents(self, x: Real, sides: Sides) -> Real:
        """Derivative of `position` by x, shape (3, 2, ...)."""
        bent, kept = self._axes
        angle = (x[bent] - sides[bent] / 2) / self.radius
        found = np.zeros((3, 2, *np.shape(x)[1:]))
        found[bent, bent], found[2, bent] = np.cos(angle), -np.sin(angle)
        found[kept, kept] = 1.0
        return found

    @property
    def _axes(self) -> tuple[int, int]:
        return (0, 1) if self.axis == "y" else (1, 0)


class Sphere(Table):
    """A sphere of a radius [m]; the skin is placed on it with its middle at the top.

    radius: of the surface on which the skin lies.
    """

    kind: Literal["sphere"] = "sphere"
    radius: Radius

    @property
    def developable(self) -> bool:
        return False

    def check(self, sides: Sides) -> None:
        """Raises ValueError if the corners of a skin with these sides [m] reach around too far."""
        smallest = math.hypot(*sides) / 2 / (FARTHEST * np.pi)
        if self.radius < smallest:
            raise ValueError(
                f"`shape.radius` must be >= {smallest:.4g} m, for the skin's corners to stay "
                f"within {FARTHEST:g} of half the way around the sphere, got {self.radius:g}"
            )

    def position(self, x: Real, sides: Sides) -> Real:
        middle, away, angle = self._around(x, sides)
        across = away * _sine_over(angle) + middle
        return np.stack([*across, -2 * self.radius * np.sin(angle / 2) ** 2])

    def tangents(self, x: Real, sides: Sides) -> Real:
        """Derivative of `position` by x, shape (3, 2, ...).

        The stretch is 1 in radial direction and sin(angle)/angle across it.
        """
        _, away, angle = self._around(x, sides)
        distance = self.radius * np.where(angle > 0, angle, 1.0)
        radial = away / distance
        shorter = _sine_over(angle)
        found = np.empty((3, 2, *np.shape(x)[1:]))
        for i, j in np.ndindex(2, 2):
            found[i, j] = (np.cos(angle) - shorter) * radial[i] * radial[j] + (i == j) * shorter
        found[2] = -np.sin(angle) * radial
        return found

    def _around(self, x: Real, sides: Sides) -> tuple[Real, Real, Real]:
        """The skin's middle and the offset from it, both in m, and the angle on the sphere."""
        middle = np.reshape(np.array(sides) / 2, (2,) + (1,) * (np.ndim(x) - 1))
        away = np.asarray(x) - middle
        return middle, away, np.hypot(*away) / self.radius


def _sine_over(angle: Real) -> Real:
    return np.sinc(angle / np.pi)


AnyShape = Cylinder | Sphere
Shape = Annotated[AnyShape, by_kind(Cylinder, Sphere)]
