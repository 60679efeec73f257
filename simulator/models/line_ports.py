"""A line as a network between its two ends and earth: two shunts and a series admittance.

A uniform segment of total resistance R and capacitance C has, with q² = s R C, the series
admittance q / (R sinh q) and at each end the shunt s C tanh(q/2) / q. Joining two networks
eliminates the node between them. All terms are sums, products and ratios of admittances with
positive real part, so no digits are lost at low frequency, and nothing overflows at high frequency.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import NamedTuple

import numpy as np

from ..arrays import Complex

LEVELS_OF_FRACTION = 12
SERIES_TERMS = 12


class LinePorts(NamedTuple):
    """Admittances in S, shape (frequency,): of each end to earth, and between the ends."""

    near: Complex
    between: Complex
    far: Complex

    def joined(self, other: LinePorts) -> LinePorts:
        """The line continued at its far end by another one."""
        middle = self.far + other.near
        total = self.between + other.between + middle
        return LinePorts(
            self.near + self.between * middle / total,
            self.between * other.between / total,
            other.far + other.between * middle / total,
        )

    def to_earth(self, driven: Collection[int], at_earth: Collection[int] = ()) -> Complex:
        """Impedance to earth in ohm of the driven ends, tied together.

        driven, at_earth: 0 for the near end, 1 for the far one; an end that is neither is open.
        """
        if len(driven) == 2:
            return 1 / (self.near + self.far)
        own, other = (self.near, self.far) if 0 in driven else (self.far, self.near)
        if at_earth:
            return 1 / (own + self.between)
        return 1 / (own + self.between * other / (self.between + other))


def film(R: float, s: Complex) -> LinePorts:
    """Network of a contact resistance in ohm, shape as s."""
    nothing = np.zeros(s.shape, dtype=complex)
    return LinePorts(nothing, np.full_like(nothing, 1 / R), nothing)


def segment(R: float, C: float, s: Complex) -> LinePorts:
    """Network of a uniform segment. R: ohm. C: F. s: 1/s, shape (frequency,)."""
    z = s * R * C
    shunt = s * C / 2 * tanh_ratio(z / 4)
    return LinePorts(shunt, _sinh_ratio(z) / R, shunt)


def tanh_ratio(z: Complex) -> Complex:
    """tanh(q)/q for q² = z, accurate to rounding in the real and in the imaginary part.

    Small z use Lambert's continued fraction 1/(1 + z/(3 + z/(5 + ...))), large z the definition.
    """
    small = np.abs(z) < 1
    near, fraction = np.where(small, z, 0), np.zeros(z.shape, dtype=complex)
    for level in range(LEVELS_OF_FRACTION, 0, -1):
        fraction = near / (2 * level + 1 + fraction)
    q = np.sqrt(np.where(small, 1, z))
    ratio = (np.tanh(q) / q).astype(np.complex128)
    ratio[small] = 1 / (1 + fraction[small])
    return ratio


def _sinh_ratio(z: Complex) -> Complex:
    """q / sinh(q) for q² = z, accurate to rounding in the real and in the imaginary part."""
    small = np.abs(z) < 1
    near, total = np.where(small, z, 0), np.zeros(z.shape, dtype=complex)
    for k in range(SERIES_TERMS, 0, -1):
        total = near / (2 * k * (2 * k + 1)) * (1 + total)
    q = np.sqrt(np.where(small, 1, z))
    ratio = 2 * q * np.exp(-q) / -np.expm1(-2 * q)
    return np.where(small, 1 / (1 + total), ratio)
