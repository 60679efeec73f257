"""Pictures with their texts: title, headings, colour bars, axes, foil names."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..chart_style import STYLE, chart
from ..safe_text import figure_style, rendering
from .axes import (
    NUMBERS_WIDTH,
    colour_bar,
    lines_between_pixels,
    millimetres,
    pixel_names,
    rows_and_columns,
    scale_bar,
)
from .painting import Image, Scenery, foil_colours, paint

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from .camera import Camera
    from .displayed_quantity import DisplayedQuantity
    from .foils import Foil

SINGLE, PANEL, MIN_FIGURE_WIDTH = 5.0, 2.3, 5.0
"""Width of a single panel, of one of several, and the least for a title, inches."""
MAX_HEIGHT = 5.6
"""Largest height of a panel, inches."""
SIDE_WIDTH = 1.85
"""Width of what stands next to each panel, inches."""
LINE, AXES_HEIGHT, TITLE_AND_FOILS = 0.16, 0.85, 0.65
"""Heights of a heading's line, axes and numbers, and title and foil names, inches."""
LEGEND_WIDTH = 2.2
"""Width of a foil's name with its colour, inches."""
PIXELS_PER_INCH = 260
MAX_HIDDEN_NORMAL = -0.1
"""Component of a normal towards the eye below which the skin is turned away."""


@dataclass(frozen=True)
class Panel:
    """Field in its scenery, as a camera sees it."""

    scenery: Scenery
    shown: DisplayedQuantity
    camera: Camera


def draw(path: Path, rows: Sequence[Sequence[Panel]], title: str) -> None:
    """Writes a picture of panels in rows, whole or not at all."""
    with chart(path, *_size(rows)) as figure:
        compose(figure, rows, title)


def rendered(rows: Sequence[Sequence[Panel]], title: str, dpi: int) -> Image:
    """Picture of panels as an array (height, width, 3) with even sides, for movies."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    with figure_style(STYLE):
        figure = Figure(figsize=_size(rows), dpi=dpi, layout="constrained")
        canvas = FigureCanvasAgg(figure)
        compose(figure, rows, title)
        with rendering(figure):
            canvas.draw()
    image = np.asarray(canvas.buffer_rgba())[..., :3]
    height, width = (side - side % 2 for side in image.shape[:2])
    return image[:height, :width].copy()


def _size(rows: Sequence[Sequence[Panel]]) -> tuple[float, float]:
    widths = [[_width(panel, rows) for panel in row] for row in rows]
    heights = [
        max(width * panel.camera.aspect for width, panel in zip(own, row, strict=True))
        + _text_height(row)
        for own, row in zip(widths, rows, strict=True)
    ]
    width = max(map(len, rows)) * (max(map(max, widths)) + SIDE_WIDTH)
    return max(width, MIN_FIGURE_WIDTH), sum(heights) + TITLE_AND_FOILS


def _width(panel: Panel, rows: Sequence[Sequence[Panel]]) -> float:
    """Width of a panel's picture, inches."""
    widest = SINGLE if max(map(len, rows)) == len(rows) == 1 else PANEL
    return min(widest, MAX_HEIGHT / panel.camera.aspect)


def _text_height(row: Sequence[Panel]) -> float:
    """Height of what stands above and below the pictures of a row, inches."""
    lines = max(_heading(panel.shown).count("\n") + 1 for panel in row)
    return LINE * lines + (AXES_HEIGHT if any(panel.camera.above for panel in row) else 0.1)


def compose(figure: Figure, rows: Sequence[Sequence[Panel]], title: str) -> None:
    """Puts panels and texts into a figure."""
    all_axes = figure.subplots(len(rows), max(map(len, rows)), squeeze=False)
    figure.suptitle(title, fontsize=11, fontweight="bold", wrap=True)
    for i, row in enumerate(rows):
        for j, panel in enumerate(row):
            _draw_panel(all_axes[i, j], panel, _width(panel, rows))
            if j and panel.camera.above:
                all_axes[i, j].set_ylabel("")
        for axes in all_axes[i, len(row) :]:
            axes.axis("off")
    _name_foils(figure, rows[0][0])


def _draw_panel(axes: Axes, panel: Panel, width: float) -> None:
    camera, shown, scenery = panel.camera, panel.shown, panel.scenery
    pixels = round(width * PIXELS_PER_INCH * max(1.0, camera.aspect))
    marks = replace(scenery.marks, pixels=()) if camera.above else scenery.marks
    painted = paint(replace(scenery, marks=marks), shown, camera, pixels)
    axes.imshow(painted, extent=camera.extent, interpolation="hanning")
    if camera.above:
        lines_between_pixels(axes, camera, scenery.marks)
    axes.set_title(_heading(shown), fontsize=8.5)
    axes.grid(False)
    axes.spines[:].set_visible(False)
    lines = scenery.marks.grid_lines if camera.above else None
    if camera.above:
        millimetres(axes, scenery.skin)
    else:
        scale_bar(axes, camera)
    if lines:
        rows_and_columns(axes, lines, width)
    else:
        pixel_names(axes, camera, scenery.skin, scenery.marks)
    colour_bar(axes, shown, NUMBERS_WIDTH if lines else 0.1, width)


def _heading(shown: DisplayedQuantity) -> str:
    return "\n".join(filter(None, (shown.title, shown.moment, shown.note)))


def _name_foils(figure: Figure, panel: Panel) -> None:
    """Writes the foils' names and colours below all panels."""
    from matplotlib.patches import Patch

    foils = panel.scenery.marks.foils
    colours = foil_colours(foils)
    lines = -(-len(foils) // max(1, int(figure.get_figwidth() / LEGEND_WIDTH)))
    figure.legend(
        handles=[Patch(color=colours[foil.name], label=_foil_label(foil, panel)) for foil in foils],
        loc="outside lower center",
        ncols=-(-len(foils) // lines),
        fontsize=9,
    )


def _foil_label(foil: Foil, panel: Panel) -> str:
    """Label of a foil, which notes if it is behind the body the skin is wrapped on."""
    skin = panel.scenery.skin
    normal = skin.normals[:, skin.nearest(foil.middle[:, None])[0]]
    behind = normal @ panel.camera.towards < MAX_HIDDEN_NORMAL
    return f"{foil.label}, behind" if behind else foil.label
