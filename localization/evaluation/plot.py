"""Charts of the localizer."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.colors import to_rgb

from .confusion import Confusion

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

RIGHT, WRONG = "#56b4e9", "#e69f00"
"""Sky blue and orange of M. Okabe and K. Ito, "Color Universal Design" (2008): told apart by all
eyes, and light enough in grey print for black figures on them."""
MOST_WRITTEN, MOST_NAMED = 26, 50
"""Classes of a matrix whose counts are written into it, and that are all named beside it."""


def draw_confusion(axes: Axes, confusion: Confusion) -> None:
    """Draw counts and percent of all sweeps, output class downwards, target class to the right.

    A cell is the fuller of colour, the greater its share of the target class; the title tells the
    accuracy. This is the layout of MATLAB's `plotconfusion`.
    """
    classes = np.arange(len(confusion.labels))
    axes.imshow(_colours(confusion))
    shown = classes[:: 1 + len(classes) // MOST_NAMED]
    names = [str(confusion.labels[k]) for k in shown]
    axes.set_xticks(shown, names, rotation=90 if len(max(names, key=len)) > 3 else 0)
    axes.set_yticks(shown, names)
    axes.set_xlabel("Target class")
    axes.set_ylabel("Output class")
    axes.set_title(
        f"Accuracy {100 * confusion.accuracy:.1f} % ({confusion.correct} of {confusion.total})"
    )
    if len(classes) <= MOST_WRITTEN:
        _rule_cells(axes, classes)
        _write_counts(axes, confusion)


def _colours(confusion: Confusion) -> NDArray[np.float64]:
    """Red, green, blue of each cell, shape (output class, target class, 3)."""
    counts = confusion.counts.T
    share = (counts / np.maximum(counts.sum(axis=0), 1))[..., np.newaxis]
    correct = np.eye(len(counts), dtype=bool)[..., np.newaxis]
    full = np.where(correct, to_rgb(RIGHT), to_rgb(WRONG))
    faintest = 0.25
    strength = np.where(share > 0, faintest + (1 - faintest) * share, 0)
    return 1 - strength * (1 - full)


def _rule_cells(axes: Axes, classes: NDArray[np.intp]) -> None:
    edges = classes[:-1] + 0.5
    axes.set_xticks(edges, minor=True)
    axes.set_yticks(edges, minor=True)
    axes.grid(which="minor", color="0.6", linewidth=0.8)
    axes.tick_params(which="both", length=0)


def _write_counts(axes: Axes, confusion: Confusion) -> None:
    for (target, output), count in np.ndenumerate(confusion.counts):
        axes.text(
            target,
            output,
            f"{count}\n{100 * count / confusion.total:.1f} %",
            ha="center",
            va="center",
            fontsize=min(10, 60 / len(confusion.labels)),
            color="black" if count else "0.55",
        )


def draw_error_map(axes: Axes, truth: NDArray[np.float64], distance: NDArray[np.float64]) -> None:
    """Each touch at its place in mm, coloured by how far from it the answer lay.

    truth: x and y in mm first, shape (touch, >= 2). distance: mm, shape (touch,).
    """
    worst = float(np.quantile(distance, 0.95))
    dots = axes.scatter(*truth.T[:2], c=distance, s=12, cmap="cividis", vmin=0, vmax=worst)
    axes.figure.colorbar(dots, ax=axes, label="Error (mm)", extend="max")
    axes.set_aspect("equal")
    axes.set_xlabel("x (mm)")
    axes.set_ylabel("y (mm)")
    axes.set_title(f"Errors of {distance.size} touches, where they were")


def draw_errors(axes: Axes, distance: NDArray[np.float64], label: str | None = None) -> None:
    """How many of the touches are placed within so many mm.

    distance: mm, shape (touch,).
    """
    share = 100 * np.arange(1, distance.size + 1) / distance.size
    axes.plot(np.sort(distance), share, label=label)
    axes.set_xlim(0, None)
    axes.set_ylim(0, 100)
    axes.grid(color="0.88")
    axes.set_xlabel("Error (mm)")
    axes.set_ylabel("Touches placed within (%)")
    median, most = np.quantile(distance, [0.5, 0.9])
    axes.set_title(f"Median {median:.1f} mm, 90 % within {most:.1f} mm")
