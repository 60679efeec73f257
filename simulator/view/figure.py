"""Pictures with their words: title, colour bars with units, axes in mm, names of the foils."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..charts import STYLE, chart
from .painting import ROLE_COLOURS, Image, Scenery, paint

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from .camera import Camera
    from .foils import Foil
    from .shown import Shown

SINGLE, PANEL, LEAST_WIDTH = 5.6, 3.3, 4.0
"""Width of a picture's panel, of one among several, and the least for the title, inches."""
PIXELS_PER_INCH = 260
FAR_SIDE = -0.1
"""Of a normal along the line of sight: where the skin is turned away."""
HIGHEST = 5.6
"""Of a panel, inches."""
ROUND_LENGTHS = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)
"""Of a scale bar, mm."""


@dataclass(frozen=True)
class Panel:
    """A field in its scenery, as a camera sees it."""

    scenery: Scenery
    shown: Shown
    camera: Camera


def draw(path: Path, rows: Sequence[Sequence[Panel]], title: str) -> None:
    """Write a PNG of panels in rows, whole or not at all."""
    with chart(path, *_size(rows)) as figure:
        compose(figure, rows, title)


def rendered(rows: Sequence[Sequence[Panel]], title: str, dpi: int) -> Image:
    """The same picture as an array (height, width, 3) with even sides, for movies."""
    from matplotlib import rc_context
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    with rc_context(STYLE):
        figure = Figure(figsize=_size(rows), dpi=dpi, layout="constrained")
        canvas = FigureCanvasAgg(figure)
        compose(figure, rows, title)
        canvas.draw()
    image = np.asarray(canvas.buffer_rgba())[..., :3]
    height, width = (side - side % 2 for side in image.shape[:2])
    return image[:height, :width].copy()


def _size(rows: Sequence[Sequence[Panel]]) -> tuple[float, float]:
    columns = max(map(len, rows))
    width = SINGLE if columns == len(rows) == 1 else PANEL
    aspects = [max(panel.camera.aspect for panel in row) for row in rows]
    heights = [min(width * aspect, HIGHEST) for aspect in aspects]
    if columns == len(rows) == 1:
        width = max(heights[0] / aspects[0], LEAST_WIDTH)
    return columns * (width + 1.0), sum(heights) + 0.8 * len(rows) + 0.3


def compose(figure: Figure, rows: Sequence[Sequence[Panel]], title: str) -> None:
    """Put panels and words into a figure."""
    columns = max(map(len, rows))
    alone = columns == len(rows) == 1
    all_axes = figure.subplots(len(rows), columns, squeeze=False)
    figure.suptitle(title, fontsize=11, fontweight="bold", wrap=True)
    for i, row in enumerate(rows):
        for j, panel in enumerate(row):
            _draw_panel(all_axes[i, j], panel, SINGLE if alone else PANEL)
            if i == j == 0:
                _name_foils(all_axes[i, j], panel, 8 if alone else 6)
        for axes in all_axes[i, len(row) :]:
            axes.axis("off")


def _draw_panel(axes: Axes, panel: Panel, width: float) -> None:
    camera, shown = panel.camera, panel.shown
    pixels = round(width * PIXELS_PER_INCH * max(1.0, camera.aspect))
    axes.imshow(paint(panel.scenery, shown, camera, pixels), extent=camera.extent)
    axes.set_title("\n".join(filter(None, (shown.title, shown.moment, shown.note))), fontsize=8.5)
    axes.grid(False)
    for spine in axes.spines.values():
        spine.set_visible(False)
    if camera.above:
        _millimetres(axes, panel)
    else:
        axes.set_xticks([])
        axes.set_yticks([])
        _scale_bar(axes, camera)
    _colour_bar(axes, shown)


def _millimetres(axes: Axes, panel: Panel) -> None:
    from matplotlib.ticker import MaxNLocator

    for axis, values in zip((axes.xaxis, axes.yaxis), 1e3 * panel.scenery.skin.x, strict=True):
        low, high = values.min(), values.max()
        ticks = MaxNLocator(6, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high)
        rounding = 1e-6 * (high - low)
        kept = [float(t) for t in ticks if low - rounding <= t <= high + rounding]
        axis.set_ticks(kept)
    axes.set_xlabel("x (mm)")
    axes.set_ylabel("y (mm)")


def _scale_bar(axes: Axes, camera: Camera) -> None:
    left, right, bottom, top = camera.extent
    length = max(each for each in ROUND_LENGTHS if each == 1 or each <= 0.2 * (right - left))
    x, y = left + 0.02 * (right - left), bottom + 0.03 * (top - bottom)
    axes.plot([x, x + length], [y, y], color="black", lw=2.5, solid_capstyle="butt")
    axes.text(x + length / 2, y, f"{length} mm", ha="center", va="bottom", fontsize=8)


def _name_foils(axes: Axes, panel: Panel, size: float) -> None:
    from matplotlib.patheffects import withStroke

    behind = []
    for foil in panel.scenery.marks.foils:
        name = f"{foil.name} ({foil.role})"
        if _behind(foil, panel):
            behind.append(name)
            continue
        x, y = 1e3 * foil.named_at(panel.camera)
        axes.text(
            x,
            y,
            name,
            color=ROLE_COLOURS[foil.role],
            fontsize=size,
            ha="center",
            va="center",
            rotation=_along(foil, panel.camera),
            rotation_mode="anchor",
            path_effects=[withStroke(linewidth=2.5, foreground="white")],
        )
    if behind:
        told = "behind: " + ", ".join(behind)
        axes.text(1, 0, told, transform=axes.transAxes, fontsize=size, ha="right", va="top")


def _behind(foil: Foil, panel: Panel) -> bool:
    """Whether a foil lies on the far side of what the skin is wrapped on."""
    skin = panel.scenery.skin
    normal = skin.normals[:, skin.nearest(foil.middle[:, None])[0]]
    return bool(normal @ panel.camera.towards < FAR_SIDE)


def _along(foil: Foil, camera: Camera) -> float:
    """The angle of the foil's line in the picture, readable: from -90 to 90 degrees."""
    if foil.closed:
        return 0.0
    x, y = camera.project(foil.along)
    angle = float(np.degrees(np.arctan2(y, x)))
    return (angle + 90 - 1e-9) % 180 - 90 + 1e-9


def _colour_bar(axes: Axes, shown: Shown) -> None:
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    mappable = ScalarMappable(Normalize(*shown.limits), shown.colours)
    bar = axes.figure.colorbar(
        mappable, cax=axes.inset_axes((1.02, 0.0, 0.035, 1.0)), extend=shown.beyond
    )
    bar.set_label(shown.unit)
    bar.ax.grid(False)
    bar.outline.set_visible(False)
    if shown.cyclic:
        bar.set_ticks([float(angle) for angle in range(-180, 181, 60)])
