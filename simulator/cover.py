"""How much of each cell of a grid a rectangle or a disc covers."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def shared(spans: NDArray[np.float64], cells: NDArray[np.float64]) -> NDArray[np.float64]:
    """Fraction of each interval of `cells` within each interval of `spans`, shape (span, cell).

    spans, cells: ascending lines, m.
    """
    start = np.maximum(spans[:-1, None], cells[:-1])
    stop = np.minimum(spans[1:, None], cells[1:])
    return np.maximum(stop - start, 0.0) / np.diff(cells)


def disc_fraction(
    x: float, y: float, radius: float, columns: NDArray[np.float64], rows: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Fraction of each cell within the disc around (x, y), shape (row, column); all in m.

    columns, rows: ascending lines. Exact but for rounding of 1e-16 radius² in each area.
    """
    u, v = (columns - x) / radius, (rows - y) / radius
    areas = np.diff(np.diff(_area_below(u, v[:, None]), axis=0), axis=1)
    return np.clip(areas / np.multiply.outer(np.diff(v), np.diff(u)), 0.0, 1.0)


def _area_below(u: NDArray[np.float64], v: NDArray[np.float64]) -> NDArray[np.float64]:
    """Area of the unit disc where its coordinates are <= u and <= v.

    It is the integral of w(t) + clip(v, -w, w) over t from -1 to u, w(t) = sqrt(1 - t²).
    """
    u, v = np.clip(u, -1.0, 1.0), np.clip(v, -1.0, 1.0)
    w = np.sqrt(1 - v**2)
    beside = _under_arc(np.minimum(u, -w)) + _under_arc(np.maximum(u, w)) - _under_arc(w)
    return _under_arc(u) + np.sign(v) * beside + v * (np.clip(u, -w, w) + w)


def _under_arc(u: NDArray[np.float64]) -> NDArray[np.float64]:
    """Integral of sqrt(1 - t²) over t from -1 to u."""
    return (u * np.sqrt(1 - u**2) + np.arcsin(u)) / 2 + np.pi / 4
