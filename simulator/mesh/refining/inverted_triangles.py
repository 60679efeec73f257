"""Keeps triangles upright however their arcs bend: turns edges, then halves arcs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import Integer, Real
from ...sweeps import ToleranceError
from ..arcs import mapped
from ..domain import Domain
from ..edge_numbering import edge_numbers, edges_of
from .refinement import arcs_halved, refined

STEPS = 6
"""Number of parts of an edge; triangles are checked at the ends of the parts."""
MIN_AREA_RATIO = 1e-3
"""Smallest area of a bent triangle over that of the straight one, but at corners.

Where a circle touches a line, it falls linearly from 1 to 0 at the corner.
"""
ROUNDING = 1e-6
MAX_UNTANGLING_ROUNDS = 10


def finer(mesh: Domain, marked: ArrayLike) -> Domain:
    """Mesh with the marked triangles, by number, cut in four.

    Raises what `without_inversions` raises.
    """
    return without_inversions(refined(mesh, marked))


def without_inversions(mesh: Domain) -> Domain:
    """Mesh in which arcs turn no triangle over, or nearly.

    Raises ToleranceError where triangles would be halved without end.
    """
    if not len(mesh.arcs.curvature):
        return mesh
    for _ in range(MAX_UNTANGLING_ROUNDS):
        if not _inverted(mesh).size:
            return mesh
        mesh = _turned(mesh)
        mesh = arcs_halved(mesh, _inverted(mesh))
    raise ToleranceError("circles of the skin or of the press are too near to other lines to mesh")


def _inverted(mesh: Domain) -> Integer:
    """Triangles that their arcs turn over, and those that lie upon a neighbour."""
    curvature = mesh.curvature
    bent = np.flatnonzero(curvature.any(axis=0))
    turned = bent[_upright(mesh, mesh.t[:, bent], curvature[:, bent]) < MIN_AREA_RATIO]
    return np.union1d(turned, _folded(mesh))


def _folded(mesh: Domain) -> Integer:
    """Smaller one of each two triangles on the same side of their common edge."""
    edges, of_triangle = edges_of(mesh.t)
    order = np.argsort(of_triangle.ravel(), kind="stable")
    edge, triangle = of_triangle.ravel()[order], np.tile(np.arange(mesh.t.shape[1]), 3)[order]
    first = np.flatnonzero(edge[:-1] == edge[1:])
    pair, (start, stop) = triangle[[first, first + 1]], edges[:, edge[first]]
    apex = mesh.t[:, pair].sum(axis=0) - start - stop
    run = mesh.p[:, stop] - mesh.p[:, start]
    side = _cross(run[:, None], mesh.p[:, apex] - mesh.p[:, start][:, None])
    same = np.flatnonzero(side[0] * side[1] > 0)
    return np.unique(pair[np.abs(side[:, same]).argmin(axis=0), same])


def _upright(mesh: Domain, t: Integer, curvature: Real) -> Real:
    """Smallest area ratio of a bent and the straight triangle, shape (triangle,).

    t: of ascending points. At corners, where the ratio may be 0, MIN_AREA_RATIO is added. It is -1
    for a straight triangle without area.
    """
    a, b = (each.ravel() / STEPS for each in np.meshgrid(*2 * [np.arange(STEPS + 1.0)]))
    within = a + b < 1 + ROUNDING
    a, b = a[within], b[within]
    cornered = np.maximum(np.maximum(a, b), 1 - a - b) > 1 - ROUNDING
    _, along, across = mapped(mesh.p, t, curvature, np.stack([a, b]))
    straight = _area(mesh, t)[:, None]
    flat = np.full((t.shape[1], len(a)), -1.0)
    part = np.divide(_cross(along, across), straight, out=flat, where=straight != 0)
    return (part + (MIN_AREA_RATIO + ROUNDING) * cornered).min(axis=1)


def _turned(mesh: Domain) -> Domain:
    """Mesh with edges of tangled triangles turned within pairs if both improve."""
    for triangle in _inverted(mesh).tolist():
        edges, of_triangle = edges_of(mesh.t)
        fixed = np.zeros(edges.shape[1], dtype=bool)
        fixed[edge_numbers(mesh.seams, edges)] = True
        best, chosen = 0.0, mesh
        for number in of_triangle[:, triangle][~fixed[of_triangle[:, triangle]]]:
            pair = np.flatnonzero((of_triangle == number).any(axis=0))
            beyond = np.sort(mesh.t[:, pair].sum(axis=0) - edges[:, number].sum())
            if edge_numbers(beyond[:, None], edges)[0] >= 0:
                continue
            found = _with_diagonal(mesh, pair, edges[:, number], beyond)
            gain = _gain(mesh, found, pair)
            if gain > best:
                best, chosen = gain, found
        mesh = chosen
    return mesh


def _gain(mesh: Domain, other: Domain, pair: Integer) -> float:
    """Improvement of the worst of a pair of triangles in another mesh.

    Infinite if they no longer lie upon each other, minus infinity if they then do or one is flat.
    """
    before, after = (np.abs(_area(each, each.t[:, pair])) for each in (mesh, other))
    if after.sum() > before.sum() * (1 + ROUNDING) or after.min() < ROUNDING * before.max():
        return -np.inf
    if after.sum() < before.sum() * (1 - ROUNDING):
        return np.inf
    worst = [_upright(m, m.t[:, pair], m.curvature[:, pair]).min() for m in (other, mesh)]
    return float(worst[0] - worst[1])


def _with_diagonal(mesh: Domain, pair: Integer, edge: Integer, beyond: Integer) -> Domain:
    """Mesh with the edge between `beyond` in place of the edge between two triangles."""
    t = mesh.t.copy()
    t[:, pair] = np.sort([edge, np.full(2, beyond[0]), np.full(2, beyond[1])], axis=0)
    return replace(mesh, t=t)


def _area(mesh: Domain, t: Integer) -> Real:
    """Twice the area of straight triangles, negative where they run clockwise, m²."""
    origin, first, second = (mesh.p[:, each] for each in t)
    return _cross(first - origin, second - origin)


def _cross(u: Real, v: Real) -> Real:
    return u[0] * v[1] - u[1] * v[0]
