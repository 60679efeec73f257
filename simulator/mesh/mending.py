"""Repairs triangles that are too flat: turns edges and collapses short ones."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..arrays import Integer, Mask, Real
from ..scene.planar import distance
from .domain import Domain, Points
from .edge_numbering import edge_numbers, edges_of

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
