"""How a skin is stretched and what it is wrapped on: from the flat skin at rest to space.

The skin is first stretched flat, by `x` along its length and `y` along its width, then laid on its
shape with its middle at the shape's top. A cylinder takes a flat sheet as it is; on a sphere it is
draped from the middle so that all distances from there stay true (azimuthal equidistant), which
leaves the sheet shorter across the more it lies off the middle.
"""

from __future__ import annotations

import math
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from ..validation import Number, Table, by_kind, within

FARTHEST = 0.9
"""Of half a sphere's girth, from the middle of the skin to its corners: 9 times shorter across."""
ROUNDING = 1e-12

Ratio = Annotated[Number, Field(ge=0.1, le=10)]
PoissonRatio = Annotated[Number, Field(gt=-1, le=0.5)]
Radius = Annotated[Number, within(1e-5, 1e6, "m", "more is flat")]
Sides = tuple[float, float]


class Stretch(Table):
    """Lengths over those at rest along x and y, and how the materials give way to it.

    y: x ** -sheet_poisson_ratio where it is not given, as of a strip pulled at its ends. An
    electrode's thickness goes with J ** (-p / (1 - p)) of the area's stretch J and its Poisson
    ratio p, and so does the foam's with its own: electrodes of rubber keep their volume, 0.5.
    """

    x: Ratio = 1.0
    y: Ratio | None = None
    sheet_poisson_ratio: PoissonRatio = 0.5
    foam_poisson_ratio: PoissonRatio = 0.3

    @property
    def ratios(self) -> tuple[float, float]:
        """Along x and along y."""
        return self.x, self.x**-self.sheet_poisson_ratio if self.y is None else self.y

    @property
    def thinning(self) -> tuple[float, float]:
        """Powers of J that the sheets' resistance and the foam's capacitance per area go with."""
        return thinning(self.sheet_poisson_ratio), thinning(self.foam_poisson_ratio)


def thinning(poisson_ratio: float) -> float:
    """p / (1 - p): the power of the area's stretch that a layer's thickness falls with.

    Of Hencky strains in a layer that is free across: h = -p / (1 - p) (e_x + e_y).
    """
    return poisson_ratio / (1 - poisson_ratio)


class Cylinder(Table):
    """A cylinder of that radius [m], its axis along the skin's x or y: the skin bends only."""

    kind: Literal["cylinder"] = "cylinder"
    radius: Radius
    axis: Literal["x", "y"] = "y"

    @property
    def developable(self) -> bool:
        """Whether all lengths within the skin stay as they are."""
        return True

    def check(self, sides: Sides) -> None:
        """Raises ValueError where a skin of these sides, m, wraps more than once around."""
        around = sides[0] if self.axis == "y" else sides[1]
        if around > 2 * np.pi * self.radius * (1 + ROUNDING):
            raise ValueError(
                f"`shape.radius` must be >= {around / (2 * np.pi):.4g} m, for the skin to lie "
                f"around the cylinder once at most, got {self.radius:g}"
            )

    def position(self, x: NDArray[np.float64], sides: Sides) -> NDArray[np.float64]:
        """In space, m, of places x of the flat skin, shape (2, ...) to (3, ...)."""
        bent, kept = self._axes
        middle = sides[bent] / 2
        angle = (x[bent] - middle) / self.radius
        found = np.empty((3, *np.shape(x)[1:]))
        found[bent], found[kept] = middle + self.radius * np.sin(angle), x[kept]
        found[2] = -2 * self.radius * np.sin(angle / 2) ** 2
        return found

    def tangents(self, x: NDArray[np.float64], sides: Sides) -> NDArray[np.float64]:
        """Of `position` by x, shape (3, 2, ...)."""
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
    """A sphere of that radius [m], the skin draped over it from its middle."""

    kind: Literal["sphere"] = "sphere"
    radius: Radius

    @property
    def developable(self) -> bool:
        return False

    def check(self, sides: Sides) -> None:
        """Raises ValueError where the corners of a skin of these sides, m, come too far round."""
        least = math.hypot(*sides) / 2 / (FARTHEST * np.pi)
        if self.radius < least:
            raise ValueError(
                f"`shape.radius` must be >= {least:.4g} m, for the skin's corners to stay within "
                f"{FARTHEST:g} of half the way around the sphere, got {self.radius:g}"
            )

    def position(self, x: NDArray[np.float64], sides: Sides) -> NDArray[np.float64]:
        middle, away, angle = self._around(x, sides)
        across = away * _sine_over(angle) + middle
        return np.stack([*across, -2 * self.radius * np.sin(angle / 2) ** 2])

    def tangents(self, x: NDArray[np.float64], sides: Sides) -> NDArray[np.float64]:
        """Of `position` by x, shape (3, 2, ...): cos along the way from the middle, sin over angle
        across it."""
        _, away, angle = self._around(x, sides)
        distance = self.radius * np.where(angle > 0, angle, 1.0)
        radial = away / distance
        shorter = _sine_over(angle)
        found = np.empty((3, 2, *np.shape(x)[1:]))
        for i, j in np.ndindex(2, 2):
            found[i, j] = (np.cos(angle) - shorter) * radial[i] * radial[j] + (i == j) * shorter
        found[2] = -np.sin(angle) * radial
        return found

    def _around(
        self, x: NDArray[np.float64], sides: Sides
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """The skin's middle, the way from there, both in m, and the angle that is on the sphere."""
        middle = np.reshape(np.array(sides) / 2, (2,) + (1,) * (np.ndim(x) - 1))
        away = np.asarray(x) - middle
        return middle, away, np.hypot(*away) / self.radius


def _sine_over(angle: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.sinc(angle / np.pi)


AnyShape = Cylinder | Sphere
Shape = Annotated[AnyShape, by_kind(Cylinder, Sphere)]
