"""Profile distributions of parameters and quantities whose linear intervals do not hold."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import least_squares

from ..arrays import Real
from ..fem.factors import one_blas_thread
from ..scene.parts import Setup, Skin
from .fit import INSIDE, Fit
from .identifiability import Information
from .profile_distribution import Interval, ProfileDistribution
from .sheet_intervals import COMMON, MISMATCH, RATIO, SUM, Product, depend_on_ratio, sheets

Gradient = Callable[[Real], tuple[float, Real]]
STEP, MAX_STEPS, MAX_SOLVER_STEPS = 0.8, 14, 60
"""Linear deviations between points; largest number of points on each side; evaluations a point."""
MIN_SHARE, MAX_GAIN = 0.1, 2.5
"""Smallest share of a step that was too long; largest ratio of a step to the one before it."""
LINEAR = 0.1
"""Largest relative deviation of J at an end of a linear interval, and of its remaining drop."""
OVER = 0.1
"""Largest excess of an unknown over its bound, in its standard deviation."""
SETTLED = 1e-6
"""Relative change of J, of unknowns and of slopes at which a minimum is accepted."""


class ProfiledQuantity(NamedTuple):
    """A quantity with its value and slopes by the unknowns (`read`).

    pivot: index of an unknown in which it is linear, and which its value determines. limits: of the
    quantity.
    """

    read: Gradient
    pivot: int
    limits: Interval = (-np.inf, np.inf)


@dataclass(frozen=True)
class ProfilePoint:
    """A value of the quantity (`at`), the best unknowns there, and their J (`misfit`)."""

    at: float
    u: Real
    misfit: float


class Profile:
    """Profile likelihoods of one solution, widened by the scale of `Information`."""

    def __init__(self, fit: Fit, scale: float, width: float) -> None:
        """scale: divides chi-squared. width: half of an interval over its standard deviation."""
        self._problem, self._scale, self.width = fit.problem, scale, width
        self._low, self._high = fit.problem.bounds()
        self._begin = fit.u
        self._moved = scale > 1

    @cached_property
    def best(self) -> Real:
        """Unknowns at the minimum of J: those of the fit, unless the scale moves it."""
        return self._minimum(self._begin, None, 0.0) if self._moved else self._begin

    @cached_property
    def _covariance(self) -> Real:
        _, J = self._at(self.best)
        return np.linalg.inv(J.T @ J).astype(np.float64)

    @cached_property
    def _spread(self) -> Real:
        """Linear standard deviation of each unknown at the fit."""
        J = self._at(self._begin)[1]
        return np.sqrt(np.linalg.inv(J.T @ J).diagonal()).astype(np.float64)

    def deviation(self, quantity: ProfiledQuantity) -> float:
        """Linear standard deviation of the quantity."""
        slopes = quantity.read(self.best)[1]
        return float(np.sqrt(slopes @ self._covariance @ slopes))

    def linear(self, quantity: ProfiledQuantity) -> bool:
        """True if the profile confirms both ends of the linear interval, and no limit cuts it."""
        value, slopes = quantity.read(self.best)
        direction = self._covariance @ slopes / self.deviation(quantity)
        over = OVER * np.sqrt(self._covariance.diagonal())
        start = self._place(value, self.best)
        for side in (-self.width, self.width):
            end = self.best + side * direction
            if np.any(end < self._low - over) or np.any(end > self._high + over):
                return False
            if (
                not quantity.limits[0]
                <= value + side * self.deviation(quantity)
                <= quantity.limits[1]
            ):
                return False
            end = self._constrained(
                quantity, value + side * self.deviation(quantity), self._inside(end)
            )
            point = self._place(value + side * self.deviation(quantity), end)
            rise = (point.misfit - start.misfit) / self.width**2
            if (
                abs(rise - 1) > LINEAR
                or self._remaining_drop(quantity, end) > LINEAR * self.width**2
            ):
                return False
        return True

    def distribution(self, quantity: ProfiledQuantity) -> ProfileDistribution:
        """Distribution of the quantity, from points that reach to the interval or its limits."""
        with one_blas_thread():
            start = self._place(quantity.read(self.best)[0], self.best)
            below, above = (self._walk(quantity, start, direction) for direction in (-1.0, 1.0))
        found = sorted([*below, start, *above], key=lambda point: point.at)
        misfits = np.array([each.misfit for each in found])
        roots = np.sqrt(misfits - misfits.min())
        roots[: int(misfits.argmin())] *= -1
        rising = np.flatnonzero(np.diff(np.maximum.accumulate(roots), prepend=-np.inf) > 0)
        places = np.array([each.at for each in found])
        return ProfileDistribution(places[rising], roots[rising], quantity.limits)

    def _walk(
        self, quantity: ProfiledQuantity, start: ProfilePoint, direction: float
    ) -> list[ProfilePoint]:
        """Points on one side, at most twice STEP deviations apart, to a limit or past an end.

        They end where the pivot leaves the model's reach; the distribution extrapolates from there.

        Each minimization starts from an extrapolation of the two points before it.
        """
        limit = quantity.limits[int(direction > 0)]
        found, last, beyond = list[ProfilePoint](), start, list[ProfilePoint]()
        onward = self._covariance @ quantity.read(self.best)[1] / self.deviation(quantity) ** 2
        step = STEP * self.deviation(quantity)
        for _ in range(MAX_STEPS):
            if beyond:
                share = STEP / (_root(beyond[-1], start) - _root(last, start))
                way_on = beyond[-1].at - last.at
                at = last.at + max(share, MIN_SHARE) * way_on if share < 1 else beyond.pop().at
            else:
                at = limit if step >= abs(limit - last.at) else last.at + direction * step
            begin = last.u + (at - last.at) * onward
            if found and self._beyond_reach(quantity, self._constrained(quantity, at, begin)):
                break
            point = self._solved(quantity, at, begin)
            found.append(point)
            gone = _root(point, start) - _root(last, start)
            if gone > 2 * STEP:
                beyond.append(point)
                continue
            if at == limit or _root(point, start) > self.width:
                break
            onward = (point.u - last.u) / (point.at - last.at)
            last, step = point, step * float(np.clip(STEP / max(gone, 1e-3), 1.0, MAX_GAIN))
        return found

    def _solved(self, quantity: ProfiledQuantity, at: float, begin: Real) -> ProfilePoint:
        return self._place(at, self._constrained(quantity, at, self._minimum(begin, quantity, at)))

    def _minimum(self, begin: Real, quantity: ProfiledQuantity | None, at: float) -> Real:
        """Unknowns of minimal J among those at which the quantity has the value `at`."""
        rest = np.arange(len(begin)) != (-1 if quantity is None else quantity.pivot)
        low, high = self._low[rest], self._high[rest]
        inside = np.minimum(INSIDE * self._spread[rest], (high - low) / 4)
        u = np.array(begin)

        def full(own: Real) -> Real:
            u[rest] = own
            return u.copy() if quantity is None else self._constrained(quantity, at, u)

        def by_rest(own: Real) -> Real:
            return (
                self._at(full(own))[1] if quantity is None else self._reduced(quantity, full(own))
            )

        exact: Any = by_rest
        found = least_squares(
            lambda own: self._at(full(own))[0],
            np.clip(begin[rest], low + inside, high - inside),
            exact,
            bounds=(low, high),
            x_scale="jac",
            ftol=SETTLED,
            xtol=SETTLED,
            gtol=SETTLED,
            max_nfev=MAX_SOLVER_STEPS,
        )
        return full(np.asarray(found.x, dtype=np.float64))

    def _constrained(self, quantity: ProfiledQuantity, at: float, u: Real) -> Real:
        """The unknowns with the pivot changed such that the quantity has the value `at`."""
        value, slopes = quantity.read(u)
        moved = u.copy()
        moved[quantity.pivot] += (at - value) / slopes[quantity.pivot]
        return moved

    def _beyond_reach(self, quantity: ProfiledQuantity, u: Real) -> bool:
        """True if the pivot, which the minimization does not bound, leaves the model's reach."""
        pivot = quantity.pivot
        over = OVER * self._spread[pivot]
        return not self._low[pivot] - over <= u[pivot] <= self._high[pivot] + over

    def _inside(self, u: Real) -> Real:
        return np.clip(u, self._low, self._high)

    def _at(self, u: Real) -> tuple[Real, Real]:
        return self._problem.reduced_system(u, self._scale)

    def _reduced(self, quantity: ProfiledQuantity, u: Real) -> Real:
        """Jacobian by all unknowns but the pivot, which follows from them."""
        J, slopes = self._at(u)[1], quantity.read(u)[1]
        rest = J - np.outer(J[:, quantity.pivot], slopes / slopes[quantity.pivot])
        return np.asarray(np.delete(rest, quantity.pivot, axis=1), dtype=np.float64)

    def _remaining_drop(self, quantity: ProfiledQuantity, u: Real) -> float:
        """Further decrease of J at this value that its slopes predict."""
        J, r = self._reduced(quantity, u), self._at(u)[0]
        downhill = J.T @ r
        return float(downhill @ np.linalg.solve(J.T @ J, downhill))

    def _place(self, at: float, u: Real) -> ProfilePoint:
        r = self._at(u)[0]
        return ProfilePoint(at, u, float(r @ r))


def _root(point: ProfilePoint, start: ProfilePoint) -> float:
    return float(np.sqrt(max(point.misfit - start.misfit, 0.0)))


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
