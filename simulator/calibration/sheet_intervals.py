"""What is told of two sheets: each of them, their ratio, and where one field sees both their sum.

Of that sum S alone each sheet hangs on the ratio r, of which no more is known than beforehand. That
is much, so it is carried through S r / (1 + r) and S / (1 + r) as it is, not by its slope.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..models.heterogeneous.mesh_choice import single_field
from ..models.parameters import BOTTOM_MODES, TOP_MODES
from ..scene.scene import Scene
from .fit import Fit
from .identifiability import Information
from .likelihood.profile_distribution import CONFIDENCE, Interval, Law

TOP, BOTTOM, SUM, RATIO = "top sheet", "bottom sheet", "both in series", "top over bottom"
COMMON, MISMATCH = "sheet_resistance", "sheet_mismatch"
RATIOS, SUMS = 2001, 101
"""Places of equal chance along the law of the ratio, and of the sum at each ratio."""


class Product(NamedTuple):
    """A quantity of the scene: its value there and as fitted, and its slopes.

    slopes: of its logarithm, to each parameter that it depends on.
    """

    name: str
    unit: str
    start: float
    value: float
    slopes: Mapping[str, float]


def sheets(scene: Scene, values: Mapping[str, float]) -> Iterator[Product]:
    """values: of all parameters."""
    before = scene.skin.sheet_resistances
    both, half = values[COMMON], values[MISMATCH] / 2
    top, bottom = before[0] * math.exp(both + half), before[1] * math.exp(both - half)
    yield Product(TOP, "ohm/sq", before[0], top, {COMMON: 1.0, MISMATCH: 0.5})
    yield Product(BOTTOM, "ohm/sq", before[1], bottom, {COMMON: 1.0, MISMATCH: -0.5})
    if single_field(scene) is not None:
        slopes = {COMMON: 1.0, MISMATCH: 0.5 * (top - bottom) / (top + bottom)}
        yield Product(SUM, "ohm/sq", sum(before), top + bottom, slopes)
    yield Product(RATIO, "", before[0] / before[1], top / bottom, {MISMATCH: 1.0})


def hang_on_ratio(scene: Scene, information: Information) -> bool:
    """Whether one field sees both sheets, and neither is known."""
    return single_field(scene) is not None and {COMMON, MISMATCH} <= set(information.names)


class Pair(NamedTuple):
    """Two parameters that one field sees a sum of alone, to first order.

    name: of the sum, where it has none of its own. shares: of each in it.
    """

    first: str
    second: str
    name: str = ""
    shares: tuple[float, float] = (0.0, 0.0)


def in_series(scene: Scene, values: Mapping[str, float], names: Sequence[str]) -> Iterator[Pair]:
    """Of sheets that one field sees: their ratio beside their mean, and each slow wave of both.

    values: of all parameters. names: of those that are not known.
    """
    if single_field(scene) is None:
        return
    if {COMMON, MISMATCH} <= set(names):
        yield Pair(COMMON, MISMATCH)
    of = {each.name: each.value for each in sheets(scene, values)}
    shares = of[TOP] / of[SUM], of[BOTTOM] / of[SUM]
    for first, second in zip(TOP_MODES, BOTTOM_MODES, strict=True):
        if {first, second} <= set(names):
            yield Pair(first, second, f"both sheets, {first.removeprefix('top_')}", shares)


def of_series(
    scene: Scene, fit: Fit, information: Information, width: float, law: Law | None = None
) -> dict[str, Interval]:
    """95 % intervals of sheets that `hang_on_ratio`: TOP, BOTTOM in ohm/sq, the parameter COMMON.

    fit, information: of all that is not known. width: half of an interval over its deviation. law:
    of the logarithm of the sum, where that is not normal.
    """
    of = {each.name: each for each in sheets(scene, fit.values)}
    steps = np.array([prior.deviation for prior in fit.spec.fitted.values()])
    pair = np.array([slopes_of(of[name], information.names) for name in (RATIO, SUM)]) * steps
    covariance = pair @ information.covariance @ pair.T
    log_ratio, log_sum = _law(covariance, width)
    if law:
        log_sum = law.at(log_sum / math.sqrt(covariance[1, 1])) - math.log(of[SUM].value)
    ratio, total = of[RATIO].value * np.exp(log_ratio), of[SUM].value * np.exp(log_sum)
    top, bottom = total * ratio / (1 + ratio), total / (1 + ratio)
    both = np.log(top * bottom / (of[TOP].start * of[BOTTOM].start)) / 2
    return {TOP: _middle(top), BOTTOM: _middle(bottom), COMMON: _likeliest(both)}


def slopes_of(product: Product, names: tuple[str, ...]) -> NDArray[np.float64]:
    """To each of these parameters, shape (parameter,)."""
    return np.array([product.slopes.get(name, 0.0) for name in names])


def _law(
    covariance: NDArray[np.float64], width: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Two numbers of a joint normal law about 0, at places of equal chance: (RATIOS, SUMS).

    width: times its deviation that a number lies within in 95 of 100 cases.
    """
    from scipy.special import ndtri

    first, second = (ndtri((np.arange(n) + 0.5) / n) * width / ndtri(0.975) for n in (RATIOS, SUMS))
    slope = covariance[0, 1] / covariance[0, 0]
    own = math.sqrt(max(covariance[1, 1] - slope * covariance[0, 1], 0.0))
    one = math.sqrt(covariance[0, 0]) * first[:, None]
    return one, slope * one + own * second


def _middle(values: NDArray[np.float64]) -> Interval:
    """What 95 of 100 lie within."""
    low, high = np.quantile(values, (0.025, 0.975))
    return float(low), float(high)


def _likeliest(values: NDArray[np.float64]) -> Interval:
    """The shortest interval that 95 of 100 lie within.

    The mean of two sheets in series is largest, and likeliest, where both are equal: equal sheets
    lie at an end of their law, which an interval about its middle would leave out.
    """
    ordered = np.sort(values, axis=None)
    within = round(CONFIDENCE * ordered.size)
    first = int(np.argmin(ordered[within:] - ordered[:-within]))
    return float(ordered[first]), float(ordered[first + within])
