"""A smooth random field over a rectangle, Gaussian and stationary, from a seed.

Its correlation is the Gaussian kernel exp(-r² / (2 l²)) of the correlation length l. On a torus
that is larger than the rectangle by GAP of l each way the kernel is a sum of cosines, whose weights
are its spectral density; drawing an amplitude for each product of a wave along x and one along y
gives the field. Source: M. Shinozuka and G. Deodatis, Appl. Mech. Rev. 44 (1991) 191.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

GAP = 6.0
"""exp(-GAP² / 2) = 1.5e-8: what opposite edges still know of each other around the torus."""
BAND = 5.0
"""Wave numbers over 1 / l that are kept; beyond lies 6e-7 of the variance along each axis."""
AT_ONCE = 2**12


def random_field(
    x: NDArray[np.float64], sides: tuple[float, float], correlation_length: float, seed: int
) -> NDArray[np.float64]:
    """The field of mean 0 and variance 1 at positions x in m, shape (2, ...) to (...).

    sides: of the rectangle, m. The same seed gives the same field at any positions.
    """
    points = np.asarray(x, dtype=np.float64).reshape(2, -1)
    waves = [_waves(side, correlation_length) for side in sides]
    amplitudes = _amplitudes(seed, *(2 * len(k) for k, _ in waves))
    field = np.empty(points.shape[1])
    for start in range(0, points.shape[1], AT_ONCE):
        part = np.s_[start : start + AT_ONCE]
        along, across = (_basis(at[part], *wave) for at, wave in zip(points, waves, strict=True))
        field[part] = np.einsum("jp,jp->p", amplitudes.T @ along, across)
    return field.reshape(np.shape(x)[1:])


def _waves(side: float, length: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Wave numbers on the torus in rad/m and their shares of the variance, which sum to 1."""
    period = side + GAP * length
    k = 2 * np.pi / period * np.arange(np.ceil(BAND * period / (2 * np.pi * length)) + 1)
    density = np.where(k > 0, 2.0, 1.0) * np.exp(-((k * length) ** 2) / 2)
    return k, density / density.sum()


def _basis(
    x: NDArray[np.float64], k: NDArray[np.float64], share: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Cosines, then sines of every wave, each of the size of its share; shape (2 * wave, point).

    By powers of the first wave: of a hundred they are off by a hundred roundings.
    """
    turned = np.empty((len(k), len(x)), dtype=np.complex128)
    turned[0], turned[1:] = 1.0, np.exp(1j * k[1] * x)
    np.cumprod(turned, axis=0, out=turned)
    turned *= np.sqrt(share)[:, None]
    return np.concatenate([turned.real, turned.imag])


@lru_cache(maxsize=32)
def _amplitudes(seed: int, along: int, across: int) -> NDArray[np.float64]:
    return np.random.default_rng(seed).standard_normal((along, across))
