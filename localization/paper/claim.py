"""One statement of the paper beside what the physics gives."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from ...simulator.scene.meter import Readout

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import ArrayLike

    from ..evaluation.confusion import Confusion

SIGNIFICANCE = 0.05
TOLERANCE = 0.15
"""Of a number over the paper's: as far as the two devices of the paper differ from each other."""
Rule = Literal["number", "proportion", "comparison"]
RULES: dict[Rule, str] = {
    "number": f"the simulated number lies within {100 * TOLERANCE:g} % of the paper's, or the "
    "simulated range holds the paper's number",
    "proportion": "Fisher's exact test does not distinguish the two shares of right answers at "
    f"{100 * SIGNIFICANCE:g} %",
    "comparison": "the simulated numbers have the sign or the order, or reach the bound, that the "
    "paper states; a change below the meter's noise counts as none",
}
"""When a statement agrees. Every one is of the device as the paper describes it, foils included."""
NOISE_FREE = "none"
ENOUGH = 90.0
"""Percent of right answers that the paper calls high."""


@dataclass(frozen=True)
class Claim:
    """A statement of the paper, what the physics gives, whether they agree, and why or why not.

    rule: of RULES, by which `agrees` is found. noise: of the readings that `ours` is found from.
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
    """Whether all numbers are within TOLERANCE of the paper's."""
    return bool(np.allclose(ours, paper, rtol=TOLERANCE, atol=0.0))


def noise_of(readout: Readout, draws: int = 1) -> str:
    """A meter's noise, and how many draws of it are averaged, as text."""
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
