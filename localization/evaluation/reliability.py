"""Charts that test stated probabilities and regions against the truth."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.chart_style import COLOURS, chart
from ..inversion.region import Region
from ..inversion.regions import PROBABILITY
from ..trust.answers import CONFIDENCE, interval
from ..trust.temperature import calibration_error

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ...simulator.arrays import Mask, Real

OBSERVED_COLOUR, STATED_COLOUR = COLOURS[0], "0.5"
BINS, MIN_IN_BIN = 10, 10
GRID_LINES = 61
"""Number of lines of the grid on which regions are drawn."""


def draw_reliability_and_risk(path: Path, probability: Real, right: Mask) -> None:
    """Draw reliability and risk side by side; arguments: see `draw_reliability`."""
    with chart(path, 9.5, 4.4) as figure:
        left_panel, right_panel = figure.subplots(1, 2)
        draw_reliability(left_panel, probability, right)
        draw_risk(right_panel, probability, right)


def draw_reliability(axes: Axes, probability: Real, right: Mask) -> None:
    """Draw accuracy against stated probability, in bins of equal counts.

    A perfect localizer is on the diagonal. Bars are 95 % intervals (Clopper, Pearson).

    probability: probability of the best class. right: True if that was the true one. Both of shape
    (sweep,). Source: A. Niculescu-Mizil, R. Caruana, Proc. 22nd Int. Conf. Machine Learning (2005)
    625-632.
    """
    order = np.argsort(probability, kind="stable")
    bins = np.array_split(order, max(1, min(BINS, order.size // MIN_IN_BIN)))
    stated = np.array([probability[each].mean() for each in bins])
    rate = np.array([right[each].mean() for each in bins])
    low, high = np.array([interval(int(right[each].sum()), each.size) for each in bins]).T
    bars = 100 * np.maximum([rate - low, high - rate], 0.0)
    axes.errorbar(
        100 * stated, 100 * rate, bars, color=OBSERVED_COLOUR, marker="o", markersize=4, capsize=3
    )
    lowest = 100 * min(stated.min(), rate.min())
    _diagonal(axes, max(0.0, lowest - 3))
    axes.set_xlabel("Stated probability (%)")
    axes.set_ylabel("Right (%)")
    error = 100 * calibration_error(probability, right)
    axes.set_title(f"Reliability: off by {error:.1f} % on average")


def draw_risk(axes: Axes, probability: Real, right: Mask) -> None:
    """Draw the share of wrong answers against the share answered, most probable first.

    The dashed curve follows from the stated probabilities. Arguments: see `draw_reliability`.
    Source: Y. Geifman, R. El-Yaniv, Advances in Neural Information Processing Systems 30 (2017).
    """
    answered, wrong, promised = risk(probability, right)
    axes.plot(100 * answered, 100 * wrong, color=OBSERVED_COLOUR, label="wrong")
    axes.plot(
        100 * answered,
        100 * promised,
        "--",
        color=STATED_COLOUR,
        label="expected from the stated probabilities",
    )
    axes.set_xlim(0, 100)
    axes.set_ylim(0, None)
    axes.set_xlabel("Answered, the most probable first (%)")
    axes.set_ylabel("Wrong among the answered (%)")
    axes.set_title(f"{100 * wrong[-1]:.1f} % wrong if all are answered")
    axes.legend()


def risk(probability: Real, right: Mask) -> tuple[Real, Real, Real]:
    """Shares answered, wrong, and expected to be wrong, for each probability threshold."""
    order = np.argsort(-probability, kind="stable")
    last_of_ties = np.append(np.diff(probability[order]) != 0, True)
    count = np.arange(1, order.size + 1)
    curves = (
        count / order.size,
        *(np.cumsum(each[order]) / count for each in (~right, 1 - probability)),
    )
    answered, wrong, promised = (each[last_of_ties] for each in curves)
    return answered, wrong, promised


def draw_coverage(axes: Axes, content: Real) -> None:
    """Draw the share of touches inside regions against the stated probability.

    The band is Kolmogorov's, of 95 %. content: probability in the smallest region that reaches the
    touch, shape (sweep,).
    """
    from scipy.stats import kstwo

    share = np.arange(1, content.size + 1) / content.size
    axes.step(100 * np.sort(content), 100 * share, where="post", color=OBSERVED_COLOUR)
    band = 100 * float(kstwo.ppf(CONFIDENCE, content.size))
    ends = np.array([0.0, 100.0])
    axes.fill_between(ends, ends - band, ends + band, color="0.9", zorder=0)
    _diagonal(axes, 0.0)
    axes.axvline(100 * PROBABILITY, color=STATED_COLOUR, linewidth=0.8)
    axes.set_xlabel("Stated content of the region (%)")
    axes.set_ylabel("Touches within (%)")
    within = int((content <= PROBABILITY).sum())
    axes.set_title(
        f"{100 * PROBABILITY:g} % regions hold {100 * within / content.size:.1f} % "
        f"({within} of {content.size})"
    )


def draw_regions(axes: Axes, truth: Real, examples: Mapping[int, Region]) -> None:
    """Draw the regions of some sweeps in mm, each in its own colour, and the true touches.

    truth: x and y in mm first, shape (sweep, >= 2). examples: regions by number of the sweep.
    """
    for number, (sweep, region) in enumerate(examples.items()):
        x, y = (np.linspace(low, high, GRID_LINES) for low, high in region.places.bounds)
        density = region.places.density(*np.meshgrid(x, y))
        colour = f"C{number}"
        if density.max() > region.level:
            axes.contour(x, y, density, [region.level], colors=colour, linewidths=1.2)
        axes.plot(*truth[sweep, :2], "+", color=colour, markersize=10, markeredgewidth=2)
    axes.set_aspect("equal")
    axes.set_xlabel("x (mm)")
    axes.set_ylabel("y (mm)")
    axes.set_title(f"{100 * PROBABILITY:g} % regions of {len(examples)} touches (+)")


def _diagonal(axes: Axes, low: float) -> None:
    axes.plot([low, 100], [low, 100], "--", color=STATED_COLOUR, linewidth=1)
    axes.set_xlim(low, 100.5)
    axes.set_ylim(low, 100.5)
