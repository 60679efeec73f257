"""Triangles of a mesh file: checked, and made to conform to the lines and arcs of a drawing."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..arrays import Integer, Mask
from ..scene.mesh_file import MeshSurface, foil_lines
from ..scene.planar import Circle, distance, nearest
from ..scene.skin import SheetsAndFoam
from ..sweeps import InputError, ToleranceError
from .arcs import Arcs, edges_of, on_arcs, rim_points
from .arrangement import WIDEST, Arrangement, arranged, chords
from .domain import Domain, Points, areas, labelled, unlabelled
from .drawing import Drawing
from .mending import collapsed, compressed, cut, edges_along, flipped, snapped
from .refinement import refined, without_inversions


def bent(mesh: Domain, drawing: Arrangement, curvature: Points, same: float) -> Domain:
    """Mesh with the points between the ends of chords moved onto the arcs.

    drawing: pieces that are unions of the mesh's edges; points nearer to them than `same` [m] lie
    on them. curvature: that of the arc over each piece, 1/m, 0 where it is straight.
    """
    which = np.flatnonzero(curvature)
    chords, curvature = drawing.points[drawing.pieces[which]], curvature[which]
    if not len(which):
        return mesh
    along, off = nearest(mesh.p.T, chords)
    on = off <= 2 * same
    point, piece = np.nonzero(on)
    p = mesh.p.copy()
    start, stop = chords[piece].transpose(1, 2, 0)
    p[:, point] = on_arcs(start, stop, curvature[piece], along[point, piece])
    edges, _ = edges_of(mesh.t)
    edge, piece = np.nonzero(on[edges[0]] & on[edges[1]])
    lines = edges[:, edge]
    forward = along[lines[1], piece] > along[lines[0], piece]
    return replace(mesh, p=p, arcs=Arcs(lines, np.where(forward, 1, -1) * curvature[piece]))


SAME = 1e-8
"""Distance over the mesh's extent below which a point lies on a line."""

MENDED = 3
"""Rounds of removing points and turning edges; each makes room for the other."""

SIDES_IN_SPACE = 128
"""Sides of the polygon for a disc on a mesh in space.

Its area is that of the disc, as seen along z.
"""

OUT_OF_ROUND = 2 * (np.pi / SIDES_IN_SPACE) ** 3 / 3
"""Largest distance of that polygon from the circle, times the length of a side.

Both are over the radius. The excess at its corners balances the lack at the middles of its sides.
"""

WIDEST_ARCS = (WIDEST, WIDEST / 4, WIDEST / 16)
COARSEST = 2.0
"""Longest edge of a triangle over the length of the pieces that it is cut along."""


def imported(drawing: Drawing) -> Domain:
    """Triangles of the mesh file of a drawing; see `skin_mesh.domain`."""
    mesh = drawing.skin.mesh
    assert mesh is not None
    path, surface = mesh.source, mesh.surface
    _check(path, surface)
    in_space = len(surface.p) == 3
    if in_space:
        _check_directions(drawing.skin, path)
        drawing = drawing.angular(SIDES_IN_SPACE)
    foils = {foil.name: foil_lines(surface, foil.edge, path) for foil in drawing.foils}
    groups = drawing.pixels.groups
    pixel = _grouped(path, surface, groups or ())
    whole = replace(unlabelled(surface.p, surface.t, foils), pixel=pixel)
    by_lines = drawing.between and not groups
    shapes = [_grid(drawing), *drawing.edges] if by_lines else drawing.edges
    cut = (_cut_along_z if in_space else _conforming)(whole, shapes)
    labels = labelled(drawing, cut)
    if groups is not None:
        labels = replace(labels, pixel=cut.pixel)
    return replace(labels, out_of_round=OUT_OF_ROUND) if in_space else labels


def _conforming(mesh: Domain, shapes: Sequence[Circle | Points]) -> Domain:
    """Flat mesh cut along circles and segments (segment, 2, 2), and kept well shaped.

    Circles are divided more finely where a point of the mesh is caught between a chord and its arc.
    """
    if not len(shapes):
        return mesh
    for widest in WIDEST_ARCS[:-1]:
        try:
            return _conforming_by(mesh, shapes, widest)
        except ToleranceError:
            continue
    return _conforming_by(mesh, shapes, WIDEST_ARCS[-1])


def _conforming_by(mesh: Domain, shapes: Sequence[Circle | Points], widest: float) -> Domain:
    """Mesh cut along shapes with arcs of at most `widest` [rad].

    Raises ToleranceError where the mesh cannot follow these arcs.
    """
    same = SAME * float(np.ptp(mesh.p, axis=1).max())
    kept = mesh.p[:, _kept_edges(mesh)].transpose(2, 1, 0)
    drawn = chords([*shapes, kept], np.empty((0, 2)), same, widest)[:-1]
    segments, curvature = (np.concatenate(part) for part in zip(*drawn, strict=True))
    lines = arranged(segments, same)
    pieces = lines.points[lines.pieces]
    mesh = _as_fine(mesh, pieces)
    between = _between(mesh.t, mesh.pixel)
    mesh = replace(mesh, p=snapped(mesh.p, mesh.t, between, lines.points, pieces))
    mesh = cut(mesh, pieces, same)
    fixed = [rim_points(mesh.t), _between(mesh.t, mesh.pixel), _at(mesh.p, lines.points, same)]
    movable = ~np.isin(np.arange(mesh.p.shape[1]), np.concatenate(fixed))
    for _ in range(MENDED):
        mesh = collapsed(mesh, movable, edges_along(mesh.p, mesh.t, pieces, same))
        mesh = replace(mesh, t=flipped(mesh.p, mesh.t, mesh.pixel, pieces, same))
    mesh = compressed(mesh)
    seams = np.hstack([edges_along(mesh.p, mesh.t, pieces, same), _kept_edges(mesh)])
    mesh = replace(mesh, seams=np.unique(seams, axis=1))
    return without_inversions(bent(mesh, lines, curvature[lines.segment], same))


def _cut_along_z(mesh: Domain, shapes: Sequence[Circle | Points]) -> Domain:
    """Mesh in space cut along segments (segment, 2, 2), as seen along z."""
    straight = [each for each in shapes if not isinstance(each, Circle)]
    if not straight:
        return mesh
    segments = np.concatenate(straight)
    same = SAME * float(np.ptp(mesh.p, axis=1).max())
    lines = arranged(segments, same)
    pieces = lines.points[lines.pieces]
    return cut(_as_fine(mesh, pieces), pieces, same)


def _check_directions(skin: SheetsAndFoam, path: str) -> None:
    """Raises InputError for keys that need a direction, which a mesh in space lacks."""
    ratios = skin.stretch.ratios if skin.stretch else (1.0, 1.0)
    directed = {
        "skin.top.anisotropy": skin.top.anisotropy,
        "skin.bottom.anisotropy": skin.bottom.anisotropy,
        "skin.stretch": ratios[0] != ratios[1],
        "skin.shape": skin.shape,
    }
    for key, there in directed.items():
        if there:
            raise InputError(f"skin.mesh {path} must lie in a plane for `{key}`")


def _kept_edges(mesh: Domain) -> Integer:
    """Edges at the boundary and between pixels, by numbers of points, (2, edge)."""
    edges, of_triangle = edges_of(mesh.t)
    rim = np.bincount(of_triangle.ravel()) == 1
    return edges[:, _of_several(of_triangle, mesh.pixel) | rim]


def _as_fine(mesh: Domain, pieces: Points) -> Domain:
    """Mesh refined until triangles at a piece are at most COARSEST times as long."""
    length = np.linalg.norm(pieces[:, 1] - pieces[:, 0], axis=1)
    while True:
        middle = mesh.p[:2, mesh.t].mean(axis=1).T
        wanted = COARSEST * (length + distance(middle, pieces)).min(axis=1)
        coarse = np.flatnonzero(mesh.lengths > wanted)
        if not len(coarse):
            return mesh
        mesh = refined(mesh, coarse)


def _between(t: Integer, pixel: Integer) -> Integer:
    """Points at which triangles of more than one pixel meet."""
    return np.flatnonzero(_of_several(t, pixel))


def _of_several(parts: Integer, pixel: Integer) -> Mask:
    """True for points or edges of triangles of more than one pixel.

    parts: numbers of the points or edges of each triangle, shape (3, triangle).
    """
    least, most = (np.full(int(parts.max()) + 1, start) for start in (pixel.max(), pixel.min()))
    np.minimum.at(least, parts.ravel(), np.tile(pixel, 3))
    np.maximum.at(most, parts.ravel(), np.tile(pixel, 3))
    return least < most


def _at(p: Points, places: Points, same: float) -> Integer:
    """Points of the mesh at places, shape (place, 2)."""
    from scipy.spatial import KDTree

    return np.flatnonzero(np.asarray(KDTree(places).query(p.T)[0]) <= 2 * same)


@functools.lru_cache(maxsize=4)
def _check(path: str, surface: MeshSurface) -> None:
    check(path, surface.p, surface.t)


def _grid(drawing: Drawing) -> Points:
    """Lines around pixels, shape (segment, 2, 2)."""
    x, y = drawing.lines
    across = [np.array([(line, y[0]), (line, y[-1])]) for line in x]
    return np.array([*across, *(np.array([(x[0], line), (x[-1], line)]) for line in y)])


def _grouped(path: str, surface: MeshSurface, groups: Sequence[Sequence[str]]) -> Integer:
    """Pixel of each triangle by the groups of the mesh file, -1 for those in none."""
    pixel = np.full(surface.t.shape[1], -1, dtype=np.int64)
    names = [name for row in groups for name in row]
    for number, name in enumerate(names):
        members = surface.triangle_groups.get(name, pixel[:0])
        if not len(members):
            there = [known for known, found in surface.triangle_groups.items() if len(found)]
            raise InputError(
                f"`pixels.groups` names {name!r}, which holds no triangle of {path}; "
                f"there are {', '.join(map(repr, there)) or 'no groups'}"
            )
        if (pixel[members] >= 0).any():
            raise InputError(f"`pixels.groups`: group {name!r} shares triangles with another")
        pixel[members] = number
    return pixel


FLAT = 1e-10
"""Area over the square of the longest edge up to which a triangle has no area."""
SAME_PLACE = 1e-9
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
    same = SAME_PLACE * np.ptp(p, axis=1).max()
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
