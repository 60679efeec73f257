"""How meter, switch and skin are wired: `results/wiring.svg`, for the page on the meter."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib as mpl
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle
from rcskin.benchmarks.bench import Run, launch

if TYPE_CHECKING:
    from matplotlib.axes import Axes

HIGH, LOW, GROUND, SHEET = "#b5442c", "#22557f", "#7a7a7a", "#d9d9d9"
TERMINALS = {"H CUR": (HIGH, 5.3), "H POT": (HIGH, 4.8), "L POT": (LOW, 4.3), "L CUR": (LOW, 3.8)}
CORNERS = ((7.6, 0.0), (11.2, 0.0), (12.4, 1.3), (8.8, 1.3))
"""Of a sheet as it is seen from the side, left and front first."""
LEVELS = {"top sheet": 4.9, "foam": 3.1, "bottom sheet": 1.3}
GAP = 0.08
"""Of an edge, without foil at both ends."""


def _box(axes: Axes, left: float, low: float, wide: float, high: float, text: str) -> None:
    axes.add_patch(Rectangle((left, low), wide, high, fc="white", ec="black", lw=1.2))
    axes.text(left + wide / 2, low + high + 0.12, text, ha="center", va="bottom", weight="bold")


def _sheet(axes: Axes, name: str, level: float, colour: str) -> None:
    corners = [(x, y + level) for x, y in CORNERS]
    foam = name == "foam"
    axes.add_patch(Polygon(corners, fc="#f3e6b8" if foam else SHEET, ec="black", lw=0.8))
    axes.text(10.2, level + 0.65, name, ha="center", va="center")
    if not foam:
        for start, end in ((3, 0), (0, 1)):
            (x, y), (u, v) = corners[start], corners[end]
            xs = [x + GAP * (u - x), u + GAP * (x - u)]
            axes.plot(xs, [y + GAP * (v - y), v + GAP * (y - v)], color=colour, lw=5)


def _meter(axes: Axes) -> None:
    _box(axes, 0.2, 3.3, 1.7, 2.5, "LCR meter")
    for name, (colour, y) in TERMINALS.items():
        axes.text(0.35, y, name, va="center", size=9)
        axes.plot([1.9], [y], "o", color=colour, ms=7)
        joined = 5.05 if colour == HIGH else 4.05
        axes.plot([1.9, 3.3, 3.6, 4.2], [y, y, joined, joined], color=colour, lw=1.6)
        axes.plot([2.2, 3.2], [y - 0.13, y - 0.13], color=GROUND, lw=1, ls=":")
    axes.plot([3.2, 3.2], [5.17, 3.67], color=GROUND, lw=1, ls=":")
    axes.text(2.7, 3.2, "shields joined\nat the far end", ha="center", va="top", size=8)


def _switch(axes: Axes) -> None:
    _box(axes, 4.2, 3.3, 1.7, 2.5, "switch")
    for colour, y in ((HIGH, 5.05), (LOW, 4.05)):
        axes.plot([4.2, 4.6, 5.45], [y, y, y + 0.3], color=colour, lw=1.6)
        axes.plot([4.6, 5.5, 5.5], [y, y + 0.3, y - 0.3], "o", color="black", ms=3)
    axes.text(5.05, 3.45, "left | bottom", ha="center", size=9)


def _leads(axes: Axes) -> None:
    left, front = 8.0, 9.0
    ends = {HIGH: ("top sheet", 5.05), LOW: ("bottom sheet", 4.05)}
    for colour, (name, y) in ends.items():
        level = LEVELS[name]
        of_left, of_front = (left, level + 0.43), (front, level)
        lane = 6.6 if colour == HIGH else 6.9
        axes.plot(
            [5.5, lane, lane, of_left[0]], [y + 0.3, y + 0.3, of_left[1], of_left[1]], color=colour
        )
        under = level - 0.3
        aside = lane - 0.5
        axes.plot(
            [5.5, aside, aside, of_front[0], of_front[0]],
            [y - 0.3, y - 0.3, under, under, of_front[1]],
            color=colour,
            ls="--",
        )


def _computer(axes: Axes) -> None:
    _box(axes, 2.1, 0.3, 2.4, 0.9, "computer: rcskin")
    axes.plot([1.05, 1.05, 2.1], [3.3, 0.75, 0.75], color="black", lw=1)
    axes.plot([5.05, 5.05, 4.5], [3.3, 0.75, 0.75], color="black", lw=1)
    axes.text(1.0, 1.9, "LAN, USB,\nRS-232, GP-IB", ha="right", va="center", size=8, rotation=90)
    axes.text(4.95, 2.1, "serial, SCPI,\ncommand", ha="right", va="center", size=8)


def draw(path: Path) -> None:
    """The drawing, as a file of the path's ending."""
    figure = Figure(figsize=(9.6, 4.9), layout="constrained")
    axes = figure.add_subplot(aspect="equal", xlim=(0, 12.6), ylim=(0.1, 6.4))
    axes.set_axis_off()
    for name, colour in (("bottom sheet", LOW), ("foam", ""), ("top sheet", HIGH)):
        _sheet(axes, name, LEVELS[name], colour)
    _meter(axes)
    _switch(axes)
    _leads(axes)
    _computer(axes)
    for y, style, text in ((0.6, "-", 'interface "left"'), (0.25, "--", 'interface "bottom"')):
        axes.plot([9.2, 9.8], [y, y], color="black", ls=style)
        axes.text(9.95, y, text, va="center", size=9)
    with mpl.rc_context({"svg.hashsalt": "rcskin", "svg.fonttype": "none"}):
        figure.savefig(path, metadata={"Date": None} if path.suffix == ".svg" else None)


def main(run: Run) -> None:
    """Draw it."""
    draw(run.results / "wiring.svg")


if __name__ == "__main__":
    launch(main)
