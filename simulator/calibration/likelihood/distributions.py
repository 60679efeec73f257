"""Profile distributions of parameters and quantities whose linear intervals do not hold."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np

from ...arrays import Real
from ...scene.parts import Setup, Skin
from ..fitting.fit import Fit
from ..results.identifiability import Information
from ..results.sheet_intervals import COMMON, MISMATCH, RATIO, SUM, Product, depend_on_ratio, sheets
from .profile import Profile, ProfiledQuantity
from .profile_distribution import Interval, ProfileDistribution

ANY = (-math.inf, math.inf)


class Distributions:
    """Profile distributions of one solution, None where the linear interval holds.

    Each is computed once. The linear interval holds for the ratio of sheets that one field
    describes, because that ratio keeps its prior.
    """

    def __init__(
        self, skin: Skin, setup: Setup, fit: Fit, information: Information, width: float
    ) -> None:
        """fit, information: with all unknown parameters. width: half of a linear interval over its
        standard deviation."""
        self._skin, self._setup, self._fit = skin, setup, fit
        self._profile = Profile(fit, information.scale, width)
        normal = (MISMATCH, RATIO) if depend_on_ratio(skin, setup, information) else ()
        self._known: dict[str, ProfileDistribution | None] = dict.fromkeys(normal)

    def of_parameter(self, name: str) -> ProfileDistribution | None:
        """Distribution of a parameter in its own unit."""
        return self._once(name, lambda: self._linear({name: 1.0}, 0.0, self._limits(name)))

    def _limits(self, name: str) -> Interval:
        prior = self._fit.spec.fitted[name]
        return prior.low, prior.high

    def of_product(self, product: Product) -> ProfileDistribution | None:
        """Distribution of the logarithm of a quantity."""
        if product.name == SUM:
            return self._once(SUM, self._sum) if COMMON in self._fit.spec.names else None
        names = self._fit.spec.names
        slopes = {name: slope for name, slope in product.slopes.items() if name in names}
        values = self._fit.values
        level = math.log(product.value) - sum(slopes[name] * values[name] for name in slopes)
        if product.name in self._known or list(slopes.values()) != [1.0]:
            return self._once(product.name, lambda: self._linear(slopes, level, ANY))
        distribution = self.of_parameter(next(iter(slopes)))
        return distribution and distribution.shifted(level)

    def _once(self, name: str, made: Callable[[], ProfiledQuantity]) -> ProfileDistribution | None:
        if name not in self._known:
            quantity = made()
            self._known[name] = (
                None if self._profile.linear(quantity) else self._profile.distribution(quantity)
            )
        return self._known[name]

    def _linear(
        self, slopes: Mapping[str, float], level: float, within: Interval
    ) -> ProfiledQuantity:
        """A weighted sum of parameters plus a constant."""
        names, priors = self._fit.spec.names, self._fit.spec.fitted
        own = np.zeros(len(self._fit.u))
        for name, slope in slopes.items():
            own[names.index(name)] = slope * priors[name].deviation
            level += slope * priors[name].center

        def read(u: Real) -> tuple[float, Real]:
            return float(level + own @ u), own

        pivot = COMMON if COMMON in slopes else next(iter(slopes))
        return ProfiledQuantity(read, names.index(pivot), within)

    def _sum(self) -> ProfiledQuantity:
        """The logarithm of the resistance of both sheets in series."""
        spec = self._fit.spec

        def read(u: Real) -> tuple[float, Real]:
            both = next(
                each for each in sheets(self._skin, self._setup, spec.values(u)) if each.name == SUM
            )
            slopes = np.zeros(len(u))
            for k, (name, prior) in enumerate(spec.fitted.items()):
                slopes[k] = both.slopes.get(name, 0.0) * prior.deviation
            return math.log(both.value), slopes

        return ProfiledQuantity(read, spec.names.index(COMMON))
