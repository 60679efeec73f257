"""One applicator's press at all depths: the membrane on one mesh at Chebyshev's depths."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...arrays import Integer, Real
from ...chebyshev import barycentric, extrema
from ...press.press import Press
from ...press.touch import Depth, Indentation, Touch
from ...scene.foam.foam_mechanics import Elastic, Mechanics
from ...scene.parts import Skin
from ...sweeps import ToleranceError
from .adaptive import NEAREST, adaptive_deflection, deflection_uncertainty, lagrange
from .contact import ApplicatorLoads, equilibrium
from .contact_mesh import straight_contact_mesh
from .membrane import ELEMENT, MembraneSurface

COUNTS = (9, 13, 17, 33)
CLAMPED, STEP = 1e-9, 1e-4
SMALLEST = 1e-15
"""Smallest depth, m."""
CHECKS = 4
"""Number of intermediate depths at which interpolation is compared with the membrane itself."""
INTERPOLATION_SAFETY = 2.0
"""Assumed error of interpolation over the largest observed at these depths."""


@dataclass(frozen=True)
class DepthSeries:
    """Deflections under one pixel's applicator by its depth.

    p, nodes: see `MembraneSurface`. depth: Chebyshev's extrema from 0 to the largest depth, then
    the intermediate depths at which interpolation is checked; m, shape (depth,). count: number of
    the extrema. w: deflection, m, shape (depth, node). uncertainty: possible error of w, m, shape
    (depth, triangle). force: N, shape (depth,).
    """

    p: Real
    nodes: Integer
    depth: Real
    count: int
    w: Real
    uncertainty: Real
    force: Real

    @property
    def deepest(self) -> float:
        """Largest depth, m."""
        return float(self.depth[self.count - 1])

    def weights(self, depth: Real) -> Real:
        """Interpolation weights of Chebyshev's depths at other depths, m, shape (..., count)."""
        return barycentric(self.depth[: self.count], depth)

    def depth_under(self, force: float, elastic: Elastic, thickness: float) -> tuple[float, float]:
        """Depth in m under a force in N, and its possible error, m; inf beyond the deepest.

        Force over the foam's stress is interpolated; its error is measured at the intermediate
        depths.
        """

        def stress(depth: Real | float) -> Real:
            return elastic.stress(np.maximum(depth, SMALLEST) / thickness)

        from scipy.optimize import brentq

        nodes, between = np.split(self.depth, [self.count])
        area = self.force / stress(self.depth)
        near = np.argsort(self.depth[1:])[:NEAREST] + 1
        area[0] = lagrange(self.depth[near], 0.0) @ area[near]
        own, computed = np.split(area, [self.count])
        off = INTERPOLATION_SAFETY * np.abs(barycentric(nodes, between) @ own / computed - 1).max()
        if force > self.force[self.count - 1]:
            return np.inf, np.inf

        def excess(depth: float) -> float:
            return float(stress(depth) * (barycentric(nodes, np.array(depth)) @ own)) - force

        depth = float(brentq(excess, 0.0, nodes[-1], xtol=SMALLEST))  # pyright: ignore[reportArgumentType]
        step = STEP * nodes[-1]
        low, high = max(depth - step, 0.0), min(depth + step, nodes[-1])
        slope = (excess(high) - excess(low)) / (high - low)
        return depth, off * force / slope

    def reach(self, far: float) -> tuple[Real, Real]:
        """Smallest and largest x and y within a distance `far` of the applicator, m."""
        under = self.p[:, self.w[self.count - 1] >= self.deepest * (1 - CLAMPED)]
        return under.min(axis=1) - far, under.max(axis=1) + far

    def deflection(self, depth: float, x: Real) -> Real:
        """Deflection at flat positions x (2, point) in m; m, shape (point,)."""
        w = self.weights(np.array(depth)) @ self.w[: self.count]
        return np.clip(MembraneSurface(ELEMENT, self.p, self.nodes, w)(x), 0.0, depth)

    def factors(self, x: Real, mechanics: Mechanics, thickness: float) -> tuple[Real, Real]:
        """Rise of the capacitance factor at all depths, and its upper estimate.

        Both are for flat positions x (2, point) in m and have the shape (depth, point). The rise is
        the capacitance over the unpressed one, less 1. The upper estimate adds the possible error
        to the deflection.
        """
        triangle, shares = MembraneSurface(ELEMENT, self.p, self.nodes, self.w[0]).located(x)
        w = np.zeros((len(self.depth), len(triangle)))
        for share, node in zip(shares, self.nodes, strict=True):
            w += share * self.w[:, node[triangle]]
        most = self.depth[:, None]
        known, raised = (
            mechanics.factor(np.clip(each, 0.0, most) / thickness) - 1
            for each in (w, w + self.uncertainty[:, triangle])
        )
        return known, raised


def depth_series(
    skin: Skin, pixel: Touch, deepest: float, factor_rtol: float, rtol: float
) -> DepthSeries:
    """Depth series of a pixel's applicator, down to `deepest` in m.

    factor_rtol: tolerance of the factor anywhere, for the mesh. rtol: tolerance of the factor
    between depths. Raises what `adaptive_deflection` raises, and ToleranceError if interpolation
    does not reach rtol.
    """
    mechanics, thickness = skin.foam.mechanics, skin.foam.thickness
    assert mechanics is not None and thickness is not None
    press = Press((Indentation(pixel, Depth(deepest)),))
    contact = straight_contact_mesh(skin, [pixel], 0)
    first, _ = adaptive_deflection(press, contact, mechanics, thickness, factor_rtol)
    membrane = first.membrane
    known = {deepest: (first.solution.w, float(first.solution.force[0]))}
    known[0.0] = np.zeros_like(first.solution.w), 0.0

    def at(depth: float) -> tuple[Real, float]:
        if depth not in known:
            near = sorted(known, key=lambda d: abs(d - depth))[:NEAREST]
            shares = lagrange(np.array(near), depth)
            start = shares @ np.stack([known[d][0] for d in near])
            loads = ApplicatorLoads(np.array([depth]), np.array([np.nan]))
            solution = equilibrium(membrane, first.clamped, loads, np.clip(start, 0.0, depth))
            known[depth] = solution.w, float(solution.force[0])
        return known[depth]

    def found(depths: Real, count: int) -> DepthSeries:
        w, force = zip(*map(at, depths.tolist()), strict=True)
        uncertainty = np.stack([deflection_uncertainty(membrane, each) for each in w])
        given = membrane.places, membrane.nodes, depths, count
        return DepthSeries(*given, np.stack(w), uncertainty, np.array(force))

    for count in COUNTS:
        some = np.linspace(0, count - 2, CHECKS).round()
        between = deepest * (1 - np.cos(np.pi * (some + 0.5) / (count - 1))) / 2
        candidate = found(np.concatenate([extrema(0.0, deepest, count), between]), count)
        if interpolated_error(candidate, mechanics, thickness) <= rtol:
            return candidate
    raise ToleranceError(
        f"pixel {pixel.where}: the factor between depths is not interpolated to {rtol:.1e}"
    )


def interpolated_error(series: DepthSeries, mechanics: Mechanics, thickness: float) -> float:
    """Largest relative error of the factor at the nodes of the mesh at the intermediate depths."""
    factor = mechanics.factor(np.clip(series.w, 0, None) / thickness)
    nodes, between = factor[: series.count], factor[series.count :]
    expected = series.weights(series.depth[series.count :]) @ nodes
    return INTERPOLATION_SAFETY * float(np.abs(expected / between - 1).max())
