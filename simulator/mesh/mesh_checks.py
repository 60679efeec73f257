"""Checks that the triangles of a mesh file can be computed on."""

from __future__ import annotations

import numpy as np

from ..arrays import Integer
from ..sweeps import InputError
from .domain import Points, areas
from .edge_numbering import edges_of

FLAT = 1e-10
"""Area over the square of the longest edge up to which a triangle has no area."""
SAME = 1e-9
"""Distance over the mesh's extent below which points are at one place."""


def check(path: str, p: Points, t: Integer) -> None:
    """Raises InputError unless triangles have areas, meet at edges and are connected."""
    problem = _flat(p, t) or _torn(p, t) or _folded(p, t) or _in_parts(t)
    if problem:
        raise InputError(f"{path}: the triangles of `skin.mesh` must {problem}")


def _flat(p: Points, t: Integer) -> str | None:
    if not np.isfinite(p).all():
        return "have finite coordinates"
    a, b, c = (p[:, corner] for corner in t)
    longest = np.max([((u - v) ** 2).sum(axis=0) for u, v in ((a, b), (b, c), (c, a))], axis=0)
    bad = np.flatnonzero(areas(p, t) <= FLAT * longest)
    if len(bad):
        return f"have an area, got {len(bad)} without, one near {_place(p[:, t[0, bad[0]]])}"
    return None


def _torn(p: Points, t: Integer) -> str | None:
    """Requirement violated by points on other edges, or edges of over two triangles.

    Points at one place count as points on another edge.
    """
    from scipy.spatial import KDTree

    edges, of_triangle = edges_of(t)
    count = np.bincount(of_triangle.ravel())
    if (count > 2).any():
        where = p[:, edges[0, count.argmax()]]
        return f"meet in pairs, got {count.max()} at one edge near {_place(where)}"
    rim = edges[:, count == 1]
    points = np.unique(rim)
    same = SAME * np.ptp(p, axis=1).max()
    tree = KDTree(p[:, points].T)
    start, stop = p[:, rim[0]].T, p[:, rim[1]].T
    half = np.linalg.norm(stop - start, axis=1) / 2
    near = tree.query_ball_point((start + stop) / 2, half + same)
    edge = np.repeat(np.arange(len(near)), [len(each) for each in near])
    point = points[np.concatenate(near).astype(np.int64)]
    run = (stop - start) / (2 * half[:, None])
    offset = p[:, point].T - start[edge]
    along = (offset * run[edge]).sum(axis=1)
    off = np.linalg.norm(offset - along[:, None] * run[edge], axis=1)
    own = (rim[:, edge] == point).any(axis=0)
    bad = np.flatnonzero((off <= same) & ~own)
    if len(bad):
        return f"meet edge to edge, which they do not near {_place(p[:, point[bad[0]]])}"
    return None


def _folded(p: Points, t: Integer) -> str | None:
    """Requirement violated by plane triangles on the same side of their common edge."""
    if len(p) == 3:
        return None
    edges, of_triangle = edges_of(t)
    a, b = p[:, edges[0]], p[:, edges[1]]
    opposite = p[:, t[[2, 0, 1]]]
    run = (b - a)[:, of_triangle]
    offset = opposite - a[:, of_triangle]
    side = np.sign(run[0] * offset[1] - run[1] * offset[0])
    total = np.bincount(of_triangle.ravel(), weights=side.ravel())
    bad = np.flatnonzero(np.abs(total) == 2)
    if len(bad):
        return f"not overlap, got two that do near {_place(a[:, bad[0]])}"
    return None


def _in_parts(t: Integer) -> str | None:
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    edges, of_triangle = edges_of(t)
    triangle = np.tile(np.arange(t.shape[1]), 3)
    shape = (t.shape[1], edges.shape[1])
    shared = coo_array((np.ones(triangle.size), (triangle, of_triangle.ravel())), shape=shape)
    parts = connected_components((shared @ shared.T), directed=False)[0]
    return f"be connected by edges, got {parts} separate parts" if parts > 1 else None


def _place(x: Points) -> str:
    return f"({', '.join(f'{value:.6g}' for value in x)}) m"
