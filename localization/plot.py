"""Charts of the localizer."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.colors import to_rgb

from localization.confusion import Confusion

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

RIGHT, WRONG = "#56b4e9", "#e69f00"
"""Sky blue and orange of M. Okabe and K. Ito, "Color Universal Design" (2008): told apart by all
eyes, and light enough in grey print for black figures on them."""


def draw_confusion(axes: Axes, confusion: Confusion) -> None:
    """Draw counts and percent of all sweeps, output class downwards, target class to the right.

    A cell is the fuller of colour, the greater its share of the target class; the title tells the
    accuracy. This is the layout of MATLAB's `plotconfusion`.
    """
    classes = np.arange(len(confusion.labels))
    axes.imshow(_colours(confusion))
    axes.set_xticks(classes, [str(label) for label in confusion.labels])
    axes.set_yticks(classes, [str(label) for label in confusion.labels])
    axes.set_xlabel("Target class")
    axes.set_ylabel("Output class")
    axes.set_title(
        f"Accuracy {100 * confusion.accuracy:.1f} % ({confusion.correct} of {confusion.total})"
    )
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
