"""Charts of confusion matrices and of position errors."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.colors import to_rgb

from ...simulator.chart_style import COLOURS
from .confusion import Confusion

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from ...simulator.arrays import Real

RIGHT, WRONG = COLOURS[5], COLOURS[4]
"""Sky blue and orange: light enough in grey print for black figures on them."""
SILENT = "0.7"
MAX_LABELLED_CLASSES = 50
"""Maximum number of classes with a label each."""
MAX_FONT_SIZE, MIN_FONT_SIZE, MIN_FONT_SIZE_OF_TWO = 11.0, 4.0, 6.5
"""Font sizes in points: maximum, minimum alone, and minimum with the percentage below."""
NOTHING_PRESSED = "0"
LETTER = 0.62
"""Width of a digit divided by its size."""


def draw_confusion(axes: Axes, confusion: Confusion, title: str = "Accuracy") -> None:
    """Draw counts and percent of all sweeps as a matrix.

    The output class runs downwards, the target class to the right; sweeps without an answer stand
    in the last row, in grey. The colour of a cell shows its
    share of the target class; cells with zero are empty; the percentage is left out if it does not
    fit. The title states the accuracy by its name. This is the layout of MATLAB's `plotconfusion`.
    """
    axes.grid(False)
    classes, outputs = np.arange(len(confusion.labels)), np.arange(len(confusion.outputs))
    axes.imshow(_colours(confusion))
    shown = classes[:: 1 + len(classes) // MAX_LABELLED_CLASSES]
    labels = [str(label) for label in confusion.outputs]
    labels = ["none" if label == NOTHING_PRESSED else label for label in labels]
    names, told = [labels[k] for k in shown], [*shown, *outputs[len(classes) :]]
    cell = _cell(axes, len(outputs))
    longest = len(max(names, key=len))
    size = min(
        MAX_FONT_SIZE,
        max(MIN_FONT_SIZE, 0.6 * cell * (shown[1] - shown[0] if shown.size > 1 else 1)),
    )
    upright = LETTER * size * longest > cell
    axes.set_xticks(shown, names, rotation=90 if upright else 0, fontsize=size)
    axes.set_yticks(told, [labels[k] for k in told], fontsize=size)
    large = max(10.0, 1.25 * cell * len(classes) / 72)
    axes.set_xlabel("Target class", fontsize=large)
    axes.set_ylabel("Output class", fontsize=large)
    axes.set_title(
        f"{title} {100 * confusion.accuracy:.1f} % ({confusion.correct} of {confusion.total})",
        fontsize=1.1 * large,
    )
    if classes.size <= MAX_LABELLED_CLASSES:
        _rule_cells(axes, classes, outputs)
    _write_counts(axes, confusion, cell)


def _cell(axes: Axes, classes: int) -> float:
    """Side of a cell in points."""
    box = axes.get_position().transformed(axes.figure.transSubfigure)
    return 72 * min(box.width, box.height) / axes.figure.dpi / classes


def _colours(confusion: Confusion) -> Real:
    """RGB colour of each cell, shape (output class, target class, 3)."""
    counts = confusion.counts.T
    share = (counts / np.maximum(counts.sum(axis=0), 1))[..., np.newaxis]
    correct = np.eye(*counts.shape, dtype=bool)[..., np.newaxis]
    full = np.where(correct, to_rgb(RIGHT), to_rgb(WRONG))
    full[counts.shape[1] :] = to_rgb(SILENT)
    faintest = 0.25
    strength = np.where(share > 0, faintest + (1 - faintest) * share, 0)
    return 1 - strength * (1 - full)


def _rule_cells(axes: Axes, classes: NDArray[np.intp], outputs: NDArray[np.intp]) -> None:
    axes.set_xticks(classes[:-1] + 0.5, minor=True)
    axes.set_yticks(outputs[:-1] + 0.5, minor=True)
    axes.grid(which="minor", color="0.6", linewidth=0.8)
    axes.tick_params(which="both", length=0)


def _write_counts(axes: Axes, confusion: Confusion, cell: float) -> None:
    """Write counts as large as they fit, with the percentage if it is readable."""
    digits = len(str(confusion.counts.max(initial=0)))
    alone = min(MAX_FONT_SIZE, 0.9 * cell / (LETTER * digits), 0.7 * cell)
    both = min(MAX_FONT_SIZE, 0.9 * cell / (LETTER * len("99.9 %")), 0.4 * cell)
    if alone < MIN_FONT_SIZE:
        return
    for (target, output), count in np.ndenumerate(confusion.counts):
        if count:
            percent = (
                f"\n{100 * count / confusion.total:.1f} %" if both >= MIN_FONT_SIZE_OF_TWO else ""
            )
            axes.text(
                target,
                output,
                f"{count}{percent}",
                ha="center",
                va="center",
                fontsize=both if percent else alone,
            )


def draw_error_map(axes: Axes, truth: Real, distance: Real) -> None:
    """Draw each touched place in mm, coloured by the median distance of its predictions.

    truth: x and y in mm first, shape (touch, >= 2). distance: mm, shape (touch,).
    """
    places, which = np.unique(truth[:, :2], axis=0, return_inverse=True)
    medians = np.array([np.median(distance[which.ravel() == k]) for k in range(len(places))])
    worst = float(np.quantile(medians, 0.95))
    dots = axes.scatter(*places.T, c=medians, s=12, cmap="cividis", vmin=0, vmax=worst)
    axes.figure.colorbar(dots, ax=axes, label="Error (mm)", extend="max")
    axes.set_aspect("equal")
    axes.set_xlabel("x (mm)")
    axes.set_ylabel("y (mm)")
    repeated = len(places) < distance.size
    at = f"Median errors at the {len(places)} places of" if repeated else "Errors of"
    axes.set_title(f"{at} {distance.size} touches")


def draw_errors(axes: Axes, distance: Real) -> None:
    """Draw the share of touches that are placed within a distance.

    distance: mm, shape (touch,).
    """
    share = 100 * np.arange(1, distance.size + 1) / distance.size
    axes.plot(np.sort(distance), share)
    axes.set_xlim(0, None)
    axes.set_ylim(0, 100)
    axes.set_xlabel("Error (mm)")
    axes.set_ylabel("Touches placed within (%)")
    median, most = np.quantile(distance, [0.5, 0.9])
    axes.set_title(f"Median {median:.1f} mm, 90 % within {most:.1f} mm")
