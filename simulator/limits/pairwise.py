"""How far pixels' sweeps lie apart, and what two of them alone say of the accuracy of all.

A judge who is told that it was one of two hypotheses, and how strong either press would have been,
errs no more often than one who is not: with whitened readings a distance d apart, in Phi(-d/2) of
all cases. Whichever way strengths and hypotheses are put in pairs, that bounds the accuracy of any
classifier from above; the pairs that bound it most are two assignment problems.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment
from scipy.spatial.distance import cdist
from scipy.special import ndtr

from simulator.distribution import AnyDistribution
from simulator.limits.hypotheses import Hypothesis
from simulator.limits.readings import Readings
from simulator.limits.strengths import quantiles, together

STRENGTHS = 16
"""Equally likely ones that a hypothesis is told in."""
LOOKED_AT = 41
"""Strengths among which the nearest of two pixels' are looked for."""


def upper_bound(readings: Readings, among: Sequence[Hypothesis], presses: AnyDistribution) -> float:
    """An accuracy that no classifier of hypotheses as likely as each other surpasses."""
    curves = [_curve(readings, each, presses) for each in among]
    wrong = np.zeros((len(among), len(among)))
    for i, j in itertools.combinations(range(len(among)), 2):
        if among[i].answer != among[j].answer:
            wrong[i, j] = wrong[j, i] = confusion(curves[i], curves[j])
    return 1 - float(wrong[linear_sum_assignment(wrong, maximize=True)].mean())


def confusion(one: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    """Share of errors between two at least: equally likely readings of each, shape (k, number)."""
    size = math.lcm(len(one), len(other))
    error = ndtr(-cdist(one, other) / 2)
    error = np.repeat(np.repeat(error, size // len(one), 0), size // len(other), 1)
    return float(error[linear_sum_assignment(error, maximize=True)].mean())


def distances(
    readings: Readings,
    among: Sequence[Hypothesis],
    presses: AnyDistribution,
    spread: float | None = None,
) -> NDArray[np.float64]:
    """How far each two hypotheses of one pixel lie apart, in the meter's errors, (k, k).

    At the nearest of any two strengths that presses have or, with `spread`, where the sum of the
    squares of the distance and of both strengths' deviations from the middle over it is least.
    """
    factor = np.linspace(presses.low, presses.high, LOOKED_AT if presses.low < presses.high else 1)
    off = np.zeros_like(factor) if spread is None else ((factor - factor.mean()) / spread) ** 2
    curves = [readings.of(each.pixels, np.tile(factor, (len(each.pixels), 1))) for each in among]
    apart = np.zeros((len(among), len(among)))
    for i, j in itertools.combinations(range(len(among)), 2):
        square = cdist(curves[i], curves[j], "sqeuclidean") + off[:, None] + off
        apart[i, j] = apart[j, i] = np.sqrt(square.min())
    return apart


def _curve(
    readings: Readings, hypothesis: Hypothesis, presses: AnyDistribution
) -> NDArray[np.float64]:
    touches = len(hypothesis.pixels)
    each = round(STRENGTHS ** (1 / max(1, touches)))
    factor = together([quantiles(presses, each)] * touches).factor
    return readings.of(hypothesis.pixels, factor)
