"""Distributions as a scene file writes them; all are bounded, so that a trained range is finite."""

from __future__ import annotations

import math
from typing import Annotated, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, BeforeValidator, Field, ValidationError, model_validator

from simulator.table import Table
from simulator.validation import Number, above_zero, at_least_zero, one_line

Finite = Annotated[Number, Field(allow_inf_nan=False)]
Cut = Annotated[Number, above_zero("deviations")]
Chances = NDArray[np.float64] | np.float64 | float
LARGEST_EXPONENT = 700.0


class Fixed(Table):
    """One value, always; a plain number means this."""

    distribution: Literal["fixed"] = "fixed"
    value: Finite

    @property
    def low(self) -> float:
        """The least value that is drawn."""
        return self.value

    @property
    def high(self) -> float:
        """The largest value that is drawn."""
        return self.value

    def at(self, chance: Chances) -> NDArray[np.float64]:
        """The values below which a draw falls with these chances (quantiles)."""
        return np.full(np.shape(chance), float(self.value))


class Uniform(Table):
    """Any value between `low` and `high` alike."""

    distribution: Literal["uniform"] = "uniform"
    low: Finite
    high: Finite

    @model_validator(mode="after")
    def _low_to_high(self) -> Self:
        if not self.low <= self.high:
            raise ValueError(f"low must be <= high, got {self.low:g} and {self.high:g}")
        return self

    def at(self, chance: Chances) -> NDArray[np.float64]:
        """The values below which a draw falls with these chances (quantiles)."""
        return self.low + (self.high - self.low) * np.asarray(chance)


class Normal(Table):
    """Normal about `mean` with standard `deviation`; nothing beyond `cut` deviations is drawn."""

    distribution: Literal["normal"] = "normal"
    mean: Finite
    deviation: Annotated[Number, at_least_zero("(in the unit of mean)")]
    cut: Cut = 3.0

    @property
    def low(self) -> float:
        """The least value that is drawn."""
        return self.mean - self.cut * self.deviation

    @property
    def high(self) -> float:
        """The largest value that is drawn."""
        return self.mean + self.cut * self.deviation

    def at(self, chance: Chances) -> NDArray[np.float64]:
        """The values below which a draw falls with these chances (quantiles)."""
        return self.mean + self.deviation * truncated_normal(chance, self.cut)


class Lognormal(Table):
    """A value whose logarithm is normal about that of `median`.

    spread: standard deviation of the logarithm, for small ones the relative standard deviation;
    nothing beyond `cut` of them is drawn.
    """

    distribution: Literal["lognormal"] = "lognormal"
    median: Annotated[Number, above_zero("(in its own unit)")]
    spread: Annotated[Number, at_least_zero("(relative)")]
    cut: Cut = 3.0

    @model_validator(mode="after")
    def _within_floating_point(self) -> Self:
        if abs(math.log(self.median)) + self.cut * self.spread > LARGEST_EXPONENT:
            raise ValueError(f"spread must be smaller, got {self.spread:g} cut at {self.cut:g}")
        return self

    @property
    def low(self) -> float:
        """The least value that is drawn."""
        return self.median * math.exp(-self.cut * self.spread)

    @property
    def high(self) -> float:
        """The largest value that is drawn."""
        return self.median * math.exp(self.cut * self.spread)

    def at(self, chance: Chances) -> NDArray[np.float64]:
        """The values below which a draw falls with these chances (quantiles)."""
        return self.median * np.exp(self.spread * truncated_normal(chance, self.cut))


def truncated_normal(chance: Chances, cut: float) -> NDArray[np.float64]:
    """Quantiles of the standard normal distribution of which only |x| <= cut is kept."""
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
    kind = KINDS.get(given.get("distribution"))
    if kind is None:
        named = given.get("distribution")
        raise ValueError(f"distribution must be one of {', '.join(KINDS)}, got {named!r}")
    try:
        return kind.model_validate(given)
    except ValidationError as error:
        raise ValueError(one_line(error)) from error


Distribution = Annotated[AnyDistribution, BeforeValidator(_chosen)]


def bounded(least: float, unit: str, *, strictly: bool = False) -> AfterValidator:
    """Accepts distributions of which every draw is >= least (or > least); names the unit."""

    def validate(drawn: AnyDistribution) -> AnyDistribution:
        if not (drawn.low > least if strictly else drawn.low >= least):
            sign = ">" if strictly else ">="
            raise ValueError(f"must be {sign} {least:g} {unit} in every draw, got {drawn.low:g}")
        return drawn

    return AfterValidator(validate)
