"""What bounds a skin that is no rectangle: polygons and circles, and where along them foils lie."""

from __future__ import annotations

import itertools
import re
from typing import TYPE_CHECKING, Annotated, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from simulator.planar import area, distance, gap, inside, regular, sides
from simulator.table import Table
from simulator.validation import Number

if TYPE_CHECKING:
    from simulator.scene import Contact, Skin

CIRCLE_SIDES = 512
"""Of the regular polygon that stands for a circle: the area is the same, the circumference 6.3e-6
longer."""
LEAST_APART = 1e-6
"""Sides that do not meet, over the skin's longer side."""
EDGES = ("left", "right", "bottom", "top")
EDGE = re.compile(r"(?P<curve>outline|hole(?P<hole>[1-9]\d*))(?:\.(?P<side>[1-9]\d*))?")

Coordinate = Annotated[Number, Field(allow_inf_nan=False)]
Size = Annotated[Number, Field(gt=0, allow_inf_nan=False)]


class Curve(Table):
    """A closed curve: a polygon of corners (x, y) in m in either sense, or circle = (x, y, radius).

    A circle is the regular polygon of CIRCLE_SIDES sides of the same area, anticlockwise from the
    corner of greatest x on.
    """

    points: (
        Annotated[tuple[tuple[Coordinate, Coordinate], ...], Field(min_length=3, max_length=2000)]
        | None
    ) = None
    circle: tuple[Coordinate, Coordinate, Size] | None = None

    @property
    def corners(self) -> NDArray[np.float64]:
        """In order, m, shape (corner, 2)."""
        if self.circle is not None:
            return regular(*self.circle, CIRCLE_SIDES)
        return np.array(self.points, dtype=float)

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        if (self.points is None) == (self.circle is None):
            raise ValueError("needs either points = [[x, y], ...] or circle = [x, y, radius]")
        return self


class Outline(Curve):
    """The curve around a skin, and those around its holes."""

    holes: tuple[Curve, ...] = ()


class Section(NamedTuple):
    """A part of a closed curve: the curve's number, and from where to where along it, m."""

    curve: int
    start: float
    stop: float


def curves(skin: Skin) -> list[NDArray[np.float64]]:
    """The corners of what bounds a skin without mesh: around it first, then around its holes."""
    if skin.outline is not None:
        return [skin.outline.corners, *(hole.corners for hole in skin.outline.holes)]
    x, y = skin.length, skin.width
    return [np.array([(0, 0), (x, 0), (x, y), (0, y)], dtype=float)]


def section(contact: Contact, skin: Skin) -> Section:
    """The part of the curves of a skin without mesh that a foil lies along."""
    low, high = contact.span
    if skin.outline is None:
        return _along_rectangle(contact.edge, low, high, skin)
    curve, side = _parsed(contact.edge)
    marks = _marks(curves(skin)[curve])
    start, stop = (marks[0], marks[-1]) if side is None else (marks[side - 1], marks[side])
    return Section(curve, start + low * (stop - start), start + high * (stop - start))


def position(corners: NDArray[np.float64], at: float) -> tuple[float, float]:
    """The point at a distance [m] along a closed polygon, (x, y) in m."""
    marks = _marks(corners)
    closed = np.vstack([corners, corners[:1]])
    return float(np.interp(at, marks, closed[:, 0])), float(np.interp(at, marks, closed[:, 1]))


def _marks(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """How far along a closed polygon its corners lie, the first one again at the end, m."""
    lengths = np.linalg.norm(np.diff(sides(corners), axis=1)[:, 0], axis=1)
    return np.concatenate([[0.0], np.cumsum(lengths)])


def _along_rectangle(edge: str, low: float, high: float, skin: Skin) -> Section:
    """Anticlockwise from the corner (0, 0); spans run from an edge's low-coordinate end."""
    x, y = skin.length, skin.width
    start, run = {
        "bottom": (0.0, x),
        "right": (x, y),
        "top": (2 * x + y, -x),
        "left": (2 * (x + y), -y),
    }[edge]
    first, last = sorted((start + low * run, start + high * run))
    return Section(0, first, last)


def _parsed(edge: str) -> tuple[int, int | None]:
    match = EDGE.fullmatch(edge)
    assert match is not None
    return int(match["hole"] or 0), int(match["side"]) if match["side"] else None


def check_edge(edge: str, skin: Skin) -> str | None:
    """What an edge of a skin without mesh must be, where it is something else."""
    if skin.outline is None:
        return None if edge in EDGES else "must be 'left', 'right', 'bottom' or 'top'"
    allowed = _edges(skin.outline)
    match = EDGE.fullmatch(edge)
    if match is not None:
        sides_there = allowed.get(match["curve"])
        if sides_there is not None and int(match["side"] or 0) <= sides_there:
            return None
    return "must be " + " or ".join(
        f"'{name}', '{name}.1'..'{name}.{count}'" if count else f"'{name}'"
        for name, count in allowed.items()
    )


def _edges(outline: Outline) -> dict[str, int]:
    """The curves by name, and how many sides each has that a foil can be named after."""
    named = {"outline": outline, **{f"hole{i + 1}": hole for i, hole in enumerate(outline.holes)}}
    return {name: len(curve.points or ()) for name, curve in named.items()}


def check_outline(outline: Outline, length: float, width: float) -> None:
    """Raise ValueError for curves that meet themselves or each other, or leave the rectangle.

    length, width: of the rectangle that pixels are counted on, m.
    """
    around, *holes = (curve.corners for curve in (outline, *outline.holes))
    names = ["outline", *(f"outline.holes[{i + 1}]" for i in range(len(holes)))]
    least = LEAST_APART * max(length, width)
    for name, curve, corners in zip(
        names, (outline, *outline.holes), (around, *holes), strict=True
    ):
        _check_within(name, curve, length, width)
        if curve.circle is None:
            check_simple(name, corners, least)
        elif curve.circle[2] < least:
            raise ValueError(f"{name}.circle must have a radius of at least {least:g} m")
    for name, hole in zip(names[1:], holes, strict=True):
        if _nearest(around, hole, least) < least or not inside(around, hole[0]):
            raise ValueError(f"{name} must lie inside the outline, at least {least:g} m from it")
    for (first, a), (second, b) in itertools.combinations(zip(names[1:], holes, strict=True), 2):
        if _nearest(a, b, least) < least or inside(a, b[0]) or inside(b, a[0]):
            raise ValueError(f"{first} and {second} must lie at least {least:g} m apart")


def _check_within(name: str, curve: Curve, length: float, width: float) -> None:
    if curve.circle is not None:
        x, y, radius = curve.circle
        ends = np.array([(x - radius, y - radius), (x + radius, y + radius)])
    else:
        ends = curve.corners
    for axis, letter, extent in ((0, "x", length), (1, "y", width)):
        low, high = ends[:, axis].min(), ends[:, axis].max()
        if low < -1e-9 * extent or high > extent * (1 + 1e-9):
            raise ValueError(
                f"{name} must lie within {letter} = 0..{extent:g} m, got {low:g}..{high:g} m"
            )


def check_simple(name: str, corners: NDArray[np.float64], least: float) -> None:
    """No side shorter than `least`, none nearer than that to one that it does not meet."""
    each, count = sides(corners), len(corners)
    short = np.flatnonzero(np.linalg.norm(each[:, 1] - each[:, 0], axis=1) < least)
    if len(short):
        raise ValueError(f"{name} has a side {short[0] + 1} shorter than {least:g} m")
    apart = gap(each, each)
    i = np.arange(count)
    apart[i, i] = apart[i, (i + 1) % count] = apart[(i + 1) % count, i] = np.inf
    before = np.roll(each, 1, axis=0)
    folded = np.minimum(
        distance(each[:, 1], before).diagonal(), distance(before[:, 0], each).diagonal()
    )
    if folded.min() < least:
        raise ValueError(f"{name} turns back on itself at its point {folded.argmin() + 1}")
    if apart.min() < least:
        a, b = (int(k) + 1 for k in np.unravel_index(apart.argmin(), apart.shape))
        raise ValueError(
            f"{name} must not meet itself: its sides {a} and {b} cross, "
            f"or come within {least:g} m of each other"
        )
    if abs(area(corners)) < least**2:
        raise ValueError(f"{name} must enclose an area")


def _nearest(a: NDArray[np.float64], b: NDArray[np.float64], least: float) -> float:
    """Between two closed polygons, m; infinite where the boxes around them are apart."""
    boxes_apart = np.maximum(a.min(axis=0) - b.max(axis=0), b.min(axis=0) - a.max(axis=0))
    return np.inf if (boxes_apart > least).any() else float(gap(sides(a), sides(b)).min())
