"""Mesher of a plane drawing: divides its pieces and adds points; reproducible."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...arrays import Integer
from ...scene.planar import Points
from .dividing import divided
from .filling import filled
from .sizing import Sizing
from .smoothing import smoothed


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
