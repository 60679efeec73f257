"""Distributions of the quantities that a data set draws, and their short forms."""

from __future__ import annotations

import math
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import AfterValidator, BeforeValidator, model_validator

from ...arrays import Real
from ..validation import Number, NumberRange, Table, validated, within

Finite = Annotated[Number, within(-1e15, 1e15, "", "no drawn quantity is larger")]

Cut = Annotated[
    Number, within(0.01, 8.0, "deviations", "beyond 8 deviations no value is ever drawn")
]

Chances = Real | np.float64 | float


class _Drawn(Table):
    """Base of all distributions.

    low, high: the smallest and the largest value that can be drawn. at: quantiles, the values below
    which a draw falls with the given probabilities.
    """


class Fixed(_Drawn):
    """A constant value; a number in place of a table is short for this.

    value: of every draw.
    """

    distribution: Literal["fixed"] = "fixed"
    value: Number

    @property
    def low(self) -> float:
        return self.value

    @property
    def high(self) -> float:
        return self.value

    def at(self, chance: Chances) -> Real:
        return np.full(np.shape(chance), float(self.value))


class Uniform(_Drawn):
    """Uniform between `low` and `high`; a table of these two keys alone is short for this.

    low: smallest value. high: largest value.
    """

    distribution: Literal["uniform"] = "uniform"
    low: Finite
    high: Finite

    @model_validator(mode="after")
    def _low_to_high(self) -> Self:
        if not self.low <= self.high:
            raise ValueError(f"low must be <= high, got {self.low:g} and {self.high:g}")
        return self

    def at(self, chance: Chances) -> Real:
        return self.low + (self.high - self.low) * np.asarray(chance)


class Normal(_Drawn):
    """Normal with `mean` and standard `deviation`, truncated at `cut` deviations.

    mean: of the distribution. deviation: before truncation. cut: number of deviations from the mean
    that draws do not exceed.
    """

    distribution: Literal["normal"] = "normal"
    mean: Finite
    deviation: Annotated[
        Number, within(0.0, 1e15, "(in the unit of mean)", "no drawn quantity is larger")
    ]
    cut: Cut = 3.0

    @property
    def low(self) -> float:
        return self.mean - self.cut * self.deviation

    @property
    def high(self) -> float:
        return self.mean + self.cut * self.deviation

    def at(self, chance: Chances) -> Real:
        return self.mean + self.deviation * truncated_normal(chance, self.cut)


class Lognormal(_Drawn):
    """A value whose logarithm is normally distributed around that of `median`.

    median: of the value. spread: standard deviation of the logarithm; a small one is the relative
    standard deviation of the value. cut: number of these deviations from the median that draws do
    not exceed.
    """

    distribution: Literal["lognormal"] = "lognormal"
    median: Annotated[
        Number, within(1e-15, 1e15, "(in its own unit)", "no drawn quantity is larger")
    ]
    spread: Annotated[Number, within(0.0, 10.0, "(relative)", "e to the 10th is 22,000")]
    cut: Cut = 3.0

    @property
    def low(self) -> float:
        return self.median * math.exp(-self.cut * self.spread)

    @property
    def high(self) -> float:
        return self.median * math.exp(self.cut * self.spread)

    def at(self, chance: Chances) -> Real:
        return self.median * np.exp(self.spread * truncated_normal(chance, self.cut))


def truncated_normal(chance: Chances, cut: float) -> Real:
    """Quantiles of the standard normal distribution truncated to |x| <= cut."""
    from scipy.special import ndtr, ndtri

    outside = ndtr(-cut)
    return np.clip(ndtri(outside + (1 - 2 * outside) * np.asarray(chance)), -cut, cut)


AnyDistribution = Fixed | Uniform | Normal | Lognormal


KINDS = {
    kind.model_fields["distribution"].default: kind for kind in (Fixed, Uniform, Normal, Lognormal)
}


def _chosen(given: object) -> object:
    if isinstance(given, AnyDistribution):
        return given
    if isinstance(given, bool) or not isinstance(given, dict | float | int):
        raise ValueError(f"must be a number or a table with a distribution, got {given!r}")
    if not isinstance(given, dict):
        return Fixed(value=given)
    if given.keys() == {"low", "high"}:
        return validated(Uniform, given)
    kind = KINDS.get(given.get("distribution"))
    if kind is None:
        named = given.get("distribution")
        raise ValueError(f"distribution must be one of {', '.join(KINDS)}, got {named!r}")
    return validated(kind, given)


Distribution = Annotated[AnyDistribution, BeforeValidator(_chosen)]


class EveryDrawWithin(NumberRange):
    """A validator that checks all values that a distribution can draw."""

    def __call__(self, drawn: AnyDistribution) -> AnyDistribution:
        self.check(drawn.low, drawn.high, of=" in every draw")
        return drawn


def drawn_within(low: float, high: float, unit: str, why: str) -> AfterValidator:
    """Accepts distributions whose draws are all from `low` to `high`."""
    return AfterValidator(EveryDrawWithin(low, high, unit, why))
