"""Symmetric 2x2 tensors as (xx, yy, xy), shape (3, ...)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def directed(ratio: float, angle: float) -> NDArray[np.float64]:
    """Of determinant 1, `ratio` times as large along `angle` [rad] from x as across, shape (3,)."""
    along, across = ratio**0.5, ratio**-0.5
    mean, half, turned = (along + across) / 2, (along - across) / 2, 2 * angle
    part = half * np.cos(turned)
    return np.array([mean + part, mean - part, half * np.sin(turned)])


def root(G: NDArray[np.float64], determinant: NDArray[np.float64]) -> NDArray[np.float64]:
    """U = sqrt(G) of that determinant: (G + det U) / sqrt(tr G + 2 det U), by Cayley-Hamilton."""
    xx, yy, xy = G
    scale = 1 / np.sqrt(xx + yy + 2 * determinant)
    return scale * np.stack([xx + determinant, yy + determinant, xy])


def adjugate(U: NDArray[np.float64]) -> NDArray[np.float64]:
    """det(U) times the inverse of U."""
    xx, yy, xy = U
    return np.stack([yy, xx, -xy])


def between(B: NDArray[np.float64], A: NDArray[np.float64]) -> NDArray[np.float64]:
    """B A B."""
    (bx, by, b), (ax, ay, a) = B, A
    return np.stack(
        [
            bx * bx * ax + 2 * bx * b * a + b * b * ay,
            b * b * ax + 2 * b * by * a + by * by * ay,
            bx * b * ax + (bx * by + b * b) * a + b * by * ay,
        ]
    )
