"""Outlines of skins that are no rectangles, and their shapes in space: cylinder and sphere."""

from __future__ import annotations

import itertools
import math
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from ..arrays import Mask, Real
from .planar import Circle, area, distance, gap, inside, ring, sides
from .validation import Number, Table, by_kind, within

MIN_SEPARATION = 1e-6
"""Smallest distance of sides that do not meet, over the skin's longer side."""

Coordinate = Annotated[Number, within(-1e3, 1e3, "m", "no skin is larger")]

MAX_HOLES = 100
"""Limit: all pairs are compared, and meshes around more holes take minutes."""

Size = Annotated[Number, within(1e-9, 1e3, "m", "no skin is larger, no hole as small as atoms")]


class Curve(Table):
    """A closed curve: a polygon of corners (x, y) in m in either sense, or circle = (x, y, radius).

    A circle runs anticlockwise from its point of largest x. points: corners (x, y) of a polygon.
    circle: its centre and radius (x, y, radius).
    """

    points: (
        Annotated[tuple[tuple[Coordinate, Coordinate], ...], Field(min_length=3, max_length=2000)]
        | None
    ) = None
    circle: tuple[Coordinate, Coordinate, Size] | None = None

    @property
    def shape(self) -> Circle | Real:
        """The circle, or the corners of the polygon in order, m, shape (corner, 2)."""
        if self.circle is not None:
            return Circle(*self.circle)
        return np.array(self.points, dtype=float)

    @property
    def marks(self) -> Real:
        """Arc lengths of the corners, m; a circle has one corner. The first is repeated at the
        end."""
        shape = self.shape
        if isinstance(shape, Circle):
            return np.array([0.0, 2 * np.pi * shape.radius])
        lengths = np.linalg.norm(np.diff(sides(shape), axis=1)[:, 0], axis=1)
        return np.concatenate([[0.0], np.cumsum(lengths)])

    def at(self, mark: float) -> tuple[float, float]:
        """The point (x, y) in m at arc length `mark` [m]."""
        shape = self.shape
        if isinstance(shape, Circle):
            x, y = shape.at(np.array(mark / shape.radius))
        else:
            x, y = (np.interp(mark, self.marks, along) for along in ring(shape).T)
        return float(x), float(y)

    def holds(self, x: Real) -> Mask:
        """True where positions x, shape (2, ...), lie within the curve, shape (...)."""
        shape = self.shape
        return shape.holds(x) if isinstance(shape, Circle) else inside(shape, x)

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        if (self.points is None) == (self.circle is None):
            raise ValueError("needs either points = [[x, y], ...] or circle = [x, y, radius]")
        return self


class Outline(Curve):
    """The outer curve of a skin, and the curves of its holes.

    points: corners (x, y) of a polygon. circle: its centre and radius (x, y, radius).
    """

    holes: Annotated[tuple[Curve, ...], Field(max_length=MAX_HOLES)] = ()


def check_outline(outline: Outline, length: float, width: float) -> None:
    """Raises ValueError for curves that meet themselves or each other, or leave the rectangle.

    length, width: of the rectangle of the pixels, m.
    """
    every = [outline, *outline.holes]
    names = ["outline", *(f"outline.holes[{i + 1}]" for i in range(len(outline.holes)))]
    min_distance = MIN_SEPARATION * max(length, width)
    for name, curve in zip(names, every, strict=True):
        shape = curve.shape
        _check_within(name, shape, length, width)
        if not isinstance(shape, Circle):
            check_simple(name, shape, min_distance)
        elif shape.radius < min_distance:
            raise ValueError(f"{name}.circle must have a radius of at least {min_distance:g} m")
    for name, hole in zip(names[1:], every[1:], strict=True):
        if _separation(outline, hole) < min_distance or not _within(hole, outline):
            raise ValueError(
                f"{name} must lie inside the outline, at least {min_distance:g} m from it"
            )
    for (first, a), (second, b) in itertools.combinations(
        zip(names[1:], every[1:], strict=True), 2
    ):
        if _separation(a, b) < min_distance or _within(a, b) or _within(b, a):
            raise ValueError(f"{first} and {second} must lie at least {min_distance:g} m apart")


def _check_within(name: str, shape: Circle | Real, length: float, width: float) -> None:
    if isinstance(shape, Circle):
        x, y, radius = shape
        ends = np.array([(x - radius, y - radius), (x + radius, y + radius)])
    else:
        ends = shape
    for axis, letter, extent in ((0, "x", length), (1, "y", width)):
        low, high = ends[:, axis].min(), ends[:, axis].max()
        if low < -1e-9 * extent or high > extent * (1 + 1e-9):
            raise ValueError(
                f"{name} must lie within {letter} = 0..{extent:g} m, got {low:g}..{high:g} m"
            )


def check_simple(name: str, corners: Real, min_distance: float) -> None:
    """Raises ValueError if a side is shorter, or if sides come closer, than `min_distance`."""
    each, count = sides(corners), len(corners)
    short = np.flatnonzero(np.linalg.norm(each[:, 1] - each[:, 0], axis=1) < min_distance)
    if len(short):
        raise ValueError(f"{name} has a side {short[0] + 1} shorter than {min_distance:g} m")
    separation = gap(each, each)
    i = np.arange(count)
    separation[i, i] = np.inf
    separation[i, (i + 1) % count] = separation[(i + 1) % count, i] = np.inf
    before = np.roll(each, 1, axis=0)
    folded = np.minimum(
        distance(each[:, 1], before).diagonal(), distance(before[:, 0], each).diagonal()
    )
    if folded.min() < min_distance:
        raise ValueError(f"{name} turns back on itself at its point {folded.argmin() + 1}")
    if separation.min() < min_distance:
        a, b = (int(k) + 1 for k in np.unravel_index(separation.argmin(), separation.shape))
        raise ValueError(
            f"{name} must not meet itself: its sides {a} and {b} cross, "
            f"or come within {min_distance:g} m of each other"
        )
    if abs(area(corners)) < min_distance**2:
        raise ValueError(f"{name} must enclose an area")


def _within(one: Curve, other: Curve) -> bool:
    """True if a curve lies within another one that it does not meet."""
    return bool(other.holds(np.array(one.at(0.0))))


def _separation(one: Curve, other: Curve) -> float:
    """Smallest distance between two curves, m; 0 if they meet."""
    a, b = one.shape, other.shape
    if isinstance(a, Circle):
        return a.gap(b)
    if isinstance(b, Circle):
        return b.gap(a)
    return float(gap(sides(a), sides(b)).min())


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
