"""Makes the triangles of a file conform: moves points onto lines and cuts edges."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..arrays import Integer, Mask, Real
from ..scene.planar import nearest
from .domain import Domain, Points, areas
from .edge_numbering import edges_of, halves, rim_points


def cut(mesh: Domain, segments: Points, same: float) -> Domain:
    """Mesh cut so that each segment, seen along z, is a union of edges.

    This holds as far as the segment lies on the mesh. segments: m, shape (segment, end, 2). Points
    nearer to a segment than `same` [m] lie on it. The triangles in which a segment ends are cut
    through. Labels and foils are inherited.
    """
    for segment in segments:
        mesh = _cut_along(mesh, segment, same)
    return mesh


def _cut_along(mesh: Domain, segment: Points, same: float) -> Domain:
    run = segment[1] - segment[0]
    length = np.hypot(*run)
    offset = mesh.p[:2] - segment[0][:, None]
    at = (run @ offset) / length
    off = (run[0] * offset[1] - run[1] * offset[0]) / length
    off[np.abs(off) <= same] = 0.0
    edges, of_triangle = edges_of(mesh.t)
    crossed = off[edges[0]] * off[edges[1]] < 0
    with np.errstate(divide="ignore", invalid="ignore"):
        part = np.where(crossed, off[edges[0]] / (off[edges[0]] - off[edges[1]]), np.nan)
    met = at[edges[0]] + part * (at[edges[1]] - at[edges[0]])
    entered = _entered(np.where(off == 0, at, np.nan)[mesh.t], met[of_triangle], length, same)
    split = np.zeros(len(crossed), dtype=bool)
    split[of_triangle[:, entered]] = True
    split &= crossed
    if not split.any():
        return mesh
    new = np.full(len(split), -1, dtype=np.int64)
    new[split] = mesh.p.shape[1] + np.arange(np.count_nonzero(split))
    start, stop = mesh.p[:, edges[0, split]], mesh.p[:, edges[1, split]]
    p = np.hstack([mesh.p, start + part[split] * (stop - start)])
    t, parent = _split(mesh.t, new[of_triangle])
    foils = {name: halves(lines, edges, new) for name, lines in mesh.foils.items()}
    t, covered = np.sort(t, axis=0), mesh.covered[:, parent]
    return replace(mesh, p=p, t=t, pixel=mesh.pixel[parent], covered=covered, foils=foils)


def _entered(at_corners: Points, at_edges: Points, length: float, same: float) -> Mask:
    """True for each triangle that the segment runs through inside, shape (triangle,).

    at_corners, at_edges: where the segment's line meets them, along it; NaN where it does not.
    """
    at = np.concatenate([at_corners, at_edges])
    first = np.where(np.isnan(at), np.inf, at).min(axis=0)
    last = np.where(np.isnan(at), -np.inf, at).max(axis=0)
    through = np.isfinite(at_edges).any(axis=0)
    return through & (np.minimum(last, length) - np.maximum(first, 0.0) > same)


def _split(t: Integer, new: Integer) -> tuple[Integer, Integer]:
    """Triangles after cuts, shape (3, child), and the number of the parent of each.

    new: points on the edges 0-1, 1-2, 2-0, at most two of them; -1 where there is none.
    """
    turn = _apex(new >= 0)
    turned = (np.arange(3)[:, None] + turn) % 3
    (a, b, c), (ab, bc, ca) = (np.take_along_axis(each, turned, axis=0) for each in (t, new))
    first, third = ab >= 0, ca >= 0
    cases = [
        (~first, [(a, b, c)]),
        (first & ~third, [(a, ab, c), (ab, b, c)]),
        (first & third, [(a, ab, ca), (ab, b, c), (ab, c, ca)]),
    ]
    children = [np.stack(child)[:, case] for case, parts in cases for child in parts]
    parents = [np.flatnonzero(case) for case, parts in cases for _ in parts]
    return np.concatenate(children, axis=1), np.concatenate(parents)


def _apex(there: Mask) -> Integer:
    """Corners to turn triangles by for edge 0-1 to be cut, and 2-0 where two are."""
    one = there & ~np.roll(there, -1, axis=0)
    return one.argmax(axis=0) * one.any(axis=0)


REACH = 0.35
"""Largest distance a point is moved, over the smallest height of its triangles.

No triangle turns over.
"""


def snapped(p: Points, t: Integer, fixed: Integer, corners: Points, segments: Points) -> Points:
    """Points of a plane mesh, shape (2, point), some moved to corners and segments.

    Those within reach move, the nearest to each corner first. fixed: points that stay, in addition
    to those of the boundary. corners: shape (corner, 2). segments: shape (segment, end, 2); they
    meet at corners only.
    """
    p, reach = p.copy(), _reach(p, t)
    reach[rim_points(t)] = 0.0
    reach[fixed] = 0.0
    for number, place in _nearest(p, reach, corners):
        p[:, number], reach[number] = corners[place], 0.0
    free = np.flatnonzero(reach)
    along, away = nearest(p[:, free].T, segments)
    segment = away.argmin(axis=1)
    near = np.flatnonzero(away[np.arange(len(free)), segment] < reach[free])
    free, segment = free[near], segment[near]
    at = along[near, segment][:, None]
    segment = segments[segment]
    p[:, free] = ((1 - at) * segment[:, 0] + at * segment[:, 1]).T
    return p


def _reach(p: Points, t: Integer) -> Real:
    """Largest distance that each point may be moved, m, shape (point,)."""
    a, b, c = (p[:, corner] for corner in t)
    longest = np.linalg.norm([a - b, b - c, c - a], axis=1).max(axis=0)
    reach = np.full(p.shape[1], np.inf)
    np.minimum.at(reach, t.ravel(), np.tile(REACH * 2 * areas(p, t) / longest, 3))
    return reach


def _nearest(p: Points, reach: Real, places: Points) -> list[tuple[int, int]]:
    """Pairs of a point and the nearest place within its reach, each at most once."""
    from scipy.spatial import KDTree

    away, number = map(np.asarray, KDTree(p.T).query(places))
    found: dict[int, tuple[float, int]] = {}
    for place in np.flatnonzero(away < reach[number]).tolist():
        point = int(number[place])
        found[point] = min(found.get(point, (np.inf, 0)), (float(away[place]), place))
    return [(point, place) for point, (_, place) in found.items()]
