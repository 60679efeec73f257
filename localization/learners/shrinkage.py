"""Shrinkage of the coefficients of all classes towards the few patterns that they share."""

from __future__ import annotations

import numpy as np

from ...simulator.arrays import Real


def shared(coefficients: Real, errors: Real, noise: Real) -> Real:
    """Coefficients with less noise, by shrinking the singular values of all classes together.

    Neighbouring touches change a skin similarly: the matrix of all coefficients, a row for each
    class, has few large singular values, and noise has many small ones. Each value y becomes
    sqrt((y² - b - 1)² - 4 b)/y, 0 below 1 + sqrt(b), of a matrix of shape (b n, n) in units of the
    noise times sqrt(n): M. Gavish, D. L. Donoho, IEEE Trans. Inf. Theory 63 (2017) 2137-2152, for
    the least squared error.

    coefficients: shape (class, term, number). errors: variance of each term in units of the noise,
    equal for all classes, shape (term,), > 0. noise: covariance of numbers, shape (number, number).
    """
    unit = np.linalg.inv(np.linalg.cholesky(noise)).T
    scale = np.sqrt(errors)[:, None]
    whitened = coefficients @ unit / scale
    left, values, right = np.linalg.svd(whitened.reshape(len(whitened), -1), full_matrices=False)
    short, long = sorted((len(whitened), whitened[0].size))
    y, b = values / np.sqrt(long), short / long
    above = y > 1 + np.sqrt(b)
    squared = np.square(np.square(y) - b - 1) - 4 * b
    kept = np.sqrt(np.where(above, squared, 0.0)) / np.where(above, y, 1.0) * np.sqrt(long)
    found = ((left * kept) @ right).reshape(whitened.shape)
    return np.linalg.solve(unit.T, (found * scale).swapaxes(1, 2)).swapaxes(1, 2)
