"""Mesher of a plane drawing: divides its pieces and adds points; reproducible.

Every triangle that is too large requests a point where that makes an equilateral triangle with its
shortest edge, or at its circumcentre if that is nearer (S. Rebay, Journal of Computational Physics
106 (1993) 125-138). Points are added in rounds, first those of the triangles that are largest for
their place, and only where there is room: so the rounds end, and lines are never divided again.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..arrays import Integer, Mask, Real
from ..scene.planar import Points, distance
from ..sweeps import InputError, ToleranceError
from .arcs import edge_numbers, edges_of, on_arcs


class MeshedDrawing(NamedTuple):
    """Triangles of a drawing.

    p: points in m, shape (2, point). t: triangles by numbers of points, shape (3, triangle). lines:
    edges along pieces of the drawing by numbers of points, shape (2, line). piece: that of each
    line, shape (line,).
    """

    p: Points
    t: Integer
    lines: Integer
    piece: Integer


def meshed(
    points: Points, pieces: Integer, curvature: Points, curve: Integer, size: float
) -> MeshedDrawing:
    """Triangles that conform to every piece of a drawing.

    size: edges have at most about this length [m]. points: m, shape (point, 2). pieces: numbers of
    their ends, shape (piece, 2). curvature: that of the arcs over pieces, 1/m, shape (piece,); 0
    where they are straight. curve: the closed curve that a piece is part of, 0 around the drawing
    and 1, 2, ... around holes, -1 inside, shape (piece,).

    Raises InputError if the library of triangulations is missing, ToleranceError if pieces cross.
    """
    sizing = Sizing(points, pieces, size)
    points, lines, piece = divided(points, pieces, curvature, sizing)
    fixed = len(points)
    points, t = filled(points, lines, curve[piece], sizing)
    points, t = smoothed(points, t, lines, curve[piece], fixed)
    used, number = np.unique(t, return_inverse=True)
    t, lines = number.reshape(t.shape), np.searchsorted(used, lines)
    return MeshedDrawing(points[used].T, t, np.sort(lines, axis=0), piece)


GROWTH = 0.7
"""Increase of the edge length with the distance from where edges are short."""
STEPS = 2
"""Number of steps in which the edge length changes by a factor of 2."""


class Sizing:
    """Edge length in steps.

    It is size / 2^(k / STEPS) where pieces need that or less, and longer elsewhere.
    """

    def __init__(self, points: Points, pieces: Integer, size: float) -> None:
        """Collects the places of each step.

        points, pieces: an arrangement; size: the longest edge, m.
        """
        from scipy.spatial import KDTree

        places, sizes = spacings(points, pieces)
        step = np.floor(STEPS * np.log2(size / np.minimum(sizes, size))).astype(int)
        self._size = size
        self._near = {
            size / 2 ** (k / STEPS): KDTree(places[step == k])
            for k in np.unique(step[step > 0]).tolist()
        }

    def __call__(self, places: Points) -> Real:
        """Lengths in m at places in m, shape (place, 2) to (place,)."""
        least = np.full(len(places), self._size)
        for short, near in self._near.items():
            reach = short + (self._size - short) / GROWTH
            off, _ = near.query(places, distance_upper_bound=reach)
            least = np.minimum(least, short + GROWTH * np.maximum(off - short, 0.0))
        return least


ASPECT = 2.0
"""Edge length over the width of the strip between two pieces."""
DEEPEST = 40
"""Largest number of times that a piece is halved."""


def spacings(points: Points, pieces: Integer) -> tuple[Points, Real]:
    """Places in m, shape (place, 2), and the requested edge length there, m.

    points, pieces: an arrangement. At an end of pieces the length is that of the shortest piece
    there; along a piece it is ASPECT times the distance to the nearest piece that it does not meet,
    at most the length of the piece.
    """
    ends = points[pieces]
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    shortest = np.full(len(points), np.inf)
    np.minimum.at(shortest, pieces.ravel(), np.repeat(length, 2))
    used = np.isfinite(shortest)
    places, sizes = [points[used]], [shortest[used]]
    whole, part = np.arange(len(pieces)), ends
    for _ in range(DEEPEST):
        middle = part.mean(axis=1)
        distances = _to_others(middle, whole, ends, pieces)
        places.append(middle)
        sizes.append(np.minimum(ASPECT * distances, length[whole]))
        coarse = np.linalg.norm(part[:, 1] - part[:, 0], axis=1) > 2 * ASPECT * distances
        if not coarse.any():
            break
        halves = [(part[coarse, 0], middle[coarse]), (middle[coarse], part[coarse, 1])]
        part = np.concatenate([np.stack(half, axis=1) for half in halves])
        whole = np.tile(whole[coarse], 2)
    return np.concatenate(places), np.concatenate(sizes)


def _to_others(middle: Points, whole: Integer, ends: Points, pieces: Integer) -> Real:
    """Distance from places on pieces to the nearest piece that theirs does not meet."""
    found = distance(middle, ends)
    for end in pieces[whole].T:
        for other in pieces.T:
            found[end[:, None] == other] = np.inf
    return found.min(axis=1)


PART = 0.25
"""Slice of a piece over the edge length there, which is constant in the slice."""
ROUNDING = 0.01


def divided(
    points: Points, pieces: Integer, curvature: Real, sizing: Sizing
) -> tuple[Points, Integer, Integer]:
    """Points, lines, and the piece of each line after division.

    Returns the points, m, those of the drawing first, shape (point, 2); the lines by numbers of
    their ends, shape (2, line); the piece of each, shape (line,). points, pieces and curvature are
    those of `meshed`.
    """
    ends = points[pieces]
    cuts, piece = _cuts(ends, curvature, sizing)
    start, stop = ends[piece].transpose(1, 2, 0)
    new = on_arcs(start, stop, curvature[piece], cuts).T
    number, whole = np.arange(len(points), len(points) + len(new)), np.arange(len(pieces))
    chain = np.concatenate([pieces[:, 0], number, pieces[:, 1]])
    owner = np.concatenate([whole, piece, whole])
    order = np.argsort(owner, kind="stable")
    chain, owner = chain[order], owner[order]
    within = owner[:-1] == owner[1:]
    lines = np.stack([chain[:-1], chain[1:]])[:, within]
    return np.concatenate([points, new]), lines, owner[:-1][within]


def _cuts(ends: Points, curvature: Real, sizing: Sizing) -> tuple[Real, Integer]:
    """Cuts as fractions of the chords of pieces, in order, and the piece of each cut."""
    whole, start, width, count = _slices(ends, curvature, sizing)
    total = np.bincount(whole, count, minlength=len(ends))
    lines = np.maximum(np.ceil(total - ROUNDING), 1).astype(int)
    piece = np.repeat(np.arange(len(ends)), lines - 1)
    first = np.cumsum(lines - 1) - (lines - 1)
    part = (np.arange(len(piece)) - first[piece] + 1) / lines[piece]
    before = np.cumsum(total) - total
    counted = np.concatenate([[0.0], np.cumsum(count)])
    along = np.append(whole + start, len(ends))
    return np.interp(before[piece] + part * total[piece], counted, along) - piece, piece


def _slices(ends: Points, curvature: Real, sizing: Sizing) -> tuple[Integer, Real, Real, Real]:
    """Slices of pieces in which edges are equally long, in order.

    Returns the piece of each slice, its start and its width as fractions of the chord, and how many
    edges it takes.
    """
    whole, start, width = np.arange(len(ends)), np.zeros(len(ends)), 1.0
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    found = []
    while len(whole):
        first, last = ends[whole].transpose(1, 2, 0)
        middle = on_arcs(first, last, curvature[whole], start + width / 2).T
        count = length[whole] * width / sizing(middle)
        coarse = count > PART
        fine = ~coarse
        found.append((whole[fine], start[fine], np.full(fine.sum(), width), count[fine]))
        width /= 2
        whole = np.tile(whole[coarse], 2)
        start = np.concatenate([start[coarse], start[coarse] + width])
    whole, start, width, count = (np.concatenate(part) for part in zip(*found, strict=True))
    order = np.lexsort((start, whole))
    return whole[order], start[order], width[order], count[order]


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


WIDEST = 1.05 / np.sqrt(3)
"""Largest circumradius of a triangle over the requested length.

It is 1 / sqrt(3) for an equilateral triangle.
"""
POINT_CLEARANCE = 0.57
"""Smallest distance of a new point from all others over the requested length."""
LINE_CLEARANCE = 0.35
"""Smallest distance of a new point from the middle of a line over its length."""
NEAREST = 3
"""Number of lines that are checked; a drawing has at least as many."""


def filled(
    points: Points, lines: Integer, curve: Integer, sizing: Sizing
) -> tuple[Points, Integer]:
    """Points, the given ones first, shape (point, 2), and their triangles.

    points, lines, curve and the triangles are as for `triangulated`. Some of the new points may be
    part of no triangle.
    """
    while True:
        t = triangulated(points, lines, curve)
        new, urgency = _new_points(points, t, sizing)
        free = _within_box(new, points) & _clear_of_lines(new, points, lines)
        new, urgency = new[free], urgency[free]
        reach = POINT_CLEARANCE * sizing(new)
        free = _clear_of_points(new, points, reach)
        new = _chosen(new[free], reach[free], urgency[free])
        if not len(new):
            return points, t
        points = np.concatenate([points, new])


def _new_points(points: Points, t: Integer, sizing: Sizing) -> tuple[Points, Real]:
    """New place for each triangle that is too large, and its urgency."""
    centre, radius = _circles(points, t)
    urgency = radius / sizing(points[t].mean(axis=0))
    large = (urgency > WIDEST) & np.isfinite(centre).all(axis=1)
    return _fronts(points, t[:, large], centre[large], sizing), urgency[large]


def _circles(points: Points, t: Integer) -> tuple[Points, Real]:
    """Circumcentres, shape (triangle, 2), and circumradii of triangles, m."""
    origin, first, second = points[t]
    u, v = first - origin, second - origin
    across = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    turned = (u**2).sum(axis=1)[:, None] * v - (v**2).sum(axis=1)[:, None] * u
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        to_centre = np.stack([turned[:, 1], -turned[:, 0]], axis=1) / (2 * across)[:, None]
        return origin + to_centre, np.linalg.norm(to_centre, axis=1)


def _fronts(points: Points, t: Integer, centre: Points, sizing: Sizing) -> Points:
    """Apexes over the shortest edges of triangles, or circumcentres where nearer."""
    corners = points[t]
    sides = np.roll(corners, -1, axis=0) - corners
    length = np.linalg.norm(sides, axis=2)
    shortest, every = length.argmin(axis=0), np.arange(t.shape[1])
    side, length = sides[shortest, every], length[shortest, every]
    middle = corners[shortest, every] + side / 2
    inward = np.stack([-side[:, 1], side[:, 0]], axis=1) / length[:, None]
    radius = np.maximum(sizing(middle) / np.sqrt(3), length / 2)
    height = radius + np.sqrt(np.maximum(radius**2 - length**2 / 4, 0.0))
    beyond = ((centre - middle) * inward).sum(axis=1) > height
    return np.where(beyond[:, None], middle + height[:, None] * inward, centre)


def _within_box(new: Points, points: Points) -> Mask:
    return ((new > points.min(axis=0)) & (new < points.max(axis=0))).all(axis=1)


def _clear_of_lines(new: Points, points: Points, lines: Integer) -> Mask:
    """True for places that keep off the middles of lines."""
    from scipy.spatial import KDTree

    start, stop = points[lines]
    length = np.linalg.norm(stop - start, axis=1)
    off, line = KDTree((start + stop) / 2).query(new, k=NEAREST)
    return (off >= LINE_CLEARANCE * length[line]).all(axis=1)


def _clear_of_points(new: Points, points: Points, reach: Real) -> Mask:
    """True for places that are at least `reach` away from all points."""
    from scipy.spatial import KDTree

    return KDTree(points).query(new)[0] >= reach


def _chosen(new: Points, reach: Real, urgency: Real) -> Points:
    """The most urgent places among those within reach of each other."""
    from scipy.spatial import KDTree

    if not len(new):
        return new
    order = np.lexsort((new[:, 1], new[:, 0], -urgency))
    new = new[order]
    left, chosen = np.ones(len(new), dtype=bool), []
    for number, around in enumerate(KDTree(new).query_ball_point(new, reach[order])):
        if left[number]:
            chosen.append(number)
            left[around] = False
    return new[chosen]


ROUNDS = 8
STEP = 0.5
"""Fraction of the way to the mean of places where triangles are equilateral."""
FLAT = 1e-3
"""Shape below which the weight of a triangle grows no further."""
SAME = 1e-9


def smoothed(
    points: Points, t: Integer, lines: Integer, curve: Integer, fixed: int
) -> tuple[Points, Integer]:
    """Points after moving, and the triangles between them.

    The number of points stays, and the first `fixed` do not move. points, lines, curve and the
    result are as for `triangulated`.
    """
    for _ in range(ROUNDS):
        points = _moved(points, t, fixed)
        t = triangulated(points, lines, curve)
    return points, t


def _moved(points: Points, t: Integer, fixed: int) -> Points:
    """Moves points where no triangle around them becomes worse than the worst was."""
    free = np.isin(np.arange(len(points)), t)
    free[:fixed] = False
    before = _worst(points, t)
    there = np.where(free[:, None], points + STEP * (_better(points, t) - points), points)
    while True:
        moved = np.where(free[:, None], there, points)
        worse = free & (_worst(moved, t) < before - SAME)
        if not worse.any():
            return moved
        free &= ~worse


def _better(points: Points, t: Integer) -> Points:
    """Mean of the apexes of equilateral triangles over the edges opposite each point.

    Badly shaped triangles weigh more; points without triangles stay.
    """
    weight = 1 / np.maximum(_shape(points, t), FLAT) ** 2
    towards, total = np.zeros_like(points), np.zeros(len(points))
    for corner in range(3):
        start, stop = points[np.roll(t, -corner, axis=0)[1:]]
        side = stop - start
        apex = (start + stop) / 2 + np.sqrt(3) / 2 * np.stack([-side[:, 1], side[:, 0]], axis=1)
        np.add.at(towards, t[corner], weight[:, None] * apex)
        np.add.at(total, t[corner], weight)
    none = total == 0
    return np.where(none[:, None], points, towards / (total + none)[:, None])


def _worst(points: Points, t: Integer) -> Real:
    """Smallest shape of the triangles around each point, shape (point,)."""
    shape, least = _shape(points, t), np.full(len(points), np.inf)
    for corner in t:
        np.minimum.at(least, corner, shape)
    return least


def _shape(points: Points, t: Integer) -> Real:
    """Shape of triangles: 1 if equilateral, 0 if flat, negative if clockwise.

    Shape (triangle,).
    """
    a, b, c = points[t]
    u, v, w = b - a, c - a, c - b
    squared = (u**2).sum(axis=1) + (v**2).sum(axis=1) + (w**2).sum(axis=1)
    return 2 * np.sqrt(3) * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / squared
