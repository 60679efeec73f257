"""Triangle meshes of skins of any outline, and of skins that mesh files describe."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from ..arrays import Integer, Real
from ..press.press import Press
from ..scene.contacts import Contact, curve_section
from ..scene.form import Curve
from ..scene.parts import Skin
from ..scene.planar import Circle
from ..scene.skin_region import curves
from .arcs import Arcs, arc_length, on_arcs
from .arrangement import Arrangement, Chords, arranged, chords
from .domain import Domain, Points, labelled, unlabelled
from .drawing import Drawing, Shape, around_pixels, closed, drawing_of, sharp_touches
from .imported import imported
from .mesher import MeshedDrawing, meshed
from .refinement import without_inversions

KEPT = 8
"""Number of meshes cached, those requested last.

All depths or factors of an applicator share one.
"""
Corners = tuple[tuple[float, ...], ...]


def domain(
    skin: Skin,
    press: Press,
    size: float,
    creases: Sequence[Shape] = (),
    between: bool = True,
) -> Domain:
    """Triangles of a scene's skin that conform to all lines where something jumps.

    These are its outline and holes, the ends of foils, the edges of the press's touches that have a
    factor, and `creases`, circles and polylines of shape (point, 2). All are in m. Edges along
    circles are arcs. size: requested longest edge [m]; edges are shorter near small features.
    between: True if the triangles also conform to the lines between all pixels; otherwise a
    triangle belongs to the pixel that its middle lies in. A mesh from a file keeps its own size,
    and is cut where it does not conform.

    Raises InputError if a mesh file cannot be used or the mesher is not installed; ToleranceError
    if lines or circles lie too near to each other.
    """
    if not between and skin.pixels.groups is None:
        creases = [*creases, *around_pixels(skin, press)]
    if skin.mesh is not None:
        return imported(drawing_of(skin, press, creases, between))
    sharp, edges = press.of(sharp_touches(press)), tuple(map(_fixed, creases))
    return _drawn(skin, sharp, size, edges, between)  # pyright: ignore[reportArgumentType]


def _fixed(crease: Shape) -> Circle | Corners:
    return crease if isinstance(crease, Circle) else tuple(map(tuple, crease.tolist()))


@lru_cache(maxsize=KEPT)
def _drawn(
    skin: Skin,
    press: Press,
    size: float,
    creases: tuple[Circle | Corners, ...],
    between: bool,
) -> Domain:
    edges = [each if isinstance(each, Circle) else np.array(each) for each in creases]
    return drawn(drawing_of(skin, press, edges, between), size)


SAME = 1e-8
"""Distance over the skin's longer side below which points are at one place."""


def drawn(drawing: Drawing, size: float) -> Domain:
    """Triangles of a drawing without a mesh file; see `skin_mesh.domain`."""
    skin = drawing.skin
    around = curves(skin)
    marks = np.array([end for foil in drawing.foils for end in foil.ends(skin)])
    same = SAME * max(skin.sides)
    shapes = [*(closed(curve.shape) for curve in around), *_grid(drawing), *drawing.edges]
    found = chords(shapes, marks, same)
    segments, curvature = (np.concatenate(part) for part in zip(*found, strict=True))
    pieces = _clipped(arranged(segments, same, marks), curvature, around, found)
    bends = curvature[pieces.segment]
    curve, middle = _on_boundary(pieces, bends, around, found)
    mesh = meshed(pieces.points, pieces.pieces, bends, curve, size)

    def under(foil: Contact) -> Integer:
        along = curve_section(foil, skin)
        there = (curve == along.curve) & (along.start < middle) & (middle < along.stop)
        return mesh.lines[:, there[mesh.piece]]

    foils = {foil.name: under(foil) for foil in drawing.foils}
    bare = unlabelled(mesh.p, mesh.t, foils, mesh.lines, _arcs(mesh, pieces, bends))
    return labelled(drawing, without_inversions(bare))


def _grid(drawing: Drawing) -> list[Points]:
    """Segments (segment, 2, 2) between pixels, m."""
    if not drawing.between:
        return []
    x, y = drawing.lines
    return [
        np.array([[(line, y[0]), (line, y[-1])] for line in x[1:-1]]).reshape(-1, 2, 2),
        np.array([[(x[0], line), (x[-1], line)] for line in y[1:-1]]).reshape(-1, 2, 2),
    ]


def _clipped(
    whole: Arrangement, curvature: Real, around: Sequence[Curve], found: Sequence[Chords]
) -> Arrangement:
    """Boundary, and the pieces inside the outline and outside its holes."""
    middle = _middles(whole, curvature[whole.segment]).T
    outline, *holes = around
    kept = outline.holds(middle)
    for hole in holes:
        kept &= ~hole.holds(middle)
    kept |= whole.segment < _boundary_segments(around, found)
    return Arrangement(whole.points, whole.pieces[kept], whole.segment[kept])


def _boundary_segments(around: Sequence[Curve], found: Sequence[Chords]) -> int:
    return sum(len(each.curvature) for each in found[: len(around)])


def _on_boundary(
    drawing: Arrangement, bends: Real, around: Sequence[Curve], found: Sequence[Chords]
) -> tuple[Integer, Real]:
    """Closed curve that each piece is part of, -1 inside, and distance along it, m.

    Both are of shape (piece,); the distance is that of the piece's middle.
    """
    rims = found[: len(around)]
    of_curve = np.repeat(np.arange(len(rims)), [len(each.curvature) for each in rims])
    starts = np.concatenate(
        [_starts(curve, each) for curve, each in zip(around, rims, strict=True)]
    )
    first = np.concatenate([each.segments[:, 0] for each in rims])
    curve, along = np.full(len(bends), -1), np.zeros(len(bends))
    there = np.flatnonzero(drawing.segment < len(starts))
    segment = drawing.segment[there]
    off = np.linalg.norm(_middles(drawing, bends)[there] - first[segment], axis=1)
    curve[there], along[there] = of_curve[segment], starts[segment] + arc_length(off, bends[there])
    return curve, along


def _starts(curve: Curve, rim: Chords) -> Real:
    """Distances along a curve at which its chords begin, m."""
    shape = curve.shape
    if isinstance(shape, Circle):
        return shape.radius * shape.angle(rim.segments[:, 0])
    return curve.marks[:-1]


def _middles(drawing: Arrangement, bends: Real) -> Points:
    """Middles of pieces or of the arcs over them, m, shape (piece, 2)."""
    start, stop = (drawing.points[end].T for end in drawing.pieces.T)
    return on_arcs(start, stop, bends).T


def _arcs(mesh: MeshedDrawing, drawing: Arrangement, bends: Real) -> Arcs:
    """Arcs of the mesh: its lines along pieces that bend."""
    bent = bends[mesh.piece] != 0
    lines, piece = mesh.lines[:, bent], mesh.piece[bent]
    run = mesh.p[:, lines[1]] - mesh.p[:, lines[0]]
    start, stop = (drawing.points[end].T for end in drawing.pieces[piece].T)
    return Arcs(lines, bends[piece] * np.sign((run * (stop - start)).sum(axis=0)))
