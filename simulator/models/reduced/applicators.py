"""Every pixel of a skin as an applicator: deflections and rises of c by its depth.

The membrane is solved on one mesh at Chebyshev's depths. On a rectangle, pixels in equivalent
positions relative to its edges share one depth series. At the points of another mesh the rise of c
is a sum of few modes, with coefficients that depend on the depth.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...arrays import Integer, Mask, Real
from ...chebyshev import barycentric, extrema
from ...mesh.domain import Domain
from ...press.pixels import pixels_with_skin
from ...press.press import Press
from ...press.touch import Depth, Indentation, Touch
from ...scene.foam_mechanics import Elastic, Mechanics
from ...scene.parts import Skin
from ...sweeps import ToleranceError
from ..heterogeneous.elements import Elements
from ..mechanics.adaptive import NEAREST, adaptive_deflection, deflection_uncertainty, lagrange
from ..mechanics.contact import ApplicatorLoads, equilibrium
from ..mechanics.contact_mesh import straight_contact_mesh
from ..mechanics.membrane import ELEMENT, MembraneSurface
from .touches import deepest

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


FACTOR_SHARE, COARSEST = 30.0, 1e-2
"""Largest error of a factor over the tolerance of Rs and Cp, and its maximum. It occurs only at
corners."""
DEPTH_SHARE = 0.1
"""Interpolation between depths may leave this share of the tolerance as error of the factor."""
NEGLIGIBLE = 0.1
"""Deflections count as 0 below this share of the tolerance times the applicator's deflection."""


@dataclass(frozen=True)
class PixelApplicators:
    """Deflections by all pixels of a scene as applicators.

    of_pixel: number of each pixel's depth series, -1 without skin, shape (pixel,). turn, shift: a
    position x on the skin is x turn + shift in the depth series' own coordinates, shape (pixel, 2).
    far: distance beyond which an applicator has no effect, m.
    """

    skin: Skin
    all_series: tuple[DepthSeries, ...]
    of_pixel: Integer
    turn: Real
    shift: Real
    far: float

    @property
    def mechanics(self) -> Mechanics:
        """Mechanics of the foam."""
        assert self.skin.foam.mechanics is not None
        return self.skin.foam.mechanics

    @property
    def thickness(self) -> float:
        """Thickness of the foam, m."""
        assert self.skin.foam.thickness is not None
        return self.skin.foam.thickness

    @cached_property
    def deepest(self) -> float:
        """Largest depth, m."""
        return deepest(self.skin)

    @property
    def pressable(self) -> Integer:
        """Pixels with skin."""
        return np.flatnonzero(self.of_pixel >= 0)

    def depth(self, rises: Real) -> Real:
        """Depth in m at which the factor under an applicator is 1 + rises."""
        strain = self.mechanics.strain_at(1 + np.asarray(rises, dtype=np.float64))
        return np.minimum(strain * self.thickness, self.deepest)

    def depth_series_of(self, pixel: int) -> DepthSeries:
        """Depth series of a pixel with skin."""
        return self.all_series[self.of_pixel[pixel]]

    def rises(self, pixel: int, x: Real) -> tuple[Real, Real]:
        """`DepthSeries.factors` of one pixel, at positions x (2, point) on the skin in m."""
        own = self.turn[pixel][:, None] * x + self.shift[pixel][:, None]
        return self.depth_series_of(pixel).factors(own, self.mechanics, self.thickness)

    def deflection(self, pixel: int, depth: float, x: Real) -> Real:
        """Deflection by one applicator at a depth in m, at positions x (2, point) on the skin,
        m."""
        own, series = (
            self.turn[pixel][:, None] * x + self.shift[pixel][:, None],
            self.depth_series_of(pixel),
        )
        found = np.zeros(x.shape[1])
        low, high = series.reach(self.far)
        there = ((own >= low[:, None]) & (own <= high[:, None])).all(axis=0)
        found[there] = series.deflection(depth, own[:, there])
        return found


def applicators(skin: Skin, rtol: float) -> PixelApplicators:
    """Applicators on all pixels; the scene's foam has mechanics and its skins have tension.

    rtol: tolerance of Rs and Cp. Raises what `depth_series` raises.
    """
    rows, columns = skin.pixels.shape
    count, lengths = rows * columns, np.array(skin.sides)
    of_pixel, turn, shift = np.full(count, -1), np.ones((count, 2)), np.zeros((count, 2))
    known: dict[tuple[int, int], int] = {}
    assert skin.foam.mechanics is not None and skin.foam.thickness is not None
    spread = skin.foam.mechanics.spread(skin.foam.thickness)
    far = spread * math.log(1 / (NEGLIGIBLE * rtol))
    for row, column in pixels_with_skin(skin):
        pixel, place = (row - 1) * columns + column - 1, (column - 1, row - 1)
        equivalent = place
        if skin.rectangular:
            pitch = lengths / (columns, rows)
            equivalent = (
                _equivalent_index(place[0], columns, pitch[0], far),
                _equivalent_index(place[1], rows, pitch[1], far),
            )
            flipped = [k > n - 1 - k for k, n in zip(place, (columns, rows), strict=True)]
            nearest = [min(k, n - 1 - k) for k, n in zip(place, (columns, rows), strict=True)]
            turn[pixel] = np.where(flipped, -1.0, 1.0)
            moved = (np.array(equivalent) - nearest) * pitch
            shift[pixel] = np.where(flipped, lengths, 0.0) + moved
        of_pixel[pixel] = known.setdefault(equivalent, len(known))
    found = [_computed_series(skin, place, rtol) for place in known]
    return PixelApplicators(skin, tuple(found), of_pixel, turn, shift, far)


def _computed_series(skin: Skin, place: Sequence[int], rtol: float) -> DepthSeries:
    column, row = place
    factor_rtol = min(COARSEST, FACTOR_SHARE * rtol)
    pixel = Touch(row + 1, column + 1, 1.0)
    return depth_series(skin, pixel, deepest(skin), factor_rtol, DEPTH_SHARE * rtol)


def _equivalent_index(index: int, count: int, pitch: float, far: float) -> int:
    """Smallest index in an equivalent position relative to both ends of a row.

    far: distance beyond which an end has no effect, m.
    """
    nearest = min(index, count - 1 - index)
    enough = int(np.ceil(far / pitch))
    if count - 1 - nearest < enough:
        return nearest
    return min(nearest, enough)


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
