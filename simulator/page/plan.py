"""Plan of a skin that a page draws: its outline, its foils and its pixels."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import Integer, Mask, Real
from ..mesh.arcs import edges_of
from ..mesh.domain import Domain
from ..mesh.pixel_coverage import pixel_coverage
from ..models.reduced.family import Family, Triangulation
from ..scene.contacts import Contact, curve_section, path
from ..scene.parts import Skin
from ..scene.planar import Circle
from ..scene.skin import SheetsAndFoam
from ..scene.skin_region import curves

CIRCLE_SIDES = 96
"""Number of sides that a circle is drawn with."""
EDGE_STEP = 1e-4
"""Distance off an edge, over the skin's longer side, at which skin is looked for."""
DIGITS = 7
"""Decimals of places in m: a tenth of a micrometre."""

Points = Real


def plan(skin: Skin, family: Family) -> dict[str, Any]:
    """Lines in m, as lists of (x, y).

    family: that of the scene; its mesh has the pixels' groups. outline: closed lines. foils: with
    pieces (x, y, x, y, away x, away y), where away is a unit vector off the skin. held: numbers,
    from 0, of the pixels that contain any skin. middles: that of the skin in each pixel. groups:
    closed lines around the skin of each pixel, where pixels are groups.
    """
    mesh = family.mesh.domain if isinstance(family.mesh, Triangulation) else None
    of_file = mesh if skin.mesh is not None else None
    every = pixel_coverage(skin)
    return {
        "outline": _rounded(_outline(skin) if of_file is None else boundary_lines(of_file)),
        "foils": [
            {
                "name": contact.name,
                "electrode": contact.electrode,
                "pieces": _rounded(
                    _foil_pieces(contact, skin)
                    if of_file is None
                    else _facet_pieces(of_file.foils[contact.name], of_file)
                ),
            }
            for contact in skin.contacts
        ],
        "held": every.numbers.tolist(),
        "middles": _rounded(every.middle.T),
        "groups": None if skin.pixels.groups is None or mesh is None else _group_lines(skin, mesh),
    }


def boundary_lines(mesh: Domain, within: Mask | None = None) -> list[Points]:
    """Closed lines around some triangles, by default all, m, shape (point, 2) each."""
    t = mesh.t if within is None else mesh.t[:, within]
    if not t.shape[1]:
        return []
    edges, of_triangle = edges_of(t)
    rim = edges[:, np.bincount(of_triangle.ravel()) == 1]
    return [mesh.p[:2, each].T for each in _closed_walks(rim)]


def _closed_walks(edges: Integer) -> list[list[int]]:
    """Closed walks that take every edge once. edges: numbers of points, shape (2, edge)."""
    beside: dict[int, list[int]] = {}
    for a, b in edges.T.tolist():
        beside.setdefault(a, []).append(b)
        beside.setdefault(b, []).append(a)
    walks = []
    for start in beside:
        while beside[start]:
            walk, here = [start], start
            while beside[here]:
                following = beside[here].pop()
                beside[following].remove(here)
                walk.append(following)
                here = following
            walks.append(walk[:-1])
    return walks


def _outline(skin: SheetsAndFoam) -> list[Points]:
    """Outline of a skin without mesh."""
    angle = 2 * np.pi * np.arange(CIRCLE_SIDES) / CIRCLE_SIDES
    shapes = [curve.shape for curve in curves(skin)]
    return [each.at(angle) if isinstance(each, Circle) else each for each in shapes]


def _foil_pieces(contact: Contact, skin: SheetsAndFoam) -> Points:
    """Pieces of a foil on a skin without mesh."""
    along = curve_section(contact, skin)
    curve = curves(skin)[along.curve]
    if isinstance(curve.shape, Circle):
        x = path(contact, skin, CIRCLE_SIDES)
    else:
        between = [mark for mark in curve.marks if along.start < mark < along.stop]
        x = np.array([curve.at(mark) for mark in (along.start, *between, along.stop)]).T
    outline, *holes = curves(skin)
    off = EDGE_STEP * max(skin.sides) * _left_normals(x[:, :-1], x[:, 1:])
    beside = (x[:, :-1] + x[:, 1:]) / 2 + off
    on_left = outline.holds(beside)
    for hole in holes:
        on_left &= ~hole.holds(beside)
    away = np.where(on_left, -1, 1) * _left_normals(x[:, :-1], x[:, 1:])
    return np.concatenate([x[:, :-1], x[:, 1:], away]).T


def _facet_pieces(facets: Integer, mesh: Domain) -> Points:
    """Pieces of a foil on a mesh. facets: numbers of points, shape (2, facet)."""
    start, stop = mesh.p[:2, facets[0]], mesh.p[:2, facets[1]]
    of_edge = {(a, b): k for k, three in enumerate(mesh.t.T.tolist()) for a, b in _pairs(three)}
    triangle = [of_edge[a, b] for a, b in np.sort(facets, axis=0).T.tolist()]
    inwards = mesh.middles[:, triangle] - start
    left = _left_normals(start, stop)
    away = -np.sign((inwards * left).sum(axis=0)) * left
    return np.concatenate([start, stop, away]).T


def _pairs(three: list[int]) -> list[tuple[int, int]]:
    a, b, c = three
    return [(a, b), (b, c), (a, c)]


def _left_normals(start: Points, stop: Points) -> Points:
    """Unit vectors to the left of lines, both of shape (2, line)."""
    run = stop - start
    return np.stack([-run[1], run[0]]) / np.maximum(np.linalg.norm(run, axis=0), 1e-300)


def _group_lines(skin: Skin, mesh: Domain) -> list[list[list[list[float]]]]:
    rows, columns = skin.pixels.shape
    return [
        _rounded(boundary_lines(mesh, mesh.pixel == number)) for number in range(rows * columns)
    ]


def _rounded(lines: Any) -> Any:
    """Lists of rounded numbers."""
    if isinstance(lines, list):
        return [_rounded(each) for each in lines]
    return np.round(lines, DIGITS).tolist()
