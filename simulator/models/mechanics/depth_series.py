"""One applicator's press at all depths: the membrane on one mesh at Chebyshev's depths."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...chebyshev import barycentric, extrema
from ...press.press import Press
from ...press.touch import Depth, Indentation, Touch
from ...scene.foam_mechanics import Elastic, Mechanics
from ...scene.scene import Scene
from ...sweeps import ToleranceError
from .adaptive import adaptive_deflection, unsure
from .contact import ApplicatorLoads, equilibrium
from .contact_mesh import straight_contact_mesh
from .deflection_cache import NEAREST, lagrange
from .membrane import ELEMENT, MembraneSurface

COUNTS = (9, 13, 17, 33)
HELD, STEP = 1e-9, 1e-4
SMALLEST = 1e-15
"""Smallest depth, m."""
CHECKS = 4
"""Number of intermediate depths at which interpolation is compared with the membrane itself."""
INTERPOLATION_SAFETY = 2.0
"""Assumed error of interpolation over the largest observed at those."""


@dataclass(frozen=True)
class DepthSeries:
    """Deflections under one pixel's applicator by its depth.

    p: (2, point) m, nodes: (node of the element, triangle), as of `MembraneSurface`. depth:
    Chebyshev's extrema from 0 to the deepest, m, shape (depth,), then those between at which
    interpolation is checked. count: number of the former. w: m, shape (depth, node). unsure:
    possible error of w, m, shape (depth, triangle). force: N, shape (depth,).
    """

    p: NDArray[np.float64]
    nodes: NDArray[np.int64]
    depth: NDArray[np.float64]
    count: int
    w: NDArray[np.float64]
    unsure: NDArray[np.float64]
    force: NDArray[np.float64]

    @property
    def deepest(self) -> float:
        """Largest depth, m."""
        return float(self.depth[self.count - 1])

    def weights(self, depth: NDArray[np.float64]) -> NDArray[np.float64]:
        """Interpolation weights of Chebyshev's depths at other depths, m, shape (..., count)."""
        return barycentric(self.depth[: self.count], depth)

    def depth_under(self, force: float, elastic: Elastic, thickness: float) -> tuple[float, float]:
        """Depth in m under a force in N, and its possible error, m; inf beyond the deepest.

        Force over the foam's stress is interpolated; its error is measured at the depths between.
        """

        def stress(depth: NDArray[np.float64] | float) -> NDArray[np.float64]:
            return elastic.stress(np.maximum(depth, SMALLEST) / thickness)

        from scipy.optimize import brentq

        nodes, between = np.split(self.depth, [self.count])
        area = self.force / stress(self.depth)
        near = np.argsort(self.depth[1:])[:NEAREST] + 1
        area[0] = lagrange(self.depth[near], 0.0) @ area[near]
        own, seen = np.split(area, [self.count])
        off = INTERPOLATION_SAFETY * np.abs(barycentric(nodes, between) @ own / seen - 1).max()
        if force > self.force[self.count - 1]:
            return np.inf, np.inf

        def excess(depth: float) -> float:
            return float(stress(depth) * (barycentric(nodes, np.array(depth)) @ own)) - force

        depth = float(brentq(excess, 0.0, nodes[-1], xtol=SMALLEST))  # pyright: ignore[reportArgumentType]
        step = STEP * nodes[-1]
        low, high = max(depth - step, 0.0), min(depth + step, nodes[-1])
        slope = (excess(high) - excess(low)) / (high - low)
        return depth, off * force / slope

    def reach(self, far: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Least and largest x and y of places within a distance of the applicator, m."""
        under = self.p[:, self.w[self.count - 1] >= self.deepest * (1 - HELD)]
        return under.min(axis=1) - far, under.max(axis=1) + far

    def deflection(self, depth: float, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """At flat positions x (2, point) in m, m, shape (point,)."""
        w = self.weights(np.array(depth)) @ self.w[: self.count]
        return np.clip(MembraneSurface(ELEMENT, self.p, self.nodes, w)(x), 0.0, depth)

    def factors(
        self, x: NDArray[np.float64], mechanics: Mechanics, thickness: float
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Capacitance over that at rest less 1 at flat positions x (2, point) in m, at all depths,
        and the same where the deflection is larger by what it may be off; shape (depth, point)."""
        triangle, shares = MembraneSurface(ELEMENT, self.p, self.nodes, self.w[0]).located(x)
        w = np.zeros((len(self.depth), len(triangle)))
        for share, node in zip(shares, self.nodes, strict=True):
            w += share * self.w[:, node[triangle]]
        most = self.depth[:, None]
        known, raised = (
            mechanics.factor(np.clip(each, 0.0, most) / thickness) - 1
            for each in (w, w + self.unsure[:, triangle])
        )
        return known, raised


def depth_series(
    scene: Scene, pixel: Touch, deepest: float, factor_rtol: float, rtol: float
) -> DepthSeries:
    """Of a pixel, down to `deepest` in m.

    factor_rtol: of the factor anywhere, for the mesh. rtol: of the factor between depths. Raises
    InputError as `indentation.pressed`, ToleranceError where a tolerance is out of reach.
    """
    mechanics, thickness = scene.skin.foam.mechanics, scene.skin.foam.thickness
    assert mechanics is not None and thickness is not None
    press = Press((Indentation(pixel, Depth(deepest)),))
    ground = straight_contact_mesh(scene, [pixel], 0)
    first = adaptive_deflection(press, ground, mechanics, thickness, factor_rtol)
    known = {deepest: (first.rest.w, float(first.rest.force[0]))}
    known[0.0] = np.zeros_like(first.rest.w), 0.0

    def at(depth: float) -> tuple[NDArray[np.float64], float]:
        if depth not in known:
            near = sorted(known, key=lambda d: abs(d - depth))[:NEAREST]
            shares = lagrange(np.array(near), depth)
            start = shares @ np.stack([known[d][0] for d in near])
            pushed = ApplicatorLoads(np.array([depth]), np.array([np.nan]))
            rest = equilibrium(first.membrane, first.held, pushed, np.clip(start, 0.0, depth))
            known[depth] = rest.w, float(rest.force[0])
        return known[depth]

    def found(depths: NDArray[np.float64], count: int) -> DepthSeries:
        w, force = zip(*map(at, depths.tolist()), strict=True)
        doubts = np.stack([unsure(first.membrane, each) for each in w])
        surface = first.surface
        p = first.membrane.places
        return DepthSeries(p, surface.nodes, depths, count, np.stack(w), doubts, np.array(force))

    for count in COUNTS:
        nodes, between = _depths(deepest, count)
        candidate = found(np.concatenate([nodes[::-1], between])[_order(count)], count)
        if interpolated_error(candidate, mechanics, thickness) <= rtol:
            return candidate
    raise ToleranceError(f"the factor of pixel {pixel.where} does not interpolate to {rtol:.1e}")


def _depths(deepest: float, count: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Chebyshev's extrema from 0 to deepest, and CHECKS of those between."""
    angle = np.pi * np.arange(count) / (count - 1)
    nodes = extrema(0.0, deepest, count)
    some = np.linspace(0, count - 2, CHECKS).round().astype(np.int64)
    between = angle[some] + np.pi / (count - 1) / 2
    return nodes, deepest * (1 - np.cos(between)) / 2


def _order(count: int) -> NDArray[np.int64]:
    """Of the deepest first to ascending, those between after them."""
    return np.concatenate([np.arange(count)[::-1], count + np.arange(CHECKS)])


def interpolated_error(series: DepthSeries, mechanics: Mechanics, thickness: float) -> float:
    """Largest relative error of the factor at the nodes of the mesh, by depths between."""
    factor = mechanics.factor(np.clip(series.w, 0, None) / thickness)
    nodes, between = factor[: series.count], factor[series.count :]
    told = series.weights(series.depth[series.count :]) @ nodes
    return INTERPOLATION_SAFETY * float(np.abs(told / between - 1).max())


def spread(scene: Scene) -> float:
    """The length over which a deflection falls off beside an applicator, m."""
    mechanics, thickness = scene.skin.foam.mechanics, scene.skin.foam.thickness
    assert mechanics is not None and thickness is not None
    return math.sqrt(mechanics.tension * thickness / mechanics.young)
