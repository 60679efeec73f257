"""One statement of the paper beside what the physics gives."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import ArrayLike

    from .localizer import Confusion

SIGNIFICANCE = 0.05


@dataclass(frozen=True)
class Claim:
    """A statement of the paper, what the physics gives, whether they agree, and why or why not."""

    topic: str
    source: str
    paper: str
    ours: str
    agrees: bool
    why: str


def listed(values: ArrayLike, digits: str = ".4g") -> str:
    """Numbers as text, separated by commas."""
    return ", ".join(format(value, digits) for value in np.atleast_1d(values))


def share(confusion: Confusion) -> str:
    """Accuracy as text: percent, and right answers of all."""
    right = round(confusion.accuracy * confusion.total)
    return f"{100 * confusion.accuracy:.1f} % ({right}/{confusion.total})"


def mean_share(noise: xr.DataArray, name: str) -> str:
    """Mean accuracy of a scene at its own noise over all draws, as text."""
    return f"{100 * noise.sel(scene=name, multiple=1.0).item():.1f} % in the mean of all draws"


def same_proportion(right: int, total: int, confusion: Confusion) -> bool:
    """Whether two accuracies could be one: Fisher's exact test does not tell them apart."""
    from scipy.stats import fisher_exact

    ours = round(confusion.accuracy * confusion.total)
    table = [[right, total - right], [ours, confusion.total - ours]]
    pvalue = np.asarray(fisher_exact(table))[1]
    return bool(pvalue > SIGNIFICANCE)


def neighbour_errors(confusion: Confusion) -> tuple[int, int]:
    """How many wrong answers name the class next to the right one, and how many there are."""
    counts = np.asarray(confusion.counts)
    wrong = counts.sum() - np.trace(counts)
    beside = np.trace(counts, offset=1) + np.trace(counts, offset=-1)
    return int(beside), int(wrong)
