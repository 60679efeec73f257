"""One statement of the paper, compared with the result of the simulation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from ...simulator.scene.readout.meter import Readout

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import ArrayLike

    from ..evaluation.confusion import Confusion

SIGNIFICANCE = 0.05
TOLERANCE = 0.15
"""Relative tolerance of a number: the difference between the two devices of the paper."""
Rule = Literal["number", "proportion", "comparison"]
RULES: dict[Rule, str] = {
    "number": f"the simulated number lies within {100 * TOLERANCE:g} % of the paper's, or the "
    "simulated range holds the paper's number",
    "proportion": "Fisher's exact test does not distinguish the two shares of right answers at "
    f"{100 * SIGNIFICANCE:g} %",
    "comparison": "the simulated numbers have the sign or the order, or reach the bound, that the "
    "paper states; a change below the meter's noise counts as none",
}
"""Rules for agreement. Every statement is about the device as described, foils included."""
NOISE_FREE = "none"
ENOUGH = 90.0
"""Percent of right answers that the paper calls high."""


@dataclass(frozen=True)
class Claim:
    """A statement of the paper, the simulated result, their agreement and its reason.

    rule: the one of RULES that decides `agrees`. noise: noise of the readings that give `ours`.
    """

    topic: str
    source: str
    paper: str
    ours: str
    agrees: bool
    rule: Rule
    why: str
    noise: str = NOISE_FREE


def near(ours: ArrayLike, paper: ArrayLike) -> bool:
    """True if all numbers are within TOLERANCE of the paper's."""
    return bool(np.allclose(ours, paper, rtol=TOLERANCE, atol=0.0))


def noise_of(readout: Readout, draws: int = 1) -> str:
    """A meter's noise, and the number of averaged draws, as text."""
    degrees = np.degrees(readout.phase_noise)
    drawn = "one draw" if draws == 1 else f"mean of {draws} draws"
    return f"{100 * readout.magnitude_noise:.1f} % of |Z|, {degrees:.2f}°; {drawn}"


def listed(values: ArrayLike, digits: str = ".4g") -> str:
    """Numbers as text, separated by commas."""
    return ", ".join(format(value, digits) for value in np.atleast_1d(values))


def share(confusion: Confusion) -> str:
    """Accuracy as text: percent, and right answers of all."""
    right = round(confusion.accuracy * confusion.total)
    return f"{100 * confusion.accuracy:.1f} % ({right}/{confusion.total})"


def mean_share(noise: xr.DataArray, name: str) -> str:
    """Mean accuracy over all draws of a scene with its own noise, as text."""
    return f"{100 * noise.sel(scene=name, multiple=1.0).item():.1f} % in the mean of all draws"


def same_proportion(right: int, total: int, confusion: Confusion) -> bool:
    """True if Fisher's exact test does not distinguish the two accuracies."""
    from scipy.stats import fisher_exact

    ours = round(confusion.accuracy * confusion.total)
    table = [[right, total - right], [ours, confusion.total - ours]]
    pvalue = np.asarray(fisher_exact(table))[1]
    return bool(pvalue > SIGNIFICANCE)


def neighbour_errors(confusion: Confusion) -> tuple[int, int]:
    """Number of wrong answers that name an adjacent class, and of all wrong answers."""
    counts = np.asarray(confusion.counts)
    wrong = counts.sum() - np.trace(counts)
    adjacent = np.trace(counts, offset=1) + np.trace(counts, offset=-1)
    return int(adjacent), int(wrong)
