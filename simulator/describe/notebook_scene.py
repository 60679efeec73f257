"""A scene in a notebook: its key quantities, and the skin from above."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..mesh.from_above import MM, draw_foils, draw_outline, draw_pixels
from ..notebook_display import CLOSE_LEGEND, MARGINS, TOP, SmallChart
from ..press.pixels import pixels_with_skin
from ..report.findings import DataTable, Findings, shown
from ..scene.parts import Skin
from ..scene.scene import Scene
from .distinct_pixels import label_position
from .facts import key_facts

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH = 3.2
LOWEST, HIGHEST = 0.5, 2.6
"""Limits of the height of the skin in the drawing, inches."""
MAX_NAMED, MAX_PIXELS = 8, 60
"""Largest number of pixels along a side that have names, and that are drawn."""
MIN_NAMED = 0.07
"""Width of a pixel that has a name, over the longer side of the skin."""
LAST = ("interface", "foil", "cut-off")
"""Topics of many lines, which stand below the others."""
BESIDE = 0.09
"""Space beside the skin over its longer side."""


def scene_display(scene: Scene) -> str:
    """A scene as HTML: a table of its key quantities, and a drawing in mm."""
    return shown(lambda: _findings(scene))


def _findings(scene: Scene) -> Findings:
    found = sorted(
        key_facts(scene.parts),
        key=lambda fact: LAST.index(fact.about) + 1 if fact.about in LAST else 0,
    )
    table = DataTable("scene", ("about", "value"), found)
    return Findings(f"Scene {scene.title}", [table], small=lambda: _chart(scene))


def _chart(scene: Scene) -> SmallChart:
    length, width = scene.skin.sides
    skin = (WIDTH - MARGINS["left"] - MARGINS["right"]) * width / length
    high = float(np.clip(skin, LOWEST, HIGHEST)) + MARGINS["bottom"] + TOP
    return SmallChart(lambda figure: _draw(figure, scene.parts.skin), WIDTH, high)


def _draw(figure: Figure, skin: Skin) -> None:
    axes = figure.subplots()
    axes.set_aspect("equal")
    axes.grid(False)
    length, width = skin.sides
    beside = BESIDE * max(length, width)
    axes.set_xlim(-MM * beside, MM * (length + beside))
    axes.set_ylim(-MM * beside, MM * (width + beside))
    axes.set_xlabel("x (mm)")
    axes.set_ylabel("y (mm)")
    _draw_pixels(axes, skin)
    draw_outline(axes, skin, zorder=3)
    draw_foils(axes, skin, linewidth=2)
    figure.legend(loc="upper center", ncols=2, **CLOSE_LEGEND)


def _draw_pixels(axes: Axes, skin: Skin) -> None:
    """Draws lines between pixels and their names, as far as there is room for them."""
    most = max(skin.pixels.shape)
    if most <= MAX_PIXELS:
        draw_pixels(axes, skin, color="0.6")
    if most > MAX_NAMED:
        return
    for pixel in pixels_with_skin(skin):
        place, wide = label_position(pixel, skin)
        if wide < MIN_NAMED * max(skin.sides):
            continue
        x, y = MM * place
        axes.text(x, y, "{},{}".format(*pixel), size=6, color="0.35", ha="center", va="center")
