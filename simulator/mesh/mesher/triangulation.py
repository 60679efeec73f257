"""Constrained Delaunay triangulations of given points and lines."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...arrays import Integer, Mask
from ...scene.planar import Points
from ...sweeps import InputError, ToleranceError
from ..edge_numbering import edge_numbers, edges_of

TOO_NEAR = "lines of the skin or of the press are too near to others to mesh"


def triangulated(points: Points, lines: Integer, curve: Integer) -> Integer:
    """Triangles within a drawing by numbers of points, shape (3, triangle).

    They run anticlockwise. points: m, shape (point, 2). lines: numbers of their ends, shape (2,
    line), each an edge of the result. curve: the closed curve that a line is part of, as for
    `meshed`, shape (line,).

    Raises InputError if the library is missing, ToleranceError if lines cross.
    """
    t = _between(points, lines)
    edges, of_triangle = edges_of(t)
    line = edge_numbers(np.sort(lines, axis=0), edges)
    if (line < 0).any():
        raise ToleranceError(TOO_NEAR)
    return t[:, _within(of_triangle, line[curve >= 0], line[curve == 0])]


def _between(points: Points, lines: Integer) -> Integer:
    """Triangles of the points' convex hull."""
    try:
        import pythoncdt as cdt
    except ImportError as error:
        raise InputError(
            f"this skin is meshed by pythoncdt, which is missing ({error}): "
            "pip install 'rcskin[mesh]'"
        ) from error
    found: Any = cdt.Triangulation(
        cdt.VertexInsertionOrder.AUTO, cdt.IntersectingConstraintEdges.NOT_ALLOWED, 0.0
    )
    try:
        found.insert_vertices(np.ascontiguousarray(points))
        found.insert_edges(np.ascontiguousarray(lines.T, dtype=np.uintc))
    except RuntimeError as error:
        raise ToleranceError(TOO_NEAR) from error
    found.erase_super_triangle()
    return found.triangles_array()["vertices"].T.astype(np.int64)


def _within(of_triangle: Integer, walls: Integer, outline: Integer) -> Mask:
    """True for triangles inside the outline and in none of its holes, (triangle,).

    of_triangle: edges of triangles, as from `edges_of`. walls, outline: numbers of the edges along
    all closed curves, and along the one around the drawing.
    """
    part = _parts(of_triangle, walls)
    count = np.bincount(of_triangle.ravel())
    count[walls] = 2
    outside = part[(count == 1)[of_triangle].any(axis=0)]
    bordering = part[np.isin(of_triangle, outline).any(axis=0)]
    return np.isin(part, np.setdiff1d(bordering, outside))


def _parts(of_triangle: Integer, walls: Integer) -> Integer:
    """Number of the part of each triangle, shape (triangle,); walls separate parts."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    count = of_triangle.shape[1]
    triangle, edge = np.tile(np.arange(count), 3), of_triangle.ravel()
    passed = ~np.isin(edge, walls)
    pairs = triangle[passed], count + edge[passed]
    size = count + int(edge.max()) + 1
    graph = coo_array((np.ones(len(pairs[0])), pairs), shape=(size, size))
    return connected_components(graph, directed=False)[1][:count]
