"""Correlation of the residuals of a fit, and the number of independent readings that it leaves.

Noise is independent from one frequency and one sweep to the next. Residuals that are not have a
cause that the model lacks, and determine the parameters less well than their number says.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from ..arrays import Real
from .fit import Fit

FEWEST = 12
"""Fewest frequencies of an interface at which the correlation is estimated."""
ROUNDS, MAX_REMOVED = 3, 0.5
"""Rounds of the correction for what a fit removes, and its largest share of the errors."""


def neighbour_correlation(fit: Fit) -> float:
    """Correlation of residuals of ln |Z| and of phase at neighbouring frequencies.

    0 where no interface has FEWEST frequencies.
    """
    products, squares = 0.0, 0.0
    for own in _residuals(fit):
        products += float((own[..., 1:] * own[..., :-1]).sum())
        squares += float((own[..., 1:] ** 2).sum() + (own[..., :-1] ** 2).sum()) / 2
    return products / squares if squares else 0.0


def readings_per_independent_one(fit: Fit, fitted: float) -> float:
    """Number of readings that tell as much as one with an independent error, at least 1.

    fitted: number of parameters that the readings determine. See `integrated_correlation`. A fit
    absorbs the part of an error that resembles a change of its parameters: that part is a bias,
    which no residual shows.
    """
    return integrated_correlation(_residuals(fit), fitted)


def integrated_correlation(residuals: list[Real], fitted: float = 0.0) -> float:
    """Variance of a sum of errors over that of as many independent ones, at least 1.

    residuals: of each interface, shape (sweep, part, frequency), frequencies ascending. The ratio
    is (c(0) + 2 c(1) + ... + 2 c(m)) / c, where c(l) is the product of the sums over all sweeps, l
    frequencies apart, m the last lag before c(l) <= 0, and c the sum of squares. Source: C. J.
    Geyer, Stat. Sci. 7 (1992) 473, section 3.3, with a cut at zero.

    fitted: number of parameters. Their fit removes a share a = fitted / (number of independent
    sums) of the errors, which would have been smooth: errors have (1 - a) c(l) + a c(0) n(l) / n
    with n(l) pairs of n sums.
    """
    sums = [own.sum(axis=0) for own in residuals]
    squares = sum(float((own**2).sum()) for own in residuals)
    products = np.array(list(_products(sums)))
    if not squares or not len(products):
        return 1.0
    count = sum(own.size for own in sums)
    lags = range(1, len(products))
    pairs = [2 * sum(own[:, lag:].size for own in sums) for lag in lags]
    smooth = products[0] * np.array([count, *pairs]) / count
    found, removed = 1.0, 0.0
    for _ in range(ROUNDS):
        of_errors = (1 - removed) * products + removed * smooth
        found = max(1.0, float(of_errors.sum()) / squares)
        removed = min(fitted * found * squares / (products[0] * count), MAX_REMOVED)
    return found


def _products(sums: list[Real]) -> Iterator[float]:
    """c(0), then 2 c(1), 2 c(2), ... while positive. sums: shape (part, frequency) each."""
    for lag in range(max((own.shape[-1] for own in sums), default=0)):
        product = sum(float((own[:, lag:] * own[:, : own.shape[-1] - lag]).sum()) for own in sums)
        if product <= 0:
            return
        yield product if lag == 0 else 2 * product


def _residuals(fit: Fit) -> list[Real]:
    """Residuals of each interface with FEWEST frequencies, shape (sweep, part, frequency).

    The parts are ln |Z| and phase. Student's t errors weight the readings.
    """
    measured = fit.spec.measurements
    shape = len(measured.sweeps), 2, *measured.sweeps[0].Z.shape
    r = fit.problem.residuals(fit.u)[: math.prod(shape)].reshape(shape)
    if fit.spec.tail is not None:
        r = r * np.sqrt(fit.spec.tail.weights((r**2).sum(axis=1, keepdims=True)))
    r = r[:, : measured.per_reading]
    return [r[:, :, k, read] for k, read in enumerate(measured.read) if read.sum() >= FEWEST]
