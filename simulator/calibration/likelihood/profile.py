"""The likelihood along one quantity, all else at its best: what intervals follow that bend or end.

At each place of the quantity g the least of J(u) = chi-squared and priors is sought under
g(u) = place. The square root of its rise above the least of all counts the deviations from there,
however the likelihood bends (Cox and Hinkley, Theoretical Statistics, 1974, section 9.3).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from ...fem.factors import one_blas_thread
from ..fit import INSIDE, Fit
from .profile_distribution import Interval, Law

Gradient = Callable[[NDArray[np.float64]], tuple[float, NDArray[np.float64]]]
STEP, MOST_STEPS, MOST_SOLVER_STEPS = 0.8, 14, 60
"""Deviations between places where all is linear; places on each side; evaluations at a place."""
LEAST_SHARE, MOST_GAIN = 0.1, 2.5
"""Of the way to a place that is too far; how much longer a step may be than the one before it."""
LINEAR = 0.1
"""Of J at an end of an interval, and of the drop that is left there: so little off is linear."""
OVER = 0.1
"""Of its deviation: so far an unknown may be carried over its bound, and all be linear still."""
SETTLED = 1e-6
"""Relative change of J, of unknowns and of slopes at which a place is found."""


class Along(NamedTuple):
    """A quantity. read: its value at unknowns, and its slopes to them. pivot: an unknown that it
    is linear in, and that is had from it. limits: of the quantity."""

    read: Gradient
    pivot: int
    limits: Interval = (-np.inf, np.inf)


@dataclass(frozen=True)
class Place:
    """The best unknowns there, and their J."""

    at: float
    u: NDArray[np.float64]
    misfit: float


class Profile:
    """Of one solution; intervals widened as `information` has them."""

    def __init__(self, fit: Fit, scale: float, width: float) -> None:
        """scale: that chi-squared is over. width: half of an interval over its deviation."""
        self._problem, self._scale, self.width = fit.problem, scale, width
        self._low, self._high = fit.problem.bounds()
        self._begin = fit.u
        self._moved = scale > 1

    @cached_property
    def best(self) -> NDArray[np.float64]:
        """Unknowns at the least of J: those of the fit, where nothing is scaled."""
        return self._least(self._begin, None, 0.0) if self._moved else self._begin

    @cached_property
    def _covariance(self) -> NDArray[np.float64]:
        _, J = self._at(self.best)
        return np.linalg.inv(J.T @ J).astype(np.float64)

    @cached_property
    def _spread(self) -> NDArray[np.float64]:
        """Deviation of each unknown at the fit, where all is linear."""
        J = self._at(self._begin)[1]
        return np.sqrt(np.linalg.inv(J.T @ J).diagonal()).astype(np.float64)

    def deviation(self, along: Along) -> float:
        """Of the quantity where all is linear."""
        slopes = along.read(self.best)[1]
        return float(np.sqrt(slopes @ self._covariance @ slopes))

    def linear(self, along: Along) -> bool:
        """Whether both ends of the linear interval are where the profile has them, and uncut."""
        value, slopes = along.read(self.best)
        way = self._covariance @ slopes / self.deviation(along)
        over = OVER * np.sqrt(self._covariance.diagonal())
        start = self._place(value, self.best)
        for side in (-self.width, self.width):
            end = self.best + side * way
            if np.any(end < self._low - over) or np.any(end > self._high + over):
                return False
            if not along.limits[0] <= value + side * self.deviation(along) <= along.limits[1]:
                return False
            end = self._held(along, value + side * self.deviation(along), self._inside(end))
            place = self._place(value + side * self.deviation(along), end)
            rise = (place.misfit - start.misfit) / self.width**2
            if abs(rise - 1) > LINEAR or self._left(along, end) > LINEAR * self.width**2:
                return False
        return True

    def law(self, along: Along) -> Law:
        """Of the quantity, from places that reach as far as an interval, or its limits."""
        with one_blas_thread():
            start = self._place(along.read(self.best)[0], self.best)
            below, above = (self._walk(along, start, way) for way in (-1.0, 1.0))
        found = sorted([*below, start, *above], key=lambda place: place.at)
        misfits = np.array([each.misfit for each in found])
        roots = np.sqrt(misfits - misfits.min())
        roots[: int(misfits.argmin())] *= -1
        rising = np.flatnonzero(np.diff(np.maximum.accumulate(roots), prepend=-np.inf) > 0)
        places = np.array([each.at for each in found])
        return Law(places[rising], roots[rising], along.limits)

    def _walk(self, along: Along, start: Place, way: float) -> list[Place]:
        """Places on one side, at most twice STEP deviations apart, to a limit or past an end.

        Each is sought from where the two before it point to.
        """
        limit = along.limits[int(way > 0)]
        found, last, beyond = list[Place](), start, list[Place]()
        onward = self._covariance @ along.read(self.best)[1] / self.deviation(along) ** 2
        step = STEP * self.deviation(along)
        for _ in range(MOST_STEPS):
            if beyond:
                share = STEP / (_root(beyond[-1], start) - _root(last, start))
                way_on = beyond[-1].at - last.at
                at = last.at + max(share, LEAST_SHARE) * way_on if share < 1 else beyond.pop().at
            else:
                at = limit if step >= abs(limit - last.at) else last.at + way * step
            place = self._solved(along, at, last.u + (at - last.at) * onward)
            found.append(place)
            gone = _root(place, start) - _root(last, start)
            if gone > 2 * STEP:
                beyond.append(place)
                continue
            if at == limit or _root(place, start) > self.width:
                break
            onward = (place.u - last.u) / (place.at - last.at)
            last, step = place, step * float(np.clip(STEP / max(gone, 1e-3), 1.0, MOST_GAIN))
        return found

    def _solved(self, along: Along, at: float, begin: NDArray[np.float64]) -> Place:
        return self._place(at, self._held(along, at, self._least(begin, along, at)))

    def _least(
        self, begin: NDArray[np.float64], along: Along | None, at: float
    ) -> NDArray[np.float64]:
        """Unknowns where J is least, of those where the quantity is at its place."""
        rest = np.arange(len(begin)) != (-1 if along is None else along.pivot)
        low, high = self._low[rest], self._high[rest]
        inside = np.minimum(INSIDE * self._spread[rest], (high - low) / 4)
        u = np.array(begin)

        def full(own: NDArray[np.float64]) -> NDArray[np.float64]:
            u[rest] = own
            return u.copy() if along is None else self._held(along, at, u)

        def by_rest(own: NDArray[np.float64]) -> NDArray[np.float64]:
            return self._at(full(own))[1] if along is None else self._reduced(along, full(own))

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
            max_nfev=MOST_SOLVER_STEPS,
        )
        return full(np.asarray(found.x, dtype=np.float64))

    def _held(self, along: Along, at: float, u: NDArray[np.float64]) -> NDArray[np.float64]:
        """The same unknowns with the pivot where the quantity is at its place."""
        value, slopes = along.read(u)
        moved = u.copy()
        moved[along.pivot] += (at - value) / slopes[along.pivot]
        return moved

    def _inside(self, u: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.clip(u, self._low, self._high)

    def _at(self, u: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        return self._problem.condensed(u, self._scale)

    def _reduced(self, along: Along, u: NDArray[np.float64]) -> NDArray[np.float64]:
        """Slopes to all but the pivot, which follows them."""
        J, slopes = self._at(u)[1], along.read(u)[1]
        rest = J - np.outer(J[:, along.pivot], slopes / slopes[along.pivot])
        return np.asarray(np.delete(rest, along.pivot, axis=1), dtype=np.float64)

    def _left(self, along: Along, u: NDArray[np.float64]) -> float:
        """By how much J would fall yet at this place, as its slopes there say."""
        J, r = self._reduced(along, u), self._at(u)[0]
        downhill = J.T @ r
        return float(downhill @ np.linalg.solve(J.T @ J, downhill))

    def _place(self, at: float, u: NDArray[np.float64]) -> Place:
        r = self._at(u)[0]
        return Place(at, u, float(r @ r))


def _root(place: Place, start: Place) -> float:
    return float(np.sqrt(max(place.misfit - start.misfit, 0.0)))
