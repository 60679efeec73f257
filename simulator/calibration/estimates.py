"""Estimates with 95 % intervals, of parameters and of the physical quantities they stand for."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..models.parameters import COSINE_MODES, FACTORS, VALUES, own_values
from ..scene.scene import Scene
from .derived_quantities import products
from .fit import Fit
from .identifiability import Information
from .likelihood.distributions import Laws
from .likelihood.profile_distribution import CONFIDENCE, cut_normal
from .sheet_intervals import (
    COMMON,
    MISMATCH,
    SUM,
    Interval,
    Pair,
    Product,
    hang_on_ratio,
    in_series,
    of_series,
    sheets,
    slopes_of,
)

UNITS = {name: unit if unit.isalpha() else "" for name, unit in VALUES.items()}
UNITS |= dict.fromkeys(COSINE_MODES, "")
HEADER = ("quantity", "unit", "scene", "fitted", "from", "to", "told by")
"""Of `Quantity.cells`."""


@dataclass(frozen=True)
class Quantity:
    """A number of the scene: as it stood, as fitted, and its 95 % interval.

    parameters: that it depends on and that are not known. told: whether the data tell it, or the
    prior does.
    """

    name: str
    unit: str
    start: float
    value: float
    low: float
    high: float
    told: bool
    parameters: tuple[str, ...]

    @property
    def cells(self) -> tuple[str, ...]:
        """As a row of a table for people, see HEADER."""
        numbers = (f"{x:.4g}" for x in (self.start, self.value, self.low, self.high))
        return self.name, self.unit, *numbers, self.told_by

    @property
    def told_by(self) -> str:
        """`data`; `limit`, where the data tell how much it is at most; or `prior`."""
        if not self.told:
            return "prior"
        return "limit" if self.low == 0 else "data"


def quantile(freedom: float) -> float:
    """Deviations within which an estimate lies; freedom: of the noise's own estimate."""
    from scipy.special import ndtri, stdtrit

    chance = (1 + CONFIDENCE) / 2
    return float(ndtri(chance) if math.isinf(freedom) else stdtrit(freedom, chance))


def intervals(
    scene: Scene, fit: Fit, information: Information, freedom: float, laws: Laws | None = None
) -> dict[str, Interval]:
    """Of each parameter in its own unit, within what makes sense, whatever the others are.

    fit, information: of all that is not known, see `with_unknown`. laws: where the likelihood is
    followed as it bends or ends; without them all is linear.
    """
    width = quantile(freedom)
    hanging = hang_on_ratio(scene, information)
    found = {}
    for (name, prior), own in zip(fit.spec.fitted.items(), information.deviation, strict=True):
        value, deviation = fit.values[name], prior.deviation * float(own)
        if hanging and name == COMMON:
            found[name] = _series(scene, fit, information, width, laws)[COMMON]
        elif laws and (law := laws.of_parameter(name)):
            found[name] = _about(value, law.interval(width))
        else:
            found[name] = cut_normal(value, deviation, width, (prior.low, prior.high))
    return found


def _series(
    scene: Scene, fit: Fit, information: Information, width: float, laws: Laws | None
) -> dict[str, Interval]:
    law = laws.of_product(_sum(scene, fit)) if laws else None
    return of_series(scene, fit, information, width, law)


def _sum(scene: Scene, fit: Fit) -> Product:
    return next(each for each in sheets(scene, fit.values) if each.name == SUM)


def _about(value: float, interval: Interval) -> Interval:
    """The interval, and the likeliest value with it."""
    return min(interval[0], value), max(interval[1], value)


def quantities(
    scene: Scene,
    fit: Fit,
    information: Information,
    freedom: float,
    fitted: Sequence[str],
    laws: Laws | None = None,
) -> tuple[Quantity, ...]:
    """Of all physical quantities that a fitted parameter changes, and the ratio of the sheets.

    fit, information, laws: as of `intervals`. fitted: names of parameters.
    """
    own = intervals(scene, fit, information, freedom, laws)
    start = own_values(scene) | dict.fromkeys(COSINE_MODES, 0.0)
    told = information.told
    hanging = hang_on_ratio(scene, information)
    width = quantile(freedom)
    series = _series(scene, fit, information, width, laws) if hanging else {}
    factors = [
        _factor(each, fit, information, width, series.get(each.name), laws)
        for each in products(scene, fit.values)
        if {*fitted, MISMATCH} & set(information.names) & set(each.slopes)
    ]
    values = [
        Quantity(name, unit, start[name], fit.values[name], *own[name], told[name], (name,))
        for name, unit in UNITS.items()
        if name in fitted
    ]
    sums = [
        _sum_of_waves(pair, fit, information, width)
        for pair in in_series(scene, fit.values, fitted)
        if pair.name
    ]
    return (*factors, *values, *sums)


def _sum_of_waves(pair: Pair, fit: Fit, information: Information, width: float) -> Quantity:
    """Of conductance, each sheet's weighed by its share of the resistance of both."""
    weights, value, names = np.zeros(len(information.names)), 0.0, (pair.first, pair.second)
    for name, share in zip(names, pair.shares, strict=True):
        weights[information.names.index(name)] = share * fit.spec.fitted[name].deviation
        value += share * fit.values[name]
    spread = width * math.sqrt(weights @ information.covariance @ weights)
    told = information.narrows(weights)
    return Quantity(pair.name, "", 0.0, value, value - spread, value + spread, told, names)


def _factor(
    product: Product,
    fit: Fit,
    information: Information,
    width: float,
    series: Interval | None,
    laws: Laws | None,
) -> Quantity:
    """Its logarithm is a sum of parameters, or of a sheet in series its interval is given."""
    steps = np.array([prior.deviation for prior in fit.spec.fitted.values()])
    weights = slopes_of(product, information.names) * steps
    spread = math.exp(width * math.sqrt(weights @ information.covariance @ weights))
    low, high = series or (product.value / spread, product.value * spread)
    law = laws.of_product(product) if laws and not series else None
    if law:
        ends = law.interval(width)
        low, high = _about(product.value, (math.exp(ends[0]), math.exp(ends[1])))
    told = series is None and information.tells(weights)
    of = tuple(part for part in product.slopes if part in information.names)
    return Quantity(product.name, product.unit, product.start, product.value, low, high, told, of)


def changed(name: str, step: float) -> str:
    """A change of a parameter in words."""
    if name in FACTORS:
        return f"{name} times {math.exp(step):.3g}"
    return f"{name} {step:+.3g} {UNITS[name]}".strip()


def told_together(scene: Scene, fit: Fit, information: Information) -> list[str]:
    """One line for every direction that the data hardly tell."""
    pairs = _unseen(scene, fit, information)
    lines = [_in_series(pair) for pair, _ in pairs]
    weak = information.weak([direction for _, direction in pairs])
    return lines + [_direction(fit, information, each) for each in weak]


def _unseen(
    scene: Scene, fit: Fit, information: Information
) -> list[tuple[Pair, NDArray[np.float64]]]:
    """Pairs that one field sees the sum of, and the unit direction of each in deviations."""
    found = []
    for pair in in_series(scene, fit.values, information.names):
        first, second = (information.names.index(name) for name in (pair.first, pair.second))
        direction = information.weakest(first, second)
        named = pair.second == MISMATCH or not information.silent[[first, second]].all()
        if named and information.hardly_tells(direction):
            found.append((pair, direction))
    return found


def _in_series(pair: Pair) -> str:
    if pair.second == MISMATCH:
        return (
            f"{COMMON} and {MISMATCH}: told only together, as both sheets in series; top over "
            "bottom is assumed from the scene, within its prior"
        )
    return (
        f"{pair.first} and {pair.second}: told only as their sum, that of {pair.name}; what is "
        "told of each is its prior"
    )


def _direction(fit: Fit, information: Information, direction: NDArray[np.float64]) -> str:
    parts = information.parts(direction)
    if len(parts) == 1:
        return f"{parts[0]}: not identified by the data; prior kept"
    steps = {
        name: prior.deviation * float(step)
        for (name, prior), step in zip(fit.spec.fitted.items(), direction, strict=True)
        if name in parts
    }
    names = " and ".join(parts)
    if len(parts) == 2 and all(name in FACTORS for name in parts):
        first, second = (steps[name] for name in parts)
        if abs(abs(first) - abs(second)) < 0.1 * abs(first):
            return f"{names}: told only as their {'product' if first * second < 0 else 'ratio'}"
    size = 0.1 / max(abs(step) / _unit(fit, name) for name, step in steps.items())
    undone = ", ".join(changed(name, size * step) for name, step in steps.items())
    return f"{names}: told only together; {undone} at once leaves what is measured as it is"


def _unit(fit: Fit, name: str) -> float:
    return 1.0 if name in FACTORS else fit.spec.fitted[name].deviation
