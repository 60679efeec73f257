"""Edges of triangles that are arcs of circles, and triangles with such edges.

The arc of curvature k over a chord e has the height
(1 - t²) |e|² k / 4 / (sqrt(1 - q² t²) + sqrt(1 - q²)) above it, with t from -1 to 1 along the chord
and q = |e| k / 2. With L_i L_j in place of (1 - t²) / 4 and L_j - L_i in place of t, L the
barycentric coordinates, this maps a whole triangle onto its curved one: exactly onto the arc,
without moving the other edges, and as smoothly as polynomials of any order need it (M. Lenoir, SIAM
Journal on Numerical Analysis 23 (1986) 562: the s-th derivative falls with h^s).

Edges and facets are numbered by points.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..arrays import Integer, Real


def edges_of(t: Integer) -> tuple[Integer, Integer]:
    """Edges of triangles by numbers of points, and the three edges of each triangle.

    Returns the edges, ascending, shape (2, edge), and the numbers of each triangle's edges from
    corner 0 to 1, 1 to 2 and 2 to 0, shape (3, triangle).
    """
    pairs = np.sort([t[[0, 1]], t[[1, 2]], t[[2, 0]]], axis=1)
    low, high = pairs[:, 0].ravel(), pairs[:, 1].ravel()
    base = int(t.max()) + 1
    keys, number = np.unique(low * base + high, return_inverse=True)
    return np.stack([keys // base, keys % base]), number.reshape(3, -1)


def rim_points(t: Integer) -> Integer:
    """Points at edges that belong to just one triangle."""
    edges, of_triangle = edges_of(t)
    return np.unique(edges[:, np.bincount(of_triangle.ravel()) == 1])


def edge_numbers(lines: Integer, edges: Integer) -> Integer:
    """Number of each line among `edges`, -1 if it is no edge, shape (line,)."""
    base = int(max(edges.max(), lines.max(initial=0))) + 1
    keys, requested = edges[0] * base + edges[1], lines[0] * base + lines[1]
    number = np.minimum(np.searchsorted(keys, requested), len(keys) - 1)
    return np.where(keys[number] == requested, number, -1)


def halves(lines: Integer, edges: Integer, new: Integer) -> Integer:
    """Lines along edges; those with a new point on them are divided in two.

    Both ends ascend in each column of the result. new: points on `edges`, -1 where there is none,
    each numbered after all existing points.
    """
    point = new[edge_numbers(lines, edges)]
    cut, whole, point = lines[:, point >= 0], lines[:, point < 0], point[point >= 0]
    return np.concatenate([whole, np.stack([cut[0], point]), np.stack([cut[1], point])], axis=1)


Points = Real
EDGES = ((0, 1), (1, 2), (0, 2))
"""Edges of a triangle of ascending points, each from the lower to the higher one."""


class Arcs(NamedTuple):
    """Arcs between points of a mesh.

    lines: numbers of the ends, ascending in each column, shape (2, arc). curvature: 1/m, shape
    (arc,); positive where the arc lies left of the chord from the lower end on.
    """

    lines: Integer
    curvature: Real

    def of(self, edges: Integer) -> Real:
        """Curvature of edges by numbers of points, (2, edge) to (edge,); 0 if straight.

        All arcs must be among the edges, and the edges in the order of `edges_of`.
        """
        found = np.zeros(edges.shape[1])
        found[edge_numbers(self.lines, edges)] = self.curvature
        return found

    def halved(self, edges: Integer, new: Integer) -> Arcs:
        """Arcs along edges, divided in two by a new point on them; see `halves`."""
        cut = new[edge_numbers(self.lines, edges)] >= 0
        both = self.curvature[cut]
        return Arcs(
            halves(self.lines, edges, new), np.concatenate([self.curvature[~cut], both, -both])
        )


NO_ARCS = Arcs(np.zeros((2, 0), dtype=np.int64), np.zeros(0))


def on_arcs(start: Points, stop: Points, curvature: Real, part: Real | float = 0.5) -> Points:
    """Points of arcs over the chords from start to stop, m, all of shape (2, arc).

    part: fraction of the chord at which they lie, 0 to 1.
    """
    chord, t = stop - start, 2 * np.asarray(part) - 1
    q = np.linalg.norm(chord, axis=0) * curvature / 2
    high = q / 2 * (1 - t**2) / (np.sqrt(1 - (q * t) ** 2) + np.sqrt(1 - q**2))
    return start + part * chord + high * _left_of(chord)


def arc_length(chord: Real, curvature: Real) -> Real:
    """Lengths of the arcs over chords of the given lengths, m."""
    q = chord * np.abs(curvature) / 2
    return chord * np.divide(np.arcsin(q), q, out=np.ones_like(q), where=q > 0)


def areas_beside_chords(p: Points, t: Integer, curvature: Real) -> Real:
    """Areas between chords and arcs, negative where arcs cut into the triangle, m².

    p, t, curvature: as for `mapped`. The result has the shape of curvature.
    """
    found = np.zeros_like(curvature)
    for (i, j), bend, area in zip(EDGES, curvature, found, strict=True):
        bent = np.flatnonzero(bend)
        start, stop, other = (p[:2, t[k, bent]] for k in (i, j, 3 - i - j))
        chord, k = stop - start, bend[bent]
        q = np.linalg.norm(chord, axis=0) * k / 2
        left = np.sign((_left_of(chord) * (other - start)).sum(axis=0))
        area[bent] = -left * (np.arcsin(q) - q * np.sqrt(1 - q**2)) / k**2
    return found


def mapped(p: Points, t: Integer, curvature: Real, points: Points) -> tuple[Points, Points, Points]:
    """Positions x in m in triangles with arcs for edges, and dx/da and dx/db there.

    p: m, shape (2, point). t: ascending in each column, shape (3, cell). curvature: that of the
    EDGES of each cell, 1/m, shape (3, cell). points: (a, b) in the unit triangle, shape (2, place).
    The three results are of shape (2, cell, place).
    """
    origin, along, across = (p[:, each][:, :, None] for each in t)
    along, across = along - origin, across - origin
    a, b = points
    every = np.ones_like(a)
    x, da, db = origin + a * along + b * across, along * every, across * every
    L = np.stack([1 - a - b, a, b])
    slopes = np.array([[-1.0, 1, 0], [-1, 0, 1]])
    for (i, j), bend in zip(EDGES, curvature, strict=True):
        bent = np.flatnonzero(bend)
        if not bent.size:
            continue
        chord = p[:, t[j, bent]] - p[:, t[i, bent]]
        q = (np.linalg.norm(chord, axis=0) * bend[bent] / 2)[:, None]
        aside = 2 * q * _left_of(chord)[:, :, None]
        along_chord, product = L[j] - L[i], L[i] * L[j]
        root = np.sqrt(1 - (q * along_chord) ** 2)
        height = root + np.sqrt(1 - q**2)
        x[:, bent] += aside * product / height
        for moved, (di, dj) in zip((da, db), slopes[:, [i, j]], strict=True):
            falls = q**2 * along_chord * (dj - di) / root
            rises = (di * L[j] + dj * L[i]) / height + product * falls / height**2
            moved[:, bent] += aside * rises
    return x, da, db


def _left_of(chord: Points) -> Points:
    """Chords turned anticlockwise by a right angle."""
    return np.stack([-chord[1], chord[0]])
