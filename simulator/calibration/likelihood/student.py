"""Student's t likelihood of readings, with which a few readings far off do not move a fit.

The d errors of one reading (ln |Z| and phase, or the magnitude alone) have a t distribution of nu
degrees of freedom. -2 ln of its density over that of normal errors at r = 0 is rho(q) = (nu + d)
ln(1 + q / nu) + 2 d ln(kappa) + k(nu), q = r'r / kappa², where r are the residuals of the reading
over the noise; k(nu) is 0 for d = 2.
Source: K. L. Lange, R. J. A. Little, J. M. G. Taylor, J. Am. Stat. Assoc. 84 (1989) 881.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...arrays import Real
from .qr_reduction import ResidualBlock

SERIES_BELOW = 1e-6
"""q over nu below which functions of it are taken from their series."""
FREEDOM = (1.0, 30.0)
"""Range of estimated degrees of freedom: a Cauchy distribution, and nearly a normal one."""
CLEAR_GAIN = 10.0
"""Smallest 2 ln of the ratio of likelihoods, beyond the price ln(n) of one more parameter, at which
the t distribution is chosen: "very strong" in R. E. Kass, A. E. Raftery, J. Am. Stat. Assoc. 90
(1995) 773."""
SCALE_ROUNDS = 60
FAR_OFF = 25.0
"""q from which a reading counts as far off: five times the noise."""


@dataclass(frozen=True)
class StudentT:
    """Errors of readings. freedom: nu. scale: kappa, of the noise. parts: d."""

    freedom: float
    scale: float = 1.0
    parts: int = 2

    def weights(self, squares: Real) -> Real:
        """Weight of each reading in the fit, d rho / dq. squares: r'r of each, not over kappa²."""
        return (self.freedom + self.parts) / (self.freedom + squares / self.scale**2)

    @property
    def information(self) -> float:
        """Information of weighted readings on the parameters, over that of normal errors."""
        return (self.freedom + self.parts) / (self.freedom + self.parts + 2)

    def damped(self, block: ResidualBlock) -> ResidualBlock:
        """Residuals R = r sqrt(rho(q) / q), so that R'R is the sum of rho, and their slopes."""
        both = block.residuals, block.slopes
        r, J = (np.stack(np.split(each / self.scale, 2, axis=1)) for each in both)
        q = (r**2).sum(axis=0)
        x = np.maximum(q / self.freedom, 1e-300)
        rho = (self.freedom + self.parts) * np.log1p(x)
        g = np.sqrt(rho / (self.freedom * x))
        with np.errstate(over="ignore"):
            bend = (1 / ((1 + x) * np.log1p(x)) - 1 / x) / self.freedom
        dg = g / 2 * np.where(x < SERIES_BELOW, -0.5 / self.freedom, bend)
        along = 2 * (r[..., None] * J).sum(axis=0)
        slopes = g[..., None] * J + (r * dg)[..., None] * along
        return replace(
            block, residuals=np.concatenate(r * g, axis=1), slopes=np.concatenate(slopes, axis=1)
        )


def likeliest(squares: Real, freedom: float, parts: int = 2) -> StudentT | None:
    """The likeliest t distribution of residuals; None where normal errors explain them as well.

    squares: r'r of each reading over the noise, shape (reading,). freedom: of the residuals.
    parts: of each reading.
    """
    tail = fitted_tail(squares, freedom, parts=parts)
    of_normal = freedom + freedom * math.log(max(float(squares.sum()), 1e-24) / freedom)
    gain = of_normal - _misfit(tail, squares, freedom)
    return tail if gain - math.log(parts * len(squares)) > CLEAR_GAIN else None


def fitted_tail(squares: Real, freedom: float, min_scale: float = 0.0, parts: int = 2) -> StudentT:
    """The likeliest t distribution of residuals. See `likeliest`."""
    from scipy.optimize import minimize_scalar

    def tail(logarithm: float) -> StudentT:
        begin = StudentT(math.exp(logarithm), parts=parts)
        return _scaled(begin, squares, freedom, min_scale)

    low, high = map(math.log, FREEDOM)
    found: Any = minimize_scalar(
        lambda logarithm: _misfit(tail(logarithm), squares, freedom),
        bounds=(low, high),
        method="bounded",
        options={"xatol": 1e-3},
    )
    return tail(float(found.x))


def _scaled(tail: StudentT, squares: Real, freedom: float, min_scale: float) -> StudentT:
    """The distribution with the likeliest kappa, at which the weighted squares are `freedom`."""
    scale = math.sqrt(max(float(np.median(squares)), 1e-12))
    for _ in range(SCALE_ROUNDS):
        weights = replace(tail, scale=scale).weights(squares)
        scale = math.sqrt(max(float(weights @ squares) / freedom, 1e-24))
    return replace(tail, scale=max(scale, min_scale))


def _misfit(tail: StudentT, squares: Real, freedom: float) -> float:
    q = squares / tail.scale**2
    rho = (tail.freedom + tail.parts) * np.log1p(q / tail.freedom)
    constant = len(squares) * _normalization(tail.freedom, tail.parts)
    return float(rho.sum()) + 2 * freedom * math.log(tail.scale) + constant


def _normalization(nu: float, d: int) -> float:
    """-2 ln of the density at 0 over that of a normal distribution, kappa = 1."""
    density = math.lgamma((nu + d) / 2) - math.lgamma(nu / 2) - d / 2 * math.log(nu / 2)
    return -2 * density
