"""Estimates with 95 % intervals: parameters and the physical quantities that depend on them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Real
from ..models.parameters import COSINE_MODES, FACTORS, TABLE, effects_of, own_values, weights_with
from ..progress import ProgressCallback, silent, tracked
from ..scene.parts import Setup, Skin
from ..surroundings.rim import rim_densities
from .distributions import Distributions
from .fit import Fit
from .identifiability import Information
from .profile_distribution import CONFIDENCE, cut_normal
from .sheet_intervals import (
    COMMON,
    MISMATCH,
    SUM,
    Interval,
    Product,
    SeriesPair,
    depend_on_ratio,
    series_intervals,
    series_pairs,
    sheets,
    slopes_of,
)


def products(skin: Skin, setup: Setup, values: Mapping[str, float]) -> Iterator[Product]:
    """All such quantities of a scene. values: of all parameters."""
    yield from sheets(skin, setup, values)
    c, weights = skin.foam.unpressed_capacitance_per_area, weights_with(values)
    yield Product("foam capacitance", "F/m²", c, weights["foam"] * c, {"capacitance": 1.0})
    for contact in skin.contacts:
        if not contact.ideal:
            name, resistance = f"contact {contact.name}", contact.resistance
            slopes = {"contact_resistance": 1.0}
            yield Product(name, "ohm m", resistance, resistance / weights["films"], slopes)
    yield from _of_surroundings(skin, weights)


def _of_surroundings(skin: Skin, weights: Mapping[str, float]) -> Iterator[Product]:
    """Distances or capacitances of bodies, and capacitances of the rim."""
    around, own = skin.around, effects_of(skin)
    if around is None:
        return
    for body in around.body if "body" in own else ():
        name, factor = f"body, {body.side}", weights["body"]
        if body.distance is None:
            c = body.per_area
            yield Product(name, "F/m²", c, c * factor, {"body": 1.0})
        else:
            yield Product(name, "m", body.distance, body.distance / factor, {"body": -1.0})
    if "rim" in own:
        factor, rim = weights["rim"], rim_densities(skin)
        for part in ("mutual", "top", "bottom"):
            if value := getattr(rim, part):
                yield Product(f"rim, {part}", "F/m", value, value * factor, {"rim": 1.0})


@dataclass(frozen=True)
class FittedQuantity:
    """A number of the scene: its value there, its fitted value and its 95 % interval.

    parameters: the unknown parameters that it depends on. identified: True if the data determine
    it, False if the prior does.
    """

    name: str
    unit: str
    start: float
    value: float
    low: float
    high: float
    identified: bool
    parameters: tuple[str, ...]

    @property
    def source(self) -> str:
        """`data`, `limit` (the data give an upper limit), or `prior` (not identified)."""
        if not self.identified:
            return "prior"
        return "limit" if self.low == 0 else "data"


def quantile(freedom: float) -> float:
    """Half width of a 95 % interval in standard deviations.

    freedom: degrees of freedom of the estimated noise, infinite where the noise is known.
    """
    from scipy.special import ndtri, stdtrit

    chance = (1 + CONFIDENCE) / 2
    return float(ndtri(chance) if math.isinf(freedom) else stdtrit(freedom, chance))


def intervals(
    skin: Skin,
    setup: Setup,
    fit: Fit,
    information: Information,
    freedom: float,
    distributions: Distributions | None = None,
    progress: ProgressCallback = silent,
) -> dict[str, Interval]:
    """Marginal 95 % interval of each parameter in its own unit, within its limits.

    fit, information: with all unknown parameters, see `with_all_unknown`. distributions: for
    likelihoods that are not normal; without them all intervals are linear.
    """
    width = quantile(freedom)
    hanging = depend_on_ratio(skin, setup, information)
    found = {}
    each = list(zip(fit.spec.fitted.items(), information.deviation, strict=True))
    for (name, prior), own in tracked(each, "computing intervals", progress):
        value, deviation = fit.values[name], prior.deviation * float(own)
        if hanging and name == COMMON:
            found[name] = _series(skin, setup, fit, information, width, distributions)[COMMON]
        elif distributions and (distribution := distributions.of_parameter(name)):
            found[name] = _with_value(value, distribution.interval(width))
        else:
            found[name] = cut_normal(value, deviation, width, (prior.low, prior.high))
    return found


def _series(
    skin: Skin,
    setup: Setup,
    fit: Fit,
    information: Information,
    width: float,
    distributions: Distributions | None,
) -> dict[str, Interval]:
    distribution = distributions.of_product(_sum(skin, setup, fit)) if distributions else None
    return series_intervals(skin, setup, fit, information, width, distribution)


def _sum(skin: Skin, setup: Setup, fit: Fit) -> Product:
    return next(each for each in sheets(skin, setup, fit.values) if each.name == SUM)


def _with_value(value: float, interval: Interval) -> Interval:
    """The interval, widened to contain the likeliest value."""
    return min(interval[0], value), max(interval[1], value)


def quantities(
    skin: Skin,
    setup: Setup,
    fit: Fit,
    information: Information,
    freedom: float,
    fitted: Sequence[str],
    distributions: Distributions | None = None,
) -> tuple[FittedQuantity, ...]:
    """All physical quantities that a fitted parameter changes, and the ratio of the sheets.

    fit, information, distributions: see `intervals`. fitted: names of parameters.
    """
    own = intervals(skin, setup, fit, information, freedom, distributions)
    start = own_values(skin, setup) | dict.fromkeys(COSINE_MODES, 0.0)
    identified = information.identified
    hanging = depend_on_ratio(skin, setup, information)
    width = quantile(freedom)
    series = _series(skin, setup, fit, information, width, distributions) if hanging else {}
    factors = [
        _factor(each, fit, information, width, series.get(each.name), distributions)
        for each in products(skin, setup, fit.values)
        if {*fitted, MISMATCH} & set(information.names) & set(each.slopes)
    ]
    values = [
        FittedQuantity(
            name, known.unit, start[name], fit.values[name], *own[name], identified[name], (name,)
        )
        for name, known in TABLE.items()
        if name in fitted and not known.powers
    ]
    sums = [
        _sum_of_modes(pair, fit, information, width)
        for pair in series_pairs(skin, setup, fit.values, fitted)
        if pair.name
    ]
    return (*factors, *values, *sums)


def _sum_of_modes(
    pair: SeriesPair, fit: Fit, information: Information, width: float
) -> FittedQuantity:
    """Sum of a cosine mode of both sheets' conductance, weighted by their share of resistance."""
    weights, value, names = np.zeros(len(information.names)), 0.0, (pair.first, pair.second)
    for name, share in zip(names, pair.shares, strict=True):
        weights[information.names.index(name)] = share * fit.spec.fitted[name].deviation
        value += share * fit.values[name]
    half = width * math.sqrt(weights @ information.covariance @ weights)
    identified = information.narrows(weights)
    return FittedQuantity(pair.name, "", 0.0, value, value - half, value + half, identified, names)


def _factor(
    product: Product,
    fit: Fit,
    information: Information,
    width: float,
    series: Interval | None,
    distributions: Distributions | None,
) -> FittedQuantity:
    """A quantity whose logarithm is a sum of parameters.

    series: the interval of a sheet of which only the sum with the other is measured.
    """
    steps = np.array([prior.deviation for prior in fit.spec.fitted.values()])
    weights = slopes_of(product, information.names) * steps
    spread = math.exp(width * math.sqrt(weights @ information.covariance @ weights))
    low, high = series or (product.value / spread, product.value * spread)
    distribution = distributions.of_product(product) if distributions and not series else None
    if distribution:
        ends = distribution.interval(width)
        low, high = _with_value(product.value, (math.exp(ends[0]), math.exp(ends[1])))
    identified = series is None and information.identifies(weights)
    of = tuple(part for part in product.slopes if part in information.names)
    return FittedQuantity(
        product.name, product.unit, product.start, product.value, low, high, identified, of
    )


def change_text(name: str, step: float) -> str:
    """Text of a change of a parameter."""
    if name in FACTORS:
        return f"{name} times {math.exp(step):.3g}"
    return f"{name} {step:+.3g} {TABLE[name].unit}".strip()


def weakly_identified(skin: Skin, setup: Setup, fit: Fit, information: Information) -> list[str]:
    """One line for every combination of parameters that the data barely identify."""
    pairs = _unresolved_pairs(skin, setup, fit, information)
    lines = [_in_series(pair) for pair, _ in pairs]
    weak = information.weak_directions([direction for _, direction in pairs])
    return lines + [_direction(fit, information, each) for each in weak]


def _unresolved_pairs(
    skin: Skin, setup: Setup, fit: Fit, information: Information
) -> list[tuple[SeriesPair, Real]]:
    """Pairs of which only the sum is measured, and the unit direction of each in deviations."""
    found = []
    for pair in series_pairs(skin, setup, fit.values, information.names):
        first, second = (information.names.index(name) for name in (pair.first, pair.second))
        direction = information.weakest(first, second)
        named = pair.second == MISMATCH or not information.without_effect[[first, second]].all()
        if named and information.barely_identifies(direction):
            found.append((pair, direction))
    return found


def _in_series(pair: SeriesPair) -> str:
    if pair.second == MISMATCH:
        return (
            f"{COMMON} and {MISMATCH}: the data identify only both sheets in series; top over "
            "bottom is assumed from the scene, within its prior"
        )
    return (
        f"{pair.first} and {pair.second}: the data identify only their sum, {pair.name}; each "
        "alone keeps its prior"
    )


def _direction(fit: Fit, information: Information, direction: Real) -> str:
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
            kind = "product" if first * second < 0 else "ratio"
            return f"{names}: the data identify only their {kind}"
    size = 0.1 / max(abs(step) / _unit(fit, name) for name, step in steps.items())
    undone = ", ".join(change_text(name, size * step) for name, step in steps.items())
    return f"{names}: not identified separately; {undone} together leaves the sweeps unchanged"


def _unit(fit: Fit, name: str) -> float:
    return 1.0 if name in FACTORS else fit.spec.fitted[name].deviation
