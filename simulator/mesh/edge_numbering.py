"""Edges and facets of triangles by numbers of points, and their halves if cut."""

from __future__ import annotations

import numpy as np

from ..arrays import Integer


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
