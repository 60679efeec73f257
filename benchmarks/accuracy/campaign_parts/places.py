"""Touches drawn at random: along, across, tangent and next to where something else begins."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.accuracy.campaign_parts.draws import Rng, usual_or_extreme
from rcskin.benchmarks.accuracy.campaign_parts.problem import Tables
from rcskin.simulator.press.press import Press
from rcskin.simulator.press.touch import Disc, Polygon, Rectangle, Touch

FACTORS, EXTREME_FACTORS = (0.3, 10.0), (0.01, 1000.0)
ON_A_LINE, NEXT_TO_A_LINE = 0.35, 0.1
NEXT = (-3.3, -1.7)
"""log10 of how far from a line, over the side, a touch next to it ends."""
LEAST = 0.03
"""Size of touches over the side."""
TANGENT = 0.4
Lines = tuple[NDArray[np.float64], NDArray[np.float64]]
Area = Rectangle | Disc | Polygon


def lines_of(tables: Tables) -> Lines:
    """Across x and across y, m: edges of the skin and of pixels, and ends of foils."""
    found = []
    for axis, (side, count) in enumerate((("length", "columns"), ("width", "rows"))):
        extent, names = tables["skin"][side], (("bottom", "top"), ("left", "right"))[axis]
        ends = [end for each in tables["contact"] if each["edge"] in names for end in each["span"]]
        marks = [*np.linspace(0, 1, tables["pixels"][count] + 1), *ends]
        found.append(extent * np.unique(marks))
    return found[0], found[1]


def coordinate(rng: Rng, lines: NDArray[np.float64]) -> float:
    """A place along an axis, m: on one of the lines, next to one, or anywhere."""
    side, at = lines[-1], rng.random()
    if at < ON_A_LINE:
        return float(rng.choice(lines))
    if at < ON_A_LINE + NEXT_TO_A_LINE:
        off = side * 10 ** rng.uniform(*NEXT) * rng.choice([-1, 1])
        return float(np.clip(rng.choice(lines) + off, 0, side))
    return float(rng.uniform(0, side))


def interval(rng: Rng, lines: NDArray[np.float64]) -> tuple[float, float]:
    """Middle and length of a part of an axis, m."""
    while True:
        low, high = sorted((coordinate(rng, lines), coordinate(rng, lines)))
        if high - low > LEAST * lines[-1]:
            return (low + high) / 2, high - low


def factor(rng: Rng) -> float:
    """Capacitance over that at rest."""
    return usual_or_extreme(rng, FACTORS, EXTREME_FACTORS)


def rectangle(rng: Rng, lines: Lines) -> Rectangle:
    """Its sides wherever lines are, or not."""
    (x, width), (y, height) = (interval(rng, each) for each in lines)
    return Rectangle(x, y, width, height, factor(rng))


def disc(rng: Rng, lines: Lines) -> Disc:
    """Within the rectangle; some are tangent to a line or to an edge."""
    while True:
        x, y = (rng.uniform(0, each[-1]) for each in lines)
        room = min(x, lines[0][-1] - x, y, lines[1][-1] - y)
        axis = int(rng.integers(2))
        away = np.abs(lines[axis] - (x, y)[axis])
        radius = rng.uniform(LEAST, 0.4) * min(lines[0][-1], lines[1][-1])
        if rng.random() < TANGENT:
            radius = float(rng.choice(away))
        if LEAST * max(lines[0][-1], lines[1][-1]) < radius <= room:
            return Disc(float(x), float(y), float(radius), factor(rng))


def polygon(rng: Rng, lines: Lines) -> Polygon:
    """A star of three to seven corners, some of them on lines."""
    sides = np.array([each[-1] for each in lines])
    count = int(rng.integers(3, 8))
    angle = 2 * np.pi * (np.arange(count) + rng.uniform(0, 0.8, count)) / count
    reach = rng.uniform(0.3, 1.0, count) * rng.uniform(0.1, 0.5)
    around = np.stack([np.cos(angle), np.sin(angle)], axis=1) * reach[:, None]
    points = np.clip(rng.uniform(0, 1, 2) + around, 0, 1) * sides
    for point in points[rng.random(count) < ON_A_LINE]:
        axis = int(rng.integers(2))
        point[axis] = lines[axis][np.abs(lines[axis] - point[axis]).argmin()]
    return Polygon(tuple((float(x), float(y)) for x, y in points), factor(rng))


def pixel(rng: Rng, tables: Tables) -> Touch:
    """Any of the grid."""
    row, column = (int(rng.integers(1, tables["pixels"][n] + 1)) for n in ("rows", "columns"))
    return Touch(row, column, factor(rng))


SHAPES = {"rectangle": rectangle, "disc": disc, "polygon": polygon}


def press(rng: Rng, tables: Tables, *shapes: str, most: int = 3) -> Press:
    """One to `most` touches of the shapes named, over each other or not, perhaps over a pixel."""
    lines = lines_of(tables)
    names = rng.choice(shapes, int(rng.integers(1, most + 1)))
    touches = [SHAPES[str(name)](rng, lines) for name in names]
    if rng.random() < 0.3:
        touches.append(pixel(rng, tables))
    return Press(tuple(touches))
