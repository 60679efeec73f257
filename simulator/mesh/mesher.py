"""gmsh, asked for the triangles of a plane drawing: silent, on one thread, the same each time."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..scene.planar import Points, distance
from ..sweeps import InputError
from .arcs import centres
from .triangles import edge_numbers, edges_of

ASPECT = 2.0
"""Length of edges over the width of the strip between two pieces."""

DEEPEST = 40
"""Halvings of a piece."""


def spacings(points: Points, pieces: NDArray[np.int64]) -> tuple[Points, NDArray[np.float64]]:
    """Places in m, shape (place, 2), and the length in m that edges shall have there.

    points, pieces: an arrangement. At the ends of pieces that is the length of the shortest piece
    there; along a piece it is ASPECT times the distance to the nearest one that it does not meet.
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
        apart = _to_others(middle, whole, ends, pieces)
        places.append(middle)
        sizes.append(np.minimum(ASPECT * apart, length[whole]))
        coarse = np.linalg.norm(part[:, 1] - part[:, 0], axis=1) > 2 * ASPECT * apart
        if not coarse.any():
            break
        halves = [(part[coarse, 0], middle[coarse]), (middle[coarse], part[coarse, 1])]
        part = np.concatenate([np.stack(half, axis=1) for half in halves])
        whole = np.tile(whole[coarse], 2)
    return np.concatenate(places), np.concatenate(sizes)


def _to_others(
    middle: Points, whole: NDArray[np.int64], ends: Points, pieces: NDArray[np.int64]
) -> NDArray[np.float64]:
    """From places on pieces to the nearest piece that theirs does not meet, m."""
    apart = distance(middle, ends)
    for end in pieces[whole].T:
        for other in pieces.T:
            apart[end[:, None] == other] = np.inf
    return apart.min(axis=1)


EXTENT = 1024.0
"""Of a drawing as gmsh sees it, at most: its tolerances are absolute."""

GROWTH = 1.0
"""Rise of the length of edges with the distance from where they are short."""

LIBRARIES = "libglu1-mesa, libxrender1, libxcursor1, libxft2 and libxinerama1"
STEPS = 2
"""Lengths of edges told apart within a factor of 2."""

OPTIONS = {
    "General.Terminal": 0,
    "General.Verbosity": 0,
    "General.NumThreads": 1,
    "Mesh.Algorithm": 6,
    "Mesh.LcIntegrationPrecision": 1e-3,
    "Mesh.RandomSeed": 1,
    "Mesh.MeshSizeFromPoints": 0,
    "Mesh.MeshSizeExtendFromBoundary": 0,
    "Mesh.MeshSizeMin": 0,
}

Numbers = NDArray[np.int64]


class Meshed(NamedTuple):
    """Points in m, shape (2, point); triangles, shape (3, triangle), and the edges along pieces of
    the drawing, shape (2, line), by numbers of points; the piece of each line, shape (line,)."""

    p: Points
    t: Numbers
    lines: Numbers
    piece: Numbers


def meshed(
    points: Points, pieces: Numbers, curvature: Points, curve: Numbers, size: float
) -> Meshed:
    """Triangles with edges of at most about `size` [m] that conform to every piece of a drawing.

    points: m, shape (point, 2). pieces: numbers of their ends, shape (piece, 2), in order along
    each closed curve that bounds the drawing. curvature: of the arcs over pieces, 1/m, shape
    (piece,); 0 where they are straight. curve: that which a piece is part of, 0 around it and
    1, 2, ... around holes, -1 inside, shape (piece,).
    """
    scale = 2.0 ** np.floor(np.log2(EXTENT / np.ptp(points, axis=0).max()))
    with _gmsh() as gmsh:
        _draw(gmsh, points * scale, pieces, curvature / scale, curve)
        _set_sizes(gmsh, points * scale, pieces, size * scale)
        gmsh.model.mesh.generate(2)
        return _read(gmsh, len(pieces), scale)


@contextlib.contextmanager
def _gmsh() -> Iterator[Any]:
    try:
        import gmsh
    except (ImportError, OSError) as error:
        raise InputError(
            f"this skin is meshed by gmsh, whose library cannot be loaded: {error} "
            f"({LIBRARIES} are what it needs on Debian and Ubuntu)"
        ) from error
    started = not gmsh.isInitialized()
    if started:
        gmsh.initialize([], readConfigFiles=False, interruptible=False)
    before = {name: gmsh.option.getNumber(name) for name in OPTIONS}
    try:
        for name, value in OPTIONS.items():
            gmsh.option.setNumber(name, value)
        gmsh.model.add("skin")
        yield gmsh
    finally:
        if started:
            gmsh.finalize()
        else:
            gmsh.model.remove()
            for name, value in before.items():
                gmsh.option.setNumber(name, value)


def _draw(gmsh: Any, points: Points, pieces: Numbers, curvature: Points, curve: Numbers) -> None:
    """Piece number i becomes gmsh's curve i + 1."""
    geo = gmsh.model.geo
    for number in np.unique(pieces).tolist():
        geo.addPoint(*points[number].tolist(), 0.0, 0.0, number + 1)
    straight = curvature == 0
    for number in np.flatnonzero(straight).tolist():
        geo.addLine(*(pieces[number] + 1).tolist(), number + 1)
    start, stop = (points[end].T for end in pieces[~straight].T)
    of_circles = centres(start, stop, curvature[~straight]).T.tolist()
    for number, centre in zip(np.flatnonzero(~straight).tolist(), of_circles, strict=True):
        first, last = (pieces[number] + 1).tolist()
        geo.addCircleArc(first, geo.addPoint(*centre, 0.0), last, number + 1)
    count = int(curve.max()) + 1
    for number in range(count):
        geo.addCurveLoop((np.flatnonzero(curve == number) + 1).tolist(), number + 1)
    geo.addPlaneSurface(list(range(1, count + 1)), 1)
    geo.synchronize()
    gmsh.model.mesh.embed(1, (np.flatnonzero(curve < 0) + 1).tolist(), 2, 1)


def _set_sizes(gmsh: Any, points: Points, pieces: Numbers, size: float) -> None:
    """By steps: edges of size / 2^(k / STEPS) where that or less is asked for, longer elsewhere."""
    places, sizes = spacings(points, pieces)
    step = np.floor(STEPS * np.log2(size / np.minimum(sizes, size))).astype(int)
    field = gmsh.model.mesh.field
    thresholds = []
    for k in np.unique(step[step > 0]).tolist():
        there = [gmsh.model.geo.addPoint(*at, 0.0) for at in places[step == k].tolist()]
        near, short = field.add("Distance"), size / 2 ** (k / STEPS)
        field.setNumbers(near, "PointsList", there)
        rise = {"SizeMin": short, "DistMin": short, "DistMax": short + (size - short) / GROWTH}
        thresholds.append(field.add("Threshold"))
        for name, value in {"InField": near, "SizeMax": size, **rise}.items():
            field.setNumber(thresholds[-1], name, value)
    gmsh.model.geo.synchronize()
    least = field.add("Min")
    field.setNumbers(least, "FieldsList", thresholds)
    field.setAsBackgroundMesh(least)
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)


def _read(gmsh: Any, count: int, scale: float) -> Meshed:
    tags, positions, _ = gmsh.model.mesh.getNodes()
    t = gmsh.model.mesh.getElementsByType(2)[1].astype(np.int64).reshape(-1, 3).T
    of_piece = [
        gmsh.model.mesh.getElementsByType(1, number + 1)[1].astype(np.int64).reshape(-1, 2).T
        for number in range(count)
    ]
    used = np.unique(t)
    number = np.full(int(tags.max()) + 1, -1, dtype=np.int64)
    number[used] = np.arange(len(used))
    at = np.empty((2, number.size))
    at[:, tags.astype(np.int64)] = positions.reshape(-1, 3).T[:2] / scale
    lines = np.concatenate(of_piece, axis=1)
    piece = np.repeat(np.arange(count), [part.shape[1] for part in of_piece])
    t, lines = number[t], np.sort(number[lines], axis=0)
    if not t.size or (edge_numbers(lines, edges_of(t)[0]) < 0).any():
        raise RuntimeError("gmsh made triangles that do not conform to the skin's drawing")
    return Meshed(at[:, used], t, lines, piece)
