"""A skin that a mesh file brings: its foils and pixels by named groups, cut where need be."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from simulator.domain.arrangement import arranged
from simulator.domain.collapsing import collapsed, compressed
from simulator.domain.cutting import cut
from simulator.domain.flipping import edges_along, flipped
from simulator.domain.refinement import refined
from simulator.domain.region import (
    Domain,
    Numbers,
    Points,
    corners,
    labelled,
    sharp_touches,
)
from simulator.domain.snapping import snapped
from simulator.domain.sound import check
from simulator.domain.triangles import rim_points
from simulator.foam import pixel_lines
from simulator.mesh_file import Surface, foil_lines, read_surface
from simulator.planar import distance, sides
from simulator.press import Press
from simulator.scene import Scene
from simulator.sweeps import InputError

SAME = 1e-8
"""What is nearer than this times the mesh's extent to a line lies on it."""

MENDED = 3
"""Times that points are taken out and edges turned, for what one allows the other."""
COARSEST = 2.0
"""Longest edges of triangles over the length of what they are cut along."""


def imported(scene: Scene, press: Press, creases: Sequence[Points]) -> Domain:
    """See `simulator.domain.domain`."""
    path = scene.skin.mesh
    assert path is not None
    surface = read_surface(path)
    _check(path, surface)
    foils = {contact.name: foil_lines(surface, contact.edge, path) for contact in scene.contacts}
    pixel = _grouped(path, surface, scene)
    uncovered = np.zeros((0, len(pixel)), dtype=bool)
    whole = Domain(surface.p, surface.t, pixel, uncovered, foils)
    mesh = _conforming(whole, _segments(scene, press, creases))
    labels = labelled(scene, press, mesh.p, mesh.t, mesh.foils)
    return labels if scene.pixels.groups is None else replace(labels, pixel=mesh.pixel)


def _conforming(mesh: Domain, segments: Points) -> Domain:
    """The mesh cut along segments, shape (segment, end, 2); a flat one is kept well shaped."""
    if not len(segments):
        return mesh
    same = SAME * float(np.ptp(mesh.p, axis=1).max())
    lines = arranged(segments, same)
    pieces = lines.points[lines.pieces]
    mesh = _as_fine(mesh, pieces)
    if len(mesh.p) == 3:
        return cut(mesh, pieces, same)
    between = _between(mesh.t, mesh.pixel)
    mesh = replace(mesh, p=snapped(mesh.p, mesh.t, between, lines.points, pieces))
    mesh = cut(mesh, pieces, same)
    fixed = [rim_points(mesh.t), _between(mesh.t, mesh.pixel), _at(mesh.p, lines.points, same)]
    movable = ~np.isin(np.arange(mesh.p.shape[1]), np.concatenate(fixed))
    for _ in range(MENDED):
        mesh = collapsed(mesh, movable, edges_along(mesh.p, mesh.t, pieces, same))
        mesh = replace(mesh, t=flipped(mesh.p, mesh.t, mesh.pixel, pieces, same))
    return compressed(mesh)


def _as_fine(mesh: Domain, pieces: Points) -> Domain:
    """Refined until triangles beside a piece are no more than COARSEST times as long as it."""
    length = np.linalg.norm(pieces[:, 1] - pieces[:, 0], axis=1)
    while True:
        middle = mesh.p[:2, mesh.t].mean(axis=1).T
        wanted = COARSEST * (length + distance(middle, pieces)).min(axis=1)
        coarse = np.flatnonzero(mesh.lengths > wanted)
        if not len(coarse):
            return mesh
        mesh = refined(mesh, coarse)


def _between(t: Numbers, pixel: Numbers) -> Numbers:
    """The points at which triangles of more than one pixel meet."""
    least, most = (np.full(int(t.max()) + 1, start) for start in (pixel.max(), pixel.min()))
    np.minimum.at(least, t.ravel(), np.tile(pixel, 3))
    np.maximum.at(most, t.ravel(), np.tile(pixel, 3))
    return np.flatnonzero(least < most)


def _at(p: Points, places: Points, same: float) -> Numbers:
    """The points at places, shape (place, 2)."""
    from scipy.spatial import KDTree

    return np.flatnonzero(np.asarray(KDTree(places).query(p.T)[0]) <= 2 * same)


@functools.lru_cache(maxsize=4)
def _check(path: str, surface: Surface) -> None:
    check(path, surface.p, surface.t)


def _segments(scene: Scene, press: Press, creases: Sequence[Points]) -> Points:
    """Lines around pixels unless those are groups, edges of touches and `creases`."""
    x, y = pixel_lines(scene, 0), pixel_lines(scene, 1)
    across = [np.array([(line, y[0]), (line, y[-1])]) for line in x]
    along = [np.array([(x[0], line), (x[-1], line)]) for line in y]
    grid = [] if scene.pixels.groups else [np.array([*across, *along])]
    of_touches = [sides(corners(scene, touch)) for touch in sharp_touches(press)]
    of_creases = [np.stack([crease[:-1], crease[1:]], axis=1) for crease in creases]
    return np.concatenate([*grid, *of_touches, *of_creases, np.empty((0, 2, 2))])


def _grouped(path: str, surface: Surface, scene: Scene) -> Numbers:
    """The pixel of each triangle by the groups of the mesh, -1 for those in none."""
    pixel = np.full(surface.t.shape[1], -1, dtype=np.int64)
    names = [name for row in scene.pixels.groups or () for name in row]
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
