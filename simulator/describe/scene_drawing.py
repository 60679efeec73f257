"""Draws a scene from above: outline, foils with names, and pixels with numbers."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING

import numpy as np

from ..chart_style import FOIL_COLOURS, chart, foil_offset
from ..measure.symmetry import Pixel
from ..mesh.from_above import (
    MM,
    Places,
    Ribbon,
    draw_foils,
    draw_outline,
    draw_pixels,
    outline,
    ribbon,
)
from ..mesh.skin_mesh import domain
from ..press.press import Press
from ..scene.contacts import Contact
from ..scene.parts import Setup, Skin
from ..scene.scene import Scene
from ..sweeps import checked_output
from .distinct_pixels import label_position

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ENDINGS = (".png", ".svg", ".pdf")
WIDTH = 6.4
"""Width of the picture, inches."""
TALLEST, FLATTEST = 1.5, 0.45
"""Limits of the picture's height over its width."""
HORIZONTAL = {-1.0: "right", 0.0: "center", 1.0: "left"}
VERTICAL = {-1.0: "top", 0.0: "center", 1.0: "bottom"}
NAME_AT, NUMBERS, MARGIN = 0.07, 0.06, 0.03
"""Fractions of the longer side: distance of a foil's name from the edge, space for row and column
numbers, and margin."""
LINE = 11.0
"""Distance between names of foils at the same place, points."""
UPRIGHT, SLANTED = 0.9, 0.35
"""Components of the outward direction beyond which names are upright, or next to the skin."""
MAX_NAMED = 12
"""Largest number of pixels along a side with single names; beyond, only rows and columns."""
LETTERS = 120.0
"""Font size of a pixel's name for a pixel as wide as the skin, points."""
TITLE = 72
"""Number of letters in a line of the title."""

Span = tuple[float, float]


def draw_scene(scene: Scene, pixels: list[Pixel], path: str | Path) -> Path:
    """Draws a scene as .png, .svg or .pdf, and returns the path.

    pixels: those with skin. Raises InputError for another ending, a missing folder, and an unusable
    mesh file.
    """
    path = checked_output(path, ENDINGS)
    ribbons = [ribbon(foil, scene.parts.skin) for foil in scene.parts.skin.foils]
    x, y = _frame(scene.parts.skin, ribbons)
    tall = float(np.clip((y[1] - y[0]) / (x[1] - x[0]), FLATTEST, TALLEST))
    with chart(path, WIDTH, WIDTH * tall + 0.5) as figure:
        axes = figure.add_subplot()
        _dress(axes, scene, x, y)
        _skin(axes, scene.parts.skin)
        _pixels(axes, scene.parts.skin, pixels, (x[1], y[1]))
        _foils(axes, scene.parts.skin, scene.parts.setup, ribbons)
    return path


def _frame(skin: Skin, ribbons: Sequence[Ribbon]) -> tuple[Span, Span]:
    """Limits of the drawing along x and y, m: the skin with names and numbers."""
    length, width = skin.sides
    unit = max(length, width)
    directions = [out for ribbon in ribbons for _, out in [_named_at(ribbon, 0.0)]]

    def room(axis: int, sign: float) -> float:
        beyond = sum(sign * out[axis] > SLANTED for out in directions)
        return unit * (MARGIN + (NAME_AT + 0.02 + 0.03 * (beyond - 1) if beyond else 0.0))

    numbers = NUMBERS * unit
    return (
        (-room(0, -1), length + room(0, 1) + numbers),
        (-room(1, -1), width + room(1, 1) + numbers),
    )


def _dress(axes: Axes, scene: Scene, x: Span, y: Span) -> None:
    axes.set_aspect("equal")
    axes.grid(False)
    axes.set_xlim(MM * x[0], MM * x[1])
    axes.set_ylim(MM * y[0], MM * y[1])
    axes.set_xlabel("x (mm)")
    axes.set_ylabel("y (mm)")
    title = f"{scene.name}: {scene.description}" if scene.description else scene.name
    axes.set_title(fill(title, TITLE))


def _skin(axes: Axes, skin: Skin) -> None:
    """Draws the skin in grey within its outline, or the triangles of its mesh."""
    if skin.mesh is not None:
        mesh = domain(skin, Press(), max(skin.sides))
        axes.triplot(*(MM * mesh.p[:2]), mesh.t.T, color="0.8", linewidth=0.4)
    else:
        first, *holes = outline(skin)
        axes.fill(*(MM * first), facecolor="0.96", zorder=1)
        for hole in holes:
            axes.fill(*(MM * hole), facecolor="white", zorder=1)
    draw_outline(axes, skin, linewidth=1.2, zorder=3)


def _pixels(axes: Axes, skin: Skin, pixels: list[Pixel], far: tuple[float, float]) -> None:
    """Draws lines and names of pixels, and row and column numbers near `far` (x, y), m."""
    (length, width), (rows, columns) = skin.sides, skin.pixels.shape
    draw_pixels(axes, skin, color="0.6", linewidth=0.7, linestyle=(0, (4, 3)), zorder=1.5)
    if max(rows, columns) <= MAX_NAMED:
        for row, column in pixels:
            (x, y), size = label_position((row, column), skin)
            points = float(np.clip(size / max(length, width) * LETTERS, 3, 9))
            centred = {"ha": "center", "va": "center", "color": "0.25", "zorder": 3.5}
            axes.text(MM * x, MM * y, f"{row},{column}", size=points, **centred)
    before = MARGIN * max(length, width)
    grey = {"color": "0.5", "size": 8}
    for name, number, x in _numbered("column", length, columns):
        at = MM * x, MM * (far[1] - before)
        axes.text(*at, f"{name}{number}", ha="center", va="center", **grey)
    for name, number, y in _numbered("row", width, rows):
        at = MM * (far[0] - before), MM * y
        axes.text(*at, f"{name}{number}", ha="center", va="center", rotation=90, **grey)


def _numbered(name: str, side: float, count: int) -> Iterator[tuple[str, int, float]]:
    """Yields the numbered rows or columns: prefix (for the first one), number, and middle in m."""
    for k in range(0, count, -(-count // MAX_NAMED)):
        yield f"{name} " if k == 0 else "", k + 1, side * (k + 0.5) / count


def _named_at(foil: Ribbon, gap: float) -> tuple[Places, Places]:
    """Position of a foil's name at distance `gap` from its middle, m, and the outward direction.

    The name of a foil that goes around a whole curve is below the skin.
    """
    if foil.closed:
        x = float(foil.path[0].min() + foil.path[0].max()) / 2
        return np.array([x, -gap]), np.array([0.0, -1.0])
    half = foil.path.shape[1] // 2
    return foil.beside(gap)[:, half], foil.out[:, half]


def _foils(axes: Axes, skin: Skin, setup: Setup, ribbons: Sequence[Ribbon]) -> None:
    stacked: dict[tuple[int, int], int] = defaultdict(int)
    longest = max(skin.sides)
    draw_foils(axes, skin, linewidth=4)
    for foil, line in zip(skin.foils, ribbons, strict=True):
        at, out = _named_at(line, NAME_AT * longest)
        place = round(MM * float(at[0])), round(MM * float(at[1]))
        if line.closed:
            x, y = MM * at
            ends = [y, MM * np.nanmin(line.beside(foil_offset(foil.electrode, longest))[1])]
            axes.plot([x, x], ends, color=FOIL_COLOURS[foil.electrode], linewidth=0.8, zorder=3.4)
        _name(axes, foil, setup, MM * at, out, stacked[place])
        stacked[place] += 1


def _name(axes: Axes, foil: Contact, setup: Setup, at: Places, out: Places, before: int) -> None:
    right, up = (float(np.sign(part)) if abs(part) > SLANTED else 0.0 for part in out)
    upright = abs(out[0]) > UPRIGHT
    away = (right * LINE * before, 0.0) if upright else (0.0, (up or -1.0) * LINE * before)
    axes.annotate(
        f"{foil.name}, {foil.electrode} ({_role(foil, setup)})",
        (float(at[0]), float(at[1])),
        xytext=away,
        textcoords="offset points",
        rotation=90 if upright else 0,
        ha="center" if upright else HORIZONTAL[right],
        va="center" if upright else VERTICAL[up],
        color=FOIL_COLOURS[foil.electrode],
        size=8,
        annotation_clip=False,
        zorder=5,
        bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.7, "pad": 0.5},
    )


def _role(foil: Contact, setup: Setup) -> str:
    """The side of a foil at each interface, as text."""
    several = len(setup.interfaces) > 1
    roles = [
        f"{side} at {each.name}" if several else side
        for each in setup.interfaces
        for side, names in (("high", each.high), ("low", each.low))
        if foil.name in names
    ]
    return ", ".join(roles) or "floats"
