"""Student's t likelihood of readings, with which a few readings far off do not move a fit.

The d errors of one reading (ln |Z| and phase, or the magnitude alone) have a t distribution of nu
degrees of freedom. -2 ln of its density over that of normal errors at r = 0 is rho(q) = (nu + d)
ln(1 + q / nu) + 2 d ln(kappa) + k(nu), q = r'r / kappa², where r are the residuals of the reading
over the noise; k(nu) is 0 for d = 2.
Source: K. L. Lange, R. J. A. Little, J. M. G. Taylor, J. Am. Stat. Assoc. 84 (1989) 881.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..arrays import Complex, Integer, Real

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


ReducedSystem = tuple[Real, Real]


@dataclass(frozen=True)
class ResidualBlock:
    """Residuals of sweeps with the same number of unknowns, and their derivatives.

    readings: numbers of the sweeps, shape (sweep,). columns: indices of the unknowns that each
    depends on, its own touches first, shape (sweep, unknown). touches: number of own touches. Z:
    fitted, ohm, shape (sweep, interface, frequency). residuals: shape (sweep, residual). slopes:
    derivatives of the residuals, shape (sweep, residual, unknown).
    """

    readings: Integer
    columns: Integer
    touches: int
    Z: Complex
    residuals: Real
    slopes: Real


def reduced_system(
    blocks: Sequence[ResidualBlock], u: Real, parameters: int, scale: float
) -> ReducedSystem:
    """Residuals r and Jacobian J of blocks and of the priors of all unknowns u, in fewer rows.

    r'r, J'r and J'J are those of the full problem. All rows are divided by the root of the scale,
    except priors of the first unknowns, the parameters.
    """
    size, share = len(u), scale**-0.5
    own, shared = [np.zeros((0, size + 1))], [_priors(blocks, u, parameters, share)]
    for block in blocks:
        touches, others = _eliminated(block, u, share)
        columns = np.column_stack([block.columns, np.full(len(block.columns), size)])
        own.append(_spread(touches, columns, size + 1))
        shared.append(_spread(others, columns[:, block.touches :], size + 1))
    rest = np.vstack(shared)
    seen = np.flatnonzero(rest.any(axis=0))
    left = np.zeros((min(len(rest), len(seen)), size + 1))
    left[:, seen] = np.linalg.qr(rest[:, seen], mode="r")
    found = np.vstack([*own, left])
    return found[:, -1], found[:, :-1]


def _priors(blocks: Sequence[ResidualBlock], u: Real, parameters: int, share: float) -> Real:
    """Rows of the priors of all unknowns but touches, shape (prior, unknown and residual)."""
    weights = np.where(np.arange(len(u)) < parameters, 1.0, share)
    whole = np.column_stack([np.diag(weights), weights * u])
    touches = [block.columns[:, : block.touches].ravel() for block in blocks]
    return np.delete(whole, np.concatenate(touches), axis=0)


def _eliminated(block: ResidualBlock, u: Real, share: float) -> tuple[Real, Real]:
    """Rows of touches, and all other rows: each of shape (sweep, row, unknown and residual)."""
    count, unknowns = block.columns.shape
    priors = np.zeros((count, block.touches, unknowns + 1))
    priors[:, range(block.touches), range(block.touches)] = 1.0
    priors[:, :, -1] = u[block.columns[:, : block.touches]]
    read = np.concatenate([block.slopes, block.residuals[:, :, None]], axis=2)
    rows = share * np.concatenate([priors, read], axis=1)
    R = np.asarray(np.linalg.qr(rows, mode="r"), dtype=np.float64)
    return R[:, : block.touches], R[:, block.touches :, block.touches :]


def _spread(rows: Real, columns: Integer, size: int) -> Real:
    """Rows of each sweep, placed among all columns, shape (row, size)."""
    found = np.zeros((*rows.shape[:2], size))
    found[np.arange(len(rows))[:, None], :, columns] = rows.transpose(0, 2, 1)
    return found.reshape(-1, size)
