"""Rise of c under and next to one applicator at the points of a mesh, by modes over depth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ....arrays import Integer, Mask, Real
from ....chebyshev import barycentric
from ....mesh.domain import Domain
from ...heterogeneous.elements import Elements
from ...mechanics.depth_series import INTERPOLATION_SAFETY
from .applicators import PixelApplicators

DROPPED = 1e-8
"""Modes with less than this share of the largest singular value over depths are left out."""
MIN_RISE = 0.1
"""Smallest rise of the factor that the error by omitted modes and depths is relative to."""
LEBESGUE = 3.0
"""Bound on the amplification of omitted modes by interpolation at up to 33 Chebyshev depths."""


@dataclass(frozen=True)
class RiseField:
    """Rise of c over the unpressed c: sum of modes, with coefficients that depend on depth.

    cells: cells that are affected, shape (cell,). modes: shape (mode, cell, point). depth:
    Chebyshev's depths, m, shape (depth,). coefficients: of the modes at those depths, shape (depth,
    mode). uncertainty: that of the rise, over the rise under the applicator or over MIN_RISE,
    whichever is larger, shape (cell, point).
    """

    cells: Integer
    modes: Real
    depth: Real
    coefficients: Real
    uncertainty: Real

    def at(self, depth: Real | float) -> Real:
        """Coefficients of the modes at depths in m, shape (..., mode)."""
        return barycentric(self.depth, np.asarray(depth)) @ self.coefficients


def field_of(known: PixelApplicators, pixel: int, elements: Elements, domain: Domain) -> RiseField:
    """Field of a pixel with skin, at the points of the elements' rule."""
    series, cells = known.depth_series_of(pixel), near(domain, domain.pixel == pixel, known.far)
    surface = elements.surface.some(cells)
    shape = surface.x.shape[1:]
    rise, raised = known.rises(pixel, surface.x.reshape(2, -1))
    nodes, between = rise[: series.count], rise[series.count :]
    weights = (surface.area * elements.rule.weights).ravel()
    power, turn = np.linalg.eigh((nodes * weights) @ nodes.T)
    kept = power > DROPPED**2 * power[-1]
    turn = turn[:, kept][:, ::-1]
    modes = turn.T @ nodes
    left_out = LEBESGUE * np.abs(nodes - turn @ modes).max(axis=0)
    interpolated = series.weights(series.depth[series.count :]) @ nodes
    left_out += INTERPOLATION_SAFETY * np.abs(interpolated - between).max(axis=0)
    under = known.mechanics.factor(series.depth / known.thickness) - 1
    pushed = under > 0
    shares = ((raised - rise)[pushed] / under[pushed, None]).max(axis=0)
    return RiseField(
        cells,
        modes.reshape(-1, *shape),
        series.depth[: series.count],
        turn,
        (shares + left_out / MIN_RISE).reshape(shape),
    )


def near(domain: Domain, own: Mask, far: float) -> Integer:
    """Cells within a distance of the bounding box of some cells, m."""
    corners = domain.p[:2][:, domain.t]
    low, high = corners.min(axis=1), corners.max(axis=1)
    first, last = low[:, own].min(axis=1) - far, high[:, own].max(axis=1) + far
    there = (high >= first[:, None]).all(axis=0) & (low <= last[:, None]).all(axis=0)
    return np.flatnonzero(there)
