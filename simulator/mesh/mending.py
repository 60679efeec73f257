"""Triangles of a file made to conform and to be well shaped.

Points move onto lines, and edges are cut there. Then edges of triangles that are too flat are
turned, and short ones collapsed.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..arrays import Integer, Mask, Real
from ..scene.planar import distance, nearest
from .arcs import edge_numbers, edges_of, halves, rim_points
from .domain import Domain, Points, areas


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


POOR = 0.2
"""Shape below which a triangle is repaired; an equilateral triangle has 1."""

GAIN = 1.2
"""Smallest factor by which the worst triangle around a point must improve."""


def collapsed(mesh: Domain, movable: Mask, lines: Integer) -> Domain:
    """Mesh without those `movable` points, shape (point,), that make slivers.

    lines: edges along segments by numbers of points, shape (2, edge). Points keep their places and
    numbers; `compressed` drops the unused ones.
    """
    movable = movable.copy()
    while True:
        chosen = _chosen(mesh, _targets(mesh, movable, lines))
        moved = np.flatnonzero(chosen != np.arange(len(chosen)))
        if not len(moved):
            return mesh
        t, lines = np.sort(chosen[mesh.t], axis=0), np.sort(chosen[lines], axis=0)
        kept = (np.diff(t, axis=0) > 0).all(axis=0)
        lines = np.unique(lines[:, lines[0] < lines[1]], axis=1)
        movable[moved] = False
        covered = mesh.covered[:, kept]
        mesh = replace(mesh, t=t[:, kept], pixel=mesh.pixel[kept], covered=covered)


def compressed(mesh: Domain) -> Domain:
    """Mesh without points that belong to no triangle."""
    used, t = np.unique(mesh.t, return_inverse=True)
    foils = {name: np.searchsorted(used, facets) for name, facets in mesh.foils.items()}
    return replace(mesh, p=mesh.p[:, used], t=t.reshape(3, -1), foils=foils)


def _targets(mesh: Domain, movable: Mask, lines: Integer) -> Integer:
    """Neighbour that each movable point may be moved into, itself for others."""
    on = np.bincount(lines.ravel(), minlength=len(movable))
    edges = edges_of(mesh.t)[0]
    within, free = (np.hstack([each, each[::-1]]) for each in (lines, edges))
    within = within[:, movable[within[0]] & (on[within[0]] == 2)]
    free = free[:, movable[free[0]] & (on[free[0]] == 0)]
    both = np.hstack([within, free])
    length = np.linalg.norm(mesh.p[:, both[0]] - mesh.p[:, both[1]], axis=0)
    far_first = np.argsort(-length, kind="stable")
    target = np.arange(len(movable))
    target[both[0, far_first]] = both[1, far_first]
    return target


def _chosen(mesh: Domain, target: Integer) -> Integer:
    """Target of each point that moves.

    Points with the worst triangles have priority, and no two that move share a triangle.
    """
    p, t = mesh.p, mesh.t
    shape = _shape(p[:, t])
    before, after = np.full((2, len(target)), np.inf)
    np.minimum.at(before, t.ravel(), np.tile(np.abs(shape), 3))
    for corner in range(3):
        moved = t.copy()
        moved[corner] = target[t[corner]]
        new = _shape(p[:, moved]) * np.sign(shape)
        gone = (np.diff(np.sort(moved, axis=0), axis=0) == 0).any(axis=0)
        np.minimum.at(after, t[corner], np.where(gone, np.inf, new))
    gains = (target != np.arange(len(target))) & (before < POOR) & (after > GAIN * before)
    rank = np.full(len(target), len(target))
    candidates = np.flatnonzero(gains)
    rank[candidates[np.argsort(before[candidates], kind="stable")]] = np.arange(len(candidates))
    first = rank[t].min(axis=0)
    beaten = np.zeros(len(target), dtype=bool)
    np.logical_or.at(beaten, t.ravel(), (rank[t] > first).ravel())
    return np.where(gains & ~beaten, target, np.arange(len(target)))


def _shape(corners: Points) -> Real:
    """Signed area over that of an equilateral triangle of equal mean square sides."""
    a, b, c = corners.swapaxes(0, 1)
    u, v, w = b - a, c - b, a - c
    squares = (u**2 + v**2 + w**2).sum(axis=0)
    return 2 * np.sqrt(3) * (u[0] * v[1] - u[1] * v[0]) / squares


MIN_EXCESS = 1e-9
"""Smallest sine of the excess over 180 degrees of angles opposite a turned edge."""

ROUNDS = 200


def flipped(p: Points, t: Integer, part: Integer, segments: Points, same: float) -> Integer:
    """Triangles after edges were turned, shape (3, triangle).

    Each lies within the same part as the triangle that it replaces. p: m, shape (2, point). part:
    that of each triangle, shape (triangle,). Edges between parts, and along segments to within
    `same` [m], are kept.
    """
    lines = edges_along(p, t, segments, same)
    for _ in range(ROUNDS):
        edges, of_triangle = edges_of(t)
        first, second = _sides(of_triangle)
        excess = np.where(first == second, -1.0, _excess(p, t, of_triangle))
        excess[part[first] != part[second]] = -1.0
        excess[edge_numbers(lines, edges)] = -1.0
        best = np.argmax(excess[of_triangle], axis=0)
        chosen = of_triangle[best, np.arange(t.shape[1])]
        number = np.arange(len(first))
        turn = (excess > MIN_EXCESS) & (chosen[first] == number) & (chosen[second] == number)
        if not turn.any():
            break
        t = _turned(t, edges[:, turn], first[turn], second[turn])
    return t


def edges_along(p: Points, t: Integer, segments: Points, same: float) -> Integer:
    """Edges that lie along a segment, by numbers of points, shape (2, edge)."""
    edges, _ = edges_of(t)
    on = distance(p.T, segments) <= 2 * same
    return edges[:, (on[edges[0]] & on[edges[1]]).any(axis=1)]


def _sides(of_triangle: Integer) -> tuple[Integer, Integer]:
    """Triangles on both sides of each edge; at the boundary the same one twice."""
    flat, triangle = of_triangle.ravel(), np.tile(np.arange(of_triangle.shape[1]), 3)
    order = np.argsort(flat, kind="stable")
    _, start, count = np.unique(flat[order], return_index=True, return_counts=True)
    return triangle[order[start]], triangle[order[start + count - 1]]


def _excess(p: Points, t: Integer, of_triangle: Integer) -> Real:
    """Minus the sine of the sum of the angles opposite each edge, shape (edge,)."""
    sine, cosine = _opposite(p, t)
    edge, count = of_triangle.ravel(), int(of_triangle.max()) + 1
    turn = np.ones(count, dtype=complex)
    np.multiply.at(turn, edge, (cosine + 1j * sine).ravel())
    return -np.imag(turn)


def _opposite(p: Points, t: Integer) -> tuple[Real, Real]:
    """Sine and cosine of the angles opposite the edges 0-1, 1-2 and 2-0.

    Shape (3, triangle).
    """
    corner = p[:, t[[2, 0, 1]]]
    u, v = p[:, t] - corner, p[:, t[[1, 2, 0]]] - corner
    size = np.linalg.norm(u, axis=0) * np.linalg.norm(v, axis=0)
    return np.abs(u[0] * v[1] - u[1] * v[0]) / size, (u * v).sum(axis=0) / size


def _turned(t: Integer, edges: Integer, first: Integer, second: Integer) -> Integer:
    """Triangles with those edges replaced by the other diagonals."""
    ends = edges.sum(axis=0)
    beyond = [t[:, triangle].sum(axis=0) - ends for triangle in (first, second)]
    t = t.copy()
    t[:, first] = np.sort([edges[0], *beyond], axis=0)
    t[:, second] = np.sort([edges[1], *beyond], axis=0)
    return t
