"""Edges of a flat mesh turned within pairs of triangles where that makes the angles better.

An edge whose opposite angles add up to more than half a turn is replaced by the other diagonal:
C. L. Lawson, in Mathematical Software III (1977) 161-194. What is left is as near to a Delaunay
triangulation as the kept edges allow.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simulator.domain.region import Numbers, Points
from simulator.domain.triangles import edge_numbers, edges_of
from simulator.planar import distance

LEAST = 1e-9
"""Sine of what angles exceed half a turn by, for an edge to be turned."""
ROUNDS = 200


def flipped(p: Points, t: Numbers, part: Numbers, segments: Points, same: float) -> Numbers:
    """Triangles in place of t, shape (3, triangle), each within the same part as that it replaces.

    p: m, shape (2, point). part: shape (triangle,). Edges along segments, to within `same` [m], and
    between parts are kept.
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
        turn = (excess > LEAST) & (chosen[first] == number) & (chosen[second] == number)
        if not turn.any():
            break
        t = _turned(t, edges[:, turn], first[turn], second[turn])
    return t


def edges_along(p: Points, t: Numbers, segments: Points, same: float) -> Numbers:
    """The edges that lie along a segment, by numbers of points, shape (2, edge)."""
    edges, _ = edges_of(t)
    on = distance(p.T, segments) <= 2 * same
    return edges[:, (on[edges[0]] & on[edges[1]]).any(axis=1)]


def _sides(of_triangle: Numbers) -> tuple[Numbers, Numbers]:
    """The triangles at both sides of each edge; one twice at the boundary."""
    flat, triangle = of_triangle.ravel(), np.tile(np.arange(of_triangle.shape[1]), 3)
    order = np.argsort(flat, kind="stable")
    _, start, count = np.unique(flat[order], return_index=True, return_counts=True)
    return triangle[order[start]], triangle[order[start + count - 1]]


def _excess(p: Points, t: Numbers, of_triangle: Numbers) -> NDArray[np.float64]:
    """Minus the sine of the sum of the angles opposite each edge, shape (edge,)."""
    sine, cosine = _opposite(p, t)
    edge, count = of_triangle.ravel(), int(of_triangle.max()) + 1
    turn = np.ones(count, dtype=complex)
    np.multiply.at(turn, edge, (cosine + 1j * sine).ravel())
    return -np.imag(turn)


def _opposite(p: Points, t: Numbers) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Sine and cosine of the angles opposite the edges 0-1, 1-2 and 2-0, shape (3, triangle)."""
    corner = p[:, t[[2, 0, 1]]]
    u, v = p[:, t] - corner, p[:, t[[1, 2, 0]]] - corner
    size = np.linalg.norm(u, axis=0) * np.linalg.norm(v, axis=0)
    return np.abs(u[0] * v[1] - u[1] * v[0]) / size, (u * v).sum(axis=0) / size


def _turned(t: Numbers, edges: Numbers, first: Numbers, second: Numbers) -> Numbers:
    """The triangles with those edges replaced by the other diagonals."""
    ends = edges.sum(axis=0)
    beyond = [t[:, triangle].sum(axis=0) - ends for triangle in (first, second)]
    t = t.copy()
    t[:, first] = np.sort([edges[0], *beyond], axis=0)
    t[:, second] = np.sort([edges[1], *beyond], axis=0)
    return t
