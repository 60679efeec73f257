"""Laws of parameters and of sheets, where their intervals are not those of a linear fit."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from ...scene.scene import Scene
from ..fit import Fit
from ..identifiability import Information
from ..sheet_intervals import COMMON, MISMATCH, RATIO, SUM, Product, hang_on_ratio, sheets
from .profile import Along, Profile
from .profile_distribution import Interval, Law

ANY = (-math.inf, math.inf)


class Laws:
    """Of one solution. Each law is looked for once, and is None where the linear interval holds.

    Of a ratio of sheets that one field sees it does: nothing but its prior tells it.
    """

    def __init__(self, scene: Scene, fit: Fit, information: Information, width: float) -> None:
        """fit, information: of all that is not known. width: half of an interval over its
        deviation, where all is linear."""
        self._scene, self._fit = scene, fit
        self._profile = Profile(fit, information.scale, width)
        normal = (MISMATCH, RATIO) if hang_on_ratio(scene, information) else ()
        self._known: dict[str, Law | None] = dict.fromkeys(normal)

    def of_parameter(self, name: str) -> Law | None:
        """In the parameter's own unit."""
        return self._once(name, lambda: self._linear({name: 1.0}, 0.0, self._limits(name)))

    def _limits(self, name: str) -> Interval:
        prior = self._fit.spec.fitted[name]
        return prior.low, prior.high

    def of_product(self, product: Product) -> Law | None:
        """Of its logarithm."""
        if product.name == SUM:
            return self._once(SUM, self._sum) if COMMON in self._fit.spec.names else None
        names = self._fit.spec.names
        slopes = {name: slope for name, slope in product.slopes.items() if name in names}
        values = self._fit.values
        level = math.log(product.value) - sum(slopes[name] * values[name] for name in slopes)
        if product.name in self._known or list(slopes.values()) != [1.0]:
            return self._once(product.name, lambda: self._linear(slopes, level, ANY))
        law = self.of_parameter(next(iter(slopes)))
        return law and law.shifted(level)

    def _once(self, name: str, made: Callable[[], Along]) -> Law | None:
        if name not in self._known:
            along = made()
            self._known[name] = None if self._profile.linear(along) else self._profile.law(along)
        return self._known[name]

    def _linear(self, slopes: Mapping[str, float], level: float, within: Interval) -> Along:
        """A sum of parameters."""
        names, priors = self._fit.spec.names, self._fit.spec.fitted
        own = np.zeros(len(self._fit.u))
        for name, slope in slopes.items():
            own[names.index(name)] = slope * priors[name].deviation
            level += slope * priors[name].center

        def read(u: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
            return float(level + own @ u), own

        pivot = COMMON if COMMON in slopes else next(iter(slopes))
        return Along(read, names.index(pivot), within)

    def _sum(self) -> Along:
        """The logarithm of both sheets in series."""
        asked, scene = self._fit.spec, self._scene

        def read(u: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
            both = next(each for each in sheets(scene, asked.values(u)) if each.name == SUM)
            slopes = np.zeros(len(u))
            for k, (name, prior) in enumerate(asked.fitted.items()):
                slopes[k] = both.slopes.get(name, 0.0) * prior.deviation
            return math.log(both.value), slopes

        return Along(read, asked.names.index(COMMON))
