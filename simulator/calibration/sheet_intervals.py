"""Intervals of two sheets: each one, their ratio, and their sum where one field describes both.

One field depends on the sum S only. Each sheet then follows from S and the ratio r, which keeps its
prior. That prior is wide, so its full distribution enters S r / (1 + r) and S / (1 + r), not a
linear approximation.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ..arrays import Real
from ..models.heterogeneous.elements_model import single_field
from ..models.parameters import BOTTOM_MODES, TOP_MODES, weights_with
from ..scene.parts import Setup, Skin
from .fit import Fit
from .identifiability import Information
from .profile_distribution import CONFIDENCE, Interval, ProfileDistribution

TOP, BOTTOM, SUM, RATIO = "top sheet", "bottom sheet", "both in series", "top over bottom"
COMMON, MISMATCH = "sheet_resistance", "sheet_mismatch"
RATIOS, SUMS = 2001, 101
"""Number of equally likely values of the ratio, and of the sum at each ratio."""


class Product(NamedTuple):
    """A quantity of the scene: its value there (`start`), its fitted value, and its slopes.

    slopes: derivatives of its logarithm by the parameters that it depends on.
    """

    name: str
    unit: str
    start: float
    value: float
    slopes: Mapping[str, float]


def sheets(skin: Skin, setup: Setup, values: Mapping[str, float]) -> Iterator[Product]:
    """Both sheets, their ratio, and their sum where one field describes both, or the only one.

    values: of all parameters.
    """
    before = skin.sheet_resistances
    weights = weights_with(values)
    top, bottom = before[0] / weights["top"], before[1] / weights["bottom"]
    if skin.one_conductor:
        yield Product(TOP, "ohm/sq", before[0], top, {COMMON: 1.0})
        return
    yield Product(TOP, "ohm/sq", before[0], top, {COMMON: 1.0, MISMATCH: 0.5})
    yield Product(BOTTOM, "ohm/sq", before[1], bottom, {COMMON: 1.0, MISMATCH: -0.5})
    if single_field(skin, setup) is not None:
        slopes = {COMMON: 1.0, MISMATCH: 0.5 * (top - bottom) / (top + bottom)}
        yield Product(SUM, "ohm/sq", sum(before), top + bottom, slopes)
    yield Product(RATIO, "", before[0] / before[1], top / bottom, {MISMATCH: 1.0})


def depend_on_ratio(skin: Skin, setup: Setup, information: Information) -> bool:
    """True if one field describes both sheets, and both are unknown."""
    return single_field(skin, setup) is not None and {
        COMMON,
        MISMATCH,
    } <= set(information.names)


class SeriesPair(NamedTuple):
    """Two parameters of which one field depends only on a sum, to first order.

    name: of the sum, empty where another quantity describes it. shares: weights in the sum.
    """

    first: str
    second: str
    name: str = ""
    shares: tuple[float, float] = (0.0, 0.0)


def series_pairs(
    skin: Skin, setup: Setup, values: Mapping[str, float], names: Sequence[str]
) -> Iterator[SeriesPair]:
    """Pairs of sheets that one field describes: mean and ratio, and each cosine mode of both.

    values: of all parameters. names: of the unknown ones.
    """
    if single_field(skin, setup) is None or skin.one_conductor:
        return
    if {COMMON, MISMATCH} <= set(names):
        yield SeriesPair(COMMON, MISMATCH)
    of = {each.name: each.value for each in sheets(skin, setup, values)}
    shares = of[TOP] / of[SUM], of[BOTTOM] / of[SUM]
    for first, second in zip(TOP_MODES, BOTTOM_MODES, strict=True):
        if {first, second} <= set(names):
            yield SeriesPair(first, second, f"both sheets, {first.removeprefix('top_')}", shares)


def series_intervals(
    skin: Skin,
    setup: Setup,
    fit: Fit,
    information: Information,
    width: float,
    distribution: ProfileDistribution | None = None,
) -> dict[str, Interval]:
    """95 % intervals of sheets that `depend_on_ratio`: TOP, BOTTOM in ohm/sq, parameter COMMON.

    fit, information: with all unknown parameters. width: half of an interval over its standard
    deviation. distribution: of the logarithm of the sum, where that is not normal.
    """
    of = {each.name: each for each in sheets(skin, setup, fit.values)}
    steps = np.array([prior.deviation for prior in fit.spec.fitted.values()])
    pair = np.array([slopes_of(of[name], information.names) for name in (RATIO, SUM)]) * steps
    covariance = pair @ information.covariance @ pair.T
    log_ratio, log_sum = _law(covariance, width)
    if distribution:
        log_sum = distribution.at(log_sum / math.sqrt(covariance[1, 1])) - math.log(of[SUM].value)
    ratio, total = of[RATIO].value * np.exp(log_ratio), of[SUM].value * np.exp(log_sum)
    top, bottom = total * ratio / (1 + ratio), total / (1 + ratio)
    both = np.log(top * bottom / (of[TOP].start * of[BOTTOM].start)) / 2
    return {TOP: _middle(top), BOTTOM: _middle(bottom), COMMON: _likeliest(both)}


def slopes_of(product: Product, names: tuple[str, ...]) -> Real:
    """Slopes by each of these parameters, shape (parameter,)."""
    return np.array([product.slopes.get(name, 0.0) for name in names])


def _law(covariance: Real, width: float) -> tuple[Real, Real]:
    """Equally likely pairs of a joint normal distribution around 0, shape (RATIOS, SUMS).

    width: half of a 95 % interval over its standard deviation.
    """
    from scipy.special import ndtri

    first, second = (ndtri((np.arange(n) + 0.5) / n) * width / ndtri(0.975) for n in (RATIOS, SUMS))
    slope = covariance[0, 1] / covariance[0, 0]
    own = math.sqrt(max(covariance[1, 1] - slope * covariance[0, 1], 0.0))
    one = math.sqrt(covariance[0, 0]) * first[:, None]
    return one, slope * one + own * second


def _middle(values: Real) -> Interval:
    """The central interval that contains 95 % of the values."""
    low, high = np.quantile(values, (0.025, 0.975))
    return float(low), float(high)


def _likeliest(values: Real) -> Interval:
    """The shortest interval that contains 95 % of the values.

    The mean of two sheets in series is largest, and likeliest, where both are equal. Equal sheets
    lie at an end of the distribution, which a central interval would leave out.
    """
    ordered = np.sort(values, axis=None)
    within = round(CONFIDENCE * ordered.size)
    first = int(np.argmin(ordered[within:] - ordered[:-within]))
    return float(ordered[first]), float(ordered[first + within])
