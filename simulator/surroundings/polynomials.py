"""Smooth potentials of a sheet: products of Legendre polynomials on a rectangle.

The rectangle is the one around the sheet.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial.legendre import legder, legval

from ..arrays import Integer, Mask, Real

SMOOTH = 1
DEGREE, MIN_DEGREE = 8, 3
"""Degrees along the longer side of a skin, and minimum along any.

Half a wave of the highest is an eighth of the side.
"""


@dataclass(frozen=True)
class Polynomials:
    """P_i(2x/L - 1) P_j(2y/W - 1), i up to degrees[0] and j up to degrees[1].

    sides: L and W in m.
    """

    sides: tuple[float, float]
    degrees: tuple[int, int]

    @property
    def count(self) -> int:
        """Number of polynomials."""
        return (self.degrees[0] + 1) * (self.degrees[1] + 1)

    @property
    def odd(self) -> Mask:
        """True for polynomials that are odd about the middle in x, and in y.

        Shape (2, polynomial).
        """
        return self._degrees % 2 == 1

    @property
    def squared(self) -> Real:
        """Integrals of their squares, m², shape (polynomial,)."""
        i, j = self._degrees
        return np.prod(self.sides) / ((2 * i + 1) * (2 * j + 1))

    @property
    def smooth(self) -> Mask:
        """True for polynomials of degree SMOOTH at most along either side, shape (polynomial,)."""
        return self._degrees.max(axis=0) <= SMOOTH

    @property
    def _degrees(self) -> Integer:
        """Degrees along x and y, shape (2, polynomial)."""
        i, j = np.meshgrid(*(np.arange(degree + 1) for degree in self.degrees), indexing="ij")
        return np.stack([i.ravel(), j.ravel()])

    def at(self, x: Real) -> Real:
        """Values at positions in m, shape (2, ...) to (polynomial, ...)."""
        return self._product(x, (0, 0))

    def slopes_at(self, x: Real) -> Real:
        """Gradients in 1/m, shape (2, ...) to (2, polynomial, ...)."""
        return np.stack([self._product(x, (1, 0)), self._product(x, (0, 1))])

    def _product(self, x: Real, derivatives: tuple[int, int]) -> Real:
        along, across = (
            legval(2 * at / side - 1, legder(np.eye(degree + 1), order, axis=0))
            * (2 / side) ** order
            for at, side, degree, order in zip(
                x, self.sides, self.degrees, derivatives, strict=True
            )
        )
        return (along[:, None] * across).reshape(self.count, *x.shape[1:])


def polynomials(sides: tuple[float, float]) -> Polynomials:
    """Polynomials of about the same resolution along both sides, m."""
    longer = max(sides)
    degrees = [max(MIN_DEGREE, int(np.ceil(DEGREE * side / longer))) for side in sides]
    return Polynomials(sides, (degrees[0], degrees[1]))
