"""Pictures with their texts: title, headings, axes in mm, row and column numbers, colour bars."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Real
from ..chart_style import STYLE, chart
from ..safe_text import figure_style, rendering
from .painting import HALO, SHADE, Image, Scenery, foil_colours, paint

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from .camera import Camera
    from .displayed_quantity import DisplayedQuantity
    from .foils import Foil
    from .marks import Marks
    from .skin_surface import SkinSurface

MILLI = 1e3
ROUND_LENGTHS = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)
"""Lengths of a scale bar, mm."""
NUMBER_ROOM = 0.2
"""Room for the number of a row or column, inches."""
NUMBERS_WIDTH = 0.45
"""Width of the numbers of rows with their word, inches."""
BAR_WIDTH, BAR_ROOM = 0.13, 1.05
"""Width of a colour bar, without and with its numbers and unit, inches."""
NUMBER_COLOUR = "0.35"
HALO_WIDTH, SHADE_WIDTH = 1.3, 0.6
"""Widths of the white and the black of a line between pixels, points."""
MAX_NAMED_PIXELS = 12
"""Largest number of pixels along a grid's side at which each is named."""
MIN_FACING = 0.3
"""Component of a normal towards the eye up to which pixels are not named."""


def millimetres(axes: Axes, skin: SkinSurface) -> None:
    """Draws axes in mm along the skin's sides, next to its foils."""
    from matplotlib.ticker import MaxNLocator

    for axis, side, values in zip(
        (axes.xaxis, axes.yaxis), ("bottom", "left"), MILLI * skin.points[:2], strict=True
    ):
        low, high = float(values.min()), float(values.max())
        ticks = MaxNLocator(6, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high)
        rounding = 1e-6 * (high - low)
        axis.set_ticks([float(t) for t in ticks if low - rounding <= t <= high + rounding])
        axes.spines[side].set_visible(True)
        axes.spines[side].set_bounds(low, high)
    axes.set_xlabel("x (mm)")
    axes.set_ylabel("y (mm)")


def rows_and_columns(axes: Axes, lines: tuple[Real, Real], panel_width: float) -> None:
    """Writes the numbers of columns above the skin and of rows at its right.

    lines: between pixels, across x and y, m. panel_width: inches.
    """
    above, beside = axes.secondary_xaxis("top"), axes.secondary_yaxis("right")
    x, y = (MILLI * each for each in lines)
    left, right, bottom, top = axes.get_images()[0].get_extent()
    height = panel_width * (top - bottom) / (right - left)
    for axis, word, ends, length in (
        (above.xaxis, "column", x, panel_width * np.ptp(x) / (right - left)),
        (beside.yaxis, "row", y, height * np.ptp(y) / (top - bottom)),
    ):
        middles = (ends[:-1] + ends[1:]) / 2
        step = int(np.ceil(middles.size * NUMBER_ROOM / max(length, NUMBER_ROOM)))
        axis.set_ticks(middles[::step], [str(n) for n in range(1, middles.size + 1, step)])
        axis.set_label_text(word, fontsize=8, color=NUMBER_COLOUR)
    for each in (above, beside):
        each.tick_params(length=0, labelsize=8, labelcolor=NUMBER_COLOUR, pad=1)
        each.spines[:].set_visible(False)


def lines_between_pixels(axes: Axes, camera: Camera, marks: Marks) -> None:
    """Draws the lines between pixels.

    They are thin and unbroken at any size, since they lie along rows of the picture's own pixels.
    """
    limits = axes.axis()
    for line in marks.pixels:
        x, y = MILLI * camera.project(line)
        axes.plot(x, y, color="white", alpha=HALO, lw=HALO_WIDTH, snap=True)
        axes.plot(x, y, color="black", alpha=SHADE, lw=SHADE_WIDTH, snap=True)
    axes.axis(limits)


def pixel_names(axes: Axes, camera: Camera, skin: SkinSurface, marks: Marks) -> None:
    """Writes row,column on pixels that face the eye.

    In a grid of many pixels only one row and one column have names.
    """
    from matplotlib.patheffects import withStroke

    there = np.isfinite(marks.middles).all(axis=0)
    facing = np.zeros(there.shape)
    facing[there] = camera.towards @ skin.normals[:, skin.nearest(marks.middles[:, there])]
    if marks.grid_lines and max(facing.shape) > MAX_NAMED_PIXELS:
        column = int(np.argmax(facing.sum(axis=0)))
        facing[1:, np.arange(len(facing[0])) != column] = 0.0
    outlined = [withStroke(linewidth=1.8, foreground="0.15")]
    white = {"fontsize": 7, "color": "white", "ha": "center", "va": "center"}
    for row, column in np.argwhere(facing > MIN_FACING):
        x, y = (MILLI * camera.project(marks.middles[:, row, column])).tolist()
        axes.text(x, y, f"{row + 1},{column + 1}", path_effects=outlined, **white)


def scale_bar(axes: Axes, camera: Camera) -> None:
    """Draws a length in mm, where there are no axes."""
    axes.set_xticks([])
    axes.set_yticks([])
    left, right, bottom, top = camera.extent
    length = max(each for each in ROUND_LENGTHS if each == 1 or each <= 0.2 * (right - left))
    x, y = left + 0.02 * (right - left), bottom + 0.03 * (top - bottom)
    axes.plot([x, x + length], [y, y], color="black", lw=2.5, solid_capstyle="butt")
    axes.text(x + length / 2, y, f"{length} mm", ha="center", va="bottom", fontsize=8)


def colour_bar(axes: Axes, shown: DisplayedQuantity, off: float, panel_width: float) -> None:
    """Draws the colour bar at the panel's right.

    It takes the same room whatever its numbers are: movies stand still. off: distance from the
    panel. panel_width: both in inches.
    """
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize
    from matplotlib.patches import Rectangle

    start = 1 + off / panel_width
    room = Rectangle((start, 0), BAR_ROOM / panel_width, 1, transform=axes.transAxes, alpha=0)
    axes.add_patch(room).set_clip_on(False)

    mappable = ScalarMappable(Normalize(*shown.limits), shown.colours)
    bar = axes.figure.colorbar(
        mappable,
        cax=axes.inset_axes((start, 0.0, BAR_WIDTH / panel_width, 1.0)),
        extend=shown.beyond,
    )
    bar.set_label(shown.unit)
    bar.ax.grid(False)
    bar.ax.set_in_layout(False)
    bar.outline.set_visible(False)
    if shown.cyclic:
        bar.set_ticks([float(angle) for angle in range(-180, 181, 60)])


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
