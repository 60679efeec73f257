"""Exponents of a potential where wedges of several conductances meet.

In a wedge u = r^p (a cos p t + b sin p t), t the angle; u and the current across are the same on
both sides of an edge between two. Anisotropic wedges are given as stretched so that they conduct
equally along all directions. Source: R. B. Kellogg, Appl. Anal. 4 (1975) 101.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ...arrays import Real

MIN_EXPONENT, MAX_EXPONENT, STEP = 0.01, 5.0, 0.02
"""Range and step of the exponents searched.

Beyond the range, all is as smooth as elements are.
"""
ZOOMS, ZOOMED = 4, 21
Wedges = Sequence[tuple[float, float]]
"""Angle and conductance of each wedge, anticlockwise."""


def around(wedges: Wedges) -> float:
    """Smallest exponent at a point with wedges all around, 1 where they are equal."""
    return min(_first(lambda p: 2 - np.trace(_transfer(wedges, p)), 1.0), 1.0)


def between(wedges: Wedges, begins: bool, stops: bool) -> float:
    """Smallest exponent at a point of the rim.

    begins, stops: True if a foil fixes u at that side.
    """
    sign = 1 if begins or stops else -1
    return _first(lambda p: sign * _transfer(wedges, p)[0 if stops else 1, 1 if begins else 0])


def _transfer(wedges: Wedges, powers: Real) -> Real:
    """Matrices from potential and current over p at the first edge to the last.

    They are given for all powers, shape (2, 2, power).
    """
    M = np.eye(2)[:, :, None] * np.ones(len(powers))
    for angle, S in wedges:
        cos, sin = np.cos(powers * angle), np.sin(powers * angle)
        u, current = M
        M = np.stack([cos * u + sin / S * current, cos * current - S * sin * u])
    return M


def _first(values_at: Callable[[Real], Real], most: float = MAX_EXPONENT) -> float:
    """First power at which values that begin above 0 no longer are; inf if none."""
    low, high, count = MIN_EXPONENT, most, round((most - MIN_EXPONENT) / STEP) + 1
    for _ in range(ZOOMS + 1):
        powers = np.linspace(low, high, count)
        below = np.flatnonzero(values_at(powers) <= 0)
        if not below.size:
            return np.inf
        low, high, count = powers[max(below[0] - 1, 0)], powers[below[0]], ZOOMED
    return float(low + high) / 2


def stretched(along: Real, across: Real, S: Real) -> tuple[Real, Real]:
    """Angles between edges after a stretch that makes S isotropic, and S then.

    along, across: shape (2, ...). S: its xx, yy and xy, shape (3, ...). Both results are of shape
    (...).
    """
    xx, yy, xy = S
    isotropic = np.sqrt(xx * yy - xy**2)
    dot = yy * along[0] * across[0] + xx * along[1] * across[1]
    dot = dot - xy * (along[0] * across[1] + along[1] * across[0])
    area = isotropic * np.abs(along[0] * across[1] - along[1] * across[0])
    return np.arctan2(area, dot), isotropic
