"""Gauss-Newton steps of a fit with one more unknown, without further evaluations of its model."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...arrays import Complex, Mask
from ..fitting.fit import Fit


class Step(NamedTuple):
    """The amplitude of a change of ln Z that fits best, and the share of chi-squared it leaves."""

    amplitude: float
    left: float


class LinearSteps:
    """Linear fits of a change of the readings along with all unknowns, at a solution.

    Unknowns at a bound stay there. Student's t errors weight the readings as at the solution.
    """

    def __init__(self, fit: Fit, used: Mask | None = None) -> None:
        """used: sweeps that count, shape (sweep,); by default all."""
        problem, u, spec = fit.problem, fit.u, fit.spec
        self._problem = problem
        r, J, squares = problem.residuals(u), problem.jacobian(u), problem.all_squares(u)
        weights = np.ones(squares.shape) if spec.tail is None else spec.tail.weights(squares)
        if used is not None:
            weights = weights * used[:, None]
        self._root = np.concatenate([np.sqrt(np.tile(weights, 2)).ravel(), np.ones(len(u))])
        low, high = problem.bounds()
        inside = (u > low) & (u < high)
        self._basis = np.linalg.qr((self._root[:, None] * J)[:, inside])[0]
        self._counted = np.ones(len(r), dtype=np.bool_)
        first = len(r) - len(u)
        self._counted[first : first + len(spec.fitted)] = False
        self._r = self._free(self._root * r)

    def step(self, change: Complex, low: float = 0.0, high: float = np.inf) -> Step:
        """The best step. change: of ln Z for an amplitude of 1, broadcast to (sweep, interface,
        frequency). low, high: limits of the amplitude."""
        d = np.zeros(len(self._r))
        whitened = self._problem.whitened(change).ravel()
        d[: len(whitened)] = whitened
        d = self._free(self._root * d)
        size = float(d @ d)
        amplitude = float(np.clip(-(d @ self._r) / size, low, high)) if size else low
        after, before = (self._r + amplitude * d)[self._counted], self._r[self._counted]
        return Step(amplitude, float(after @ after) / float(before @ before))

    def _free(self, change: np.ndarray) -> np.ndarray:
        """What no change of the other unknowns removes."""
        return change - self._basis @ (self._basis.T @ change)
