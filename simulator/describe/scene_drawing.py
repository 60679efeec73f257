"""A scene drawn from above: its outline, foils with their names, and pixels with their numbers."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING

import numpy as np

from ..chart_style import FOIL_COLOURS, chart, foil_offset
from ..measure.symmetry import Pixel
from ..mesh.skin_mesh import domain
from ..press.press import Press
from ..report.from_above import (
    MM,
    Places,
    Ribbon,
    draw_foils,
    draw_outline,
    draw_pixels,
    outline,
    ribbon,
)
from ..scene.contacts import Contact
from ..scene.scene import Scene
from ..sweeps import checked_output
from .distinct_pixels import label_position

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ENDINGS = (".png", ".svg", ".pdf")
WIDTH = 6.4
"""Of the picture, inches."""
TALLEST, FLATTEST = 1.5, 0.45
"""Height of the picture over its width."""
BESIDE = {-1.0: "right", 0.0: "center", 1.0: "left"}
ABOVE = {-1.0: "top", 0.0: "center", 1.0: "bottom"}
NAME_AT, NUMBERS, MARGIN = 0.07, 0.06, 0.03
"""Of the longer side: from the edge to a foil's name, for numbers of rows and columns, and around
all."""
LINE = 11.0
"""From the name of one foil to that of another at the same place, points."""
UPRIGHT, SLANTED = 0.9, 0.35
"""Parts of the way off the skin: from where on names stand upright, and beside, not above."""
MOST_NAMED = 12
"""Pixels along a side up to which each is named; beyond, rows and columns are numbered alone."""
LETTERS = 120.0
"""Points of a pixel's name, for a pixel as wide as the skin."""
TITLE = 72
"""Letters of a line of the title."""

Span = tuple[float, float]


def draw_scene(scene: Scene, pixels: list[Pixel], path: str | Path) -> Path:
    """Draw a scene as a picture, .png, .svg or .pdf, whose path is given back.

    pixels: those that have skin. Raises InputError for another ending or an absent folder, and
    where a mesh file does not serve.
    """
    path = checked_output(path, ENDINGS)
    ribbons = [ribbon(foil, scene) for foil in scene.contacts]
    x, y = _frame(scene, ribbons)
    tall = float(np.clip((y[1] - y[0]) / (x[1] - x[0]), FLATTEST, TALLEST))
    with chart(path, WIDTH, WIDTH * tall + 0.5) as figure:
        axes = figure.add_subplot()
        _dress(axes, scene, x, y)
        _skin(axes, scene)
        _pixels(axes, scene, pixels, (x[1], y[1]))
        _foils(axes, scene, ribbons)
    return path


def _frame(scene: Scene, ribbons: Sequence[Ribbon]) -> tuple[Span, Span]:
    """What is drawn from where to where, along x and y, m: the skin with names and numbers."""
    length, width = scene.skin.sides
    unit = max(length, width)
    ways = [out for ribbon in ribbons for _, out in [_named_at(ribbon, 0.0)]]

    def beside(axis: int, sign: float) -> float:
        beyond = sum(sign * out[axis] > SLANTED for out in ways)
        return unit * (MARGIN + (NAME_AT + 0.02 + 0.03 * (beyond - 1) if beyond else 0.0))

    numbers = NUMBERS * unit
    return (
        (-beside(0, -1), length + beside(0, 1) + numbers),
        (-beside(1, -1), width + beside(1, 1) + numbers),
    )


def _dress(axes: Axes, scene: Scene, x: Span, y: Span) -> None:
    axes.set_aspect("equal")
    axes.grid(False)
    axes.set_xlim(MM * x[0], MM * x[1])
    axes.set_ylim(MM * y[0], MM * y[1])
    axes.set_xlabel("x (mm)")
    axes.set_ylabel("y (mm)")
    told = f"{scene.name}: {scene.description}" if scene.description else scene.name
    axes.set_title(fill(told, TITLE))


def _skin(axes: Axes, scene: Scene) -> None:
    """The skin in grey within its outline; of a mesh its triangles."""
    if scene.skin.mesh is not None:
        mesh = domain(scene, Press(), max(scene.skin.sides))
        axes.triplot(*(MM * mesh.p[:2]), mesh.t.T, color="0.8", linewidth=0.4)
    else:
        first, *holes = outline(scene)
        axes.fill(*(MM * first), facecolor="0.96", zorder=1)
        for hole in holes:
            axes.fill(*(MM * hole), facecolor="white", zorder=1)
    draw_outline(axes, scene, linewidth=1.2, zorder=3)


def _pixels(axes: Axes, scene: Scene, pixels: list[Pixel], far: tuple[float, float]) -> None:
    """Lines and names of pixels; numbers of rows and columns stand before `far` (x, y), m."""
    (length, width), (rows, columns) = scene.skin.sides, scene.pixels.shape
    draw_pixels(axes, scene, color="0.6", linewidth=0.7, linestyle=(0, (4, 3)), zorder=1.5)
    if max(rows, columns) <= MOST_NAMED:
        for row, column in pixels:
            (x, y), size = label_position((row, column), scene)
            points = float(np.clip(size / max(length, width) * LETTERS, 3, 9))
            centred = {"ha": "center", "va": "center", "color": "0.25", "zorder": 3.5}
            axes.text(MM * x, MM * y, f"{row},{column}", size=points, **centred)
    before = MARGIN * max(length, width)
    grey = {"color": "0.5", "size": 8}
    for name, number, x in _shown("column", length, columns):
        at = MM * x, MM * (far[1] - before)
        axes.text(*at, f"{name}{number}", ha="center", va="center", **grey)
    for name, number, y in _shown("row", width, rows):
        at = MM * (far[0] - before), MM * y
        axes.text(*at, f"{name}{number}", ha="center", va="center", rotation=90, **grey)


def _shown(name: str, side: float, count: int) -> Iterator[tuple[str, int, float]]:
    """Rows or columns that are numbered, with their middles, m; the first is called by name."""
    for k in range(0, count, -(-count // MOST_NAMED)):
        yield f"{name} " if k == 0 else "", k + 1, side * (k + 0.5) / count


def _named_at(foil: Ribbon, gap: float) -> tuple[Places, Places]:
    """Where a foil's name stands, m, and the way off the skin there: that far off its middle.

    Of a foil that goes all around a curve it is below the skin.
    """
    if foil.closed:
        x = float(foil.path[0].min() + foil.path[0].max()) / 2
        return np.array([x, -gap]), np.array([0.0, -1.0])
    half = foil.path.shape[1] // 2
    return foil.beside(gap)[:, half], foil.out[:, half]


def _foils(axes: Axes, scene: Scene, ribbons: Sequence[Ribbon]) -> None:
    stacked: dict[tuple[int, int], int] = defaultdict(int)
    longest = max(scene.skin.sides)
    draw_foils(axes, scene, linewidth=4)
    for foil, line in zip(scene.contacts, ribbons, strict=True):
        at, out = _named_at(line, NAME_AT * longest)
        place = round(MM * float(at[0])), round(MM * float(at[1]))
        if line.closed:
            x, y = MM * at
            ends = [y, MM * np.nanmin(line.beside(foil_offset(foil.electrode, longest))[1])]
            axes.plot([x, x], ends, color=FOIL_COLOURS[foil.electrode], linewidth=0.8, zorder=3.4)
        _name(axes, foil, scene, MM * at, out, stacked[place])
        stacked[place] += 1


def _name(axes: Axes, foil: Contact, scene: Scene, at: Places, out: Places, before: int) -> None:
    right, up = (float(np.sign(part)) if abs(part) > SLANTED else 0.0 for part in out)
    upright = abs(out[0]) > UPRIGHT
    away = (right * LINE * before, 0.0) if upright else (0.0, (up or -1.0) * LINE * before)
    axes.annotate(
        f"{foil.name}, {foil.electrode} ({_role(foil, scene)})",
        (float(at[0]), float(at[1])),
        xytext=away,
        textcoords="offset points",
        rotation=90 if upright else 0,
        ha="center" if upright else BESIDE[right],
        va="center" if upright else ABOVE[up],
        color=FOIL_COLOURS[foil.electrode],
        size=8,
        annotation_clip=False,
        zorder=5,
        bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.7, "pad": 0.5},
    )


def _role(foil: Contact, scene: Scene) -> str:
    """At which interfaces it is which side."""
    several = len(scene.interfaces) > 1
    roles = [
        f"{side} at {each.name}" if several else side
        for each in scene.interfaces
        for side, names in (("high", each.high), ("low", each.low))
        if foil.name in names
    ]
    return ", ".join(roles) or "floats"
