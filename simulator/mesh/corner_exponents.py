"""Exponents of the distance from a corner of a mesh with which fields vary there.

At a corner the field varies as r^a: a = pi / omega within an angle omega, half of that where a foil
ends. Where the conductance jumps, u = r^p (a cos p t + b sin p t) in each wedge, t the angle; u and
the current across are the same on both sides of an edge between two. Anisotropic wedges are given
as stretched so that they conduct equally along all directions. Source: R. B. Kellogg, Appl. Anal.
4 (1975) 101.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Integer, Real
from .arcs import EDGES, edge_numbers, edges_of
from .domain import Domain, Points

WHOLE = 0.02
"""Distance from a whole number below which an exponent means a smooth field."""
JUMP = 1e-6
"""Relative difference of two conductances up to which it is rounding."""
LOW, HIGH = (0, 1, 0), (1, 2, 2)
"""Corners at the lower and the higher end of a triangle's edges of `edges_of`."""


@dataclass(frozen=True)
class SheetAtCorners:
    """Sheet of one field, at the corners of the triangles.

    foils: names of those that fix the field. films: names of those that feed it through a
    resistance. angle: angle of each triangle at each of its corners. conductance: that of the sheet
    there. Both are of shape (3, triangle), after a stretch that makes the sheet conduct equally
    along all directions. Without them it conducts so anyway, and the conductance jumps nowhere.
    """

    foils: Sequence[str]
    films: Sequence[str] = ()
    angle: Real | None = None
    conductance: Real | None = None


def corner_exponents(mesh: Domain, sheets: Sequence[SheetAtCorners]) -> Real:
    """Exponents of the distance with which fields vary at points, shape (point,).

    inf where fields are smooth; the minimum over several sheets.
    """
    edges, of_triangle = edges_of(mesh.t)
    rim = edges[:, np.bincount(of_triangle.ravel()) == 1]
    powers = [_powers(mesh, sheet, rim, of_triangle) for sheet in sheets]
    return np.min(powers, axis=0)


def _powers(mesh: Domain, sheet: SheetAtCorners, rim: Integer, of_triangle: Integer) -> Real:
    """Exponents of one sheet, shape (point,). rim: edges of the boundary, (2, edge)."""
    points, at = mesh.p.shape[1], np.unique(rim)
    angle = _angles(mesh) if sheet.angle is None else sheet.angle
    whole = np.bincount(mesh.t.ravel(), angle.ravel(), points)
    foil = _numbered(mesh, sheet.foils, rim)
    least, most = _extremes(foil, rim, points)
    found = np.full(points, np.inf)
    found[at] = np.where((least[at] == 0) & (most[at] > 0), 0.5, 1.0) * np.pi / whole[at]
    if sheet.conductance is not None:
        jumps = _jumps(mesh.t, of_triangle, sheet.conductance)
        for point in _crossed(mesh.t, angle, sheet.conductance, jumps, at):
            found[point] = _power_at(point, mesh.t, angle, sheet.conductance, rim[:, foil > 0])
    finite = np.flatnonzero(np.isfinite(found))
    power = found[finite]
    smooth = (np.abs(power - np.round(power)) < WHOLE) & (power > 1 / 2)
    if sheet.films:
        least, most = _extremes(_numbered(mesh, sheet.films, rim), rim, points)
        smooth &= (least[finite] >= most[finite]) | (np.abs(power - 1) >= WHOLE)
    found[finite[smooth]] = np.inf
    return found


def _numbered(mesh: Domain, foils: Sequence[str], rim: Integer) -> Integer:
    """Number of the foil on each edge of the rim from 1 on; 0 where there is none."""
    found = np.zeros(rim.shape[1], dtype=np.int64)
    for number, name in enumerate(foils, 1):
        own = edge_numbers(mesh.foils[name], rim)
        found[own[own >= 0]] = number
    return found


def _extremes(numbers: Integer, rim: Integer, points: int) -> tuple[Integer, Integer]:
    """Smallest and largest of the numbers of the rim's edges at each point."""
    least, most = np.full(points, numbers.max() + 1), np.zeros(points, dtype=np.int64)
    for ends in rim:
        np.minimum.at(least, ends, numbers)
        np.maximum.at(most, ends, numbers)
    return least, most


def _jumps(t: Integer, of_triangle: Integer, conductance: Real) -> Integer:
    """Number of edges at each point across which the conductance jumps, (point,)."""
    edge = of_triangle.ravel()
    order = np.argsort(edge, kind="stable")
    twice = np.flatnonzero(np.diff(edge[order]) == 0)
    one, other = (np.divmod(order[each], t.shape[1]) for each in (twice, twice + 1))
    found = np.zeros(t.max() + 1, dtype=np.int64)
    for end in (np.array(LOW), np.array(HIGH)):
        a, b = (conductance[end[side], triangle] for side, triangle in (one, other))
        point = t[end[one[0]], one[1]]
        np.add.at(found, point[np.abs(a - b) > JUMP * np.maximum(a, b)], 1)
    return found


def _crossed(t: Integer, angle: Real, conductance: Real, jumps: Integer, rim: Integer) -> list[int]:
    """Points at which the conductance jumps, except across a smooth line."""
    on_rim = np.zeros(len(jumps), dtype=bool)
    on_rim[rim] = True
    low, high = np.full(len(jumps), np.inf), np.zeros(len(jumps))
    np.minimum.at(low, t, conductance)
    np.maximum.at(high, t, conductance)
    upper = conductance > ((low + high) / 2)[t]
    above, whole = (
        np.bincount(t.ravel(), each.ravel(), len(jumps)) for each in (angle * upper, angle)
    )
    line = np.maximum(np.abs(above / np.pi - 1), np.abs(whole / np.pi - 2)) < WHOLE / 2
    return np.flatnonzero((jumps > 0) & (on_rim | (jumps != 2) | ~line)).tolist()


def _power_at(point: int, t: Integer, angle: Real, conductance: Real, foil_edges: Integer) -> float:
    """Exponent at a point by the wedges around it.

    foil_edges: edges of foils, which fix the field, shape (2, edge).
    """
    corner, triangle = np.nonzero(t == point)
    sides = [set(t[:, k].tolist()) - {point} for k in triangle.tolist()]
    turn, first, last = _in_turn(sides)
    wedges = [
        (float(angle[corner[k], triangle[k]]), float(conductance[corner[k], triangle[k]]))
        for k in turn
    ]
    if first == last:
        return around(wedges)
    foils = set(map(tuple, foil_edges.T.tolist()))
    begins, stops = ((min(point, end), max(point, end)) in foils for end in (first, last))
    return between(wedges, begins, stops)


def _in_turn(sides: list[set[int]]) -> tuple[list[int], int, int]:
    """Triangles around a point in order, and the points where they begin and end.

    sides: the other two points of each triangle. Where rims touch in the point, the triangles are
    those between two rims.
    """
    ends = [end for side in sides for end in side if sum(end in each for each in sides) == 1]
    first = last = min(ends) if ends else min(sides[0])
    turn, left = list[int](), list(range(len(sides)))
    while adjacent := [k for k in left if last in sides[k]]:
        turn.append(adjacent[0])
        left.remove(adjacent[0])
        (last,) = sides[adjacent[0]] - {last}
    return turn, first, last


def _angles(mesh: Domain) -> Real:
    """Angles of triangles at their corners, rad, shape (3, triangle)."""
    corners = mesh.p[:, mesh.t]
    at = _between(*(np.roll(corners, -turn, axis=1) - corners for turn in (1, 2)))
    for (i, j), bend in zip(EDGES, mesh.curvature, strict=True):
        bent = np.flatnonzero(bend)
        if not bent.size:
            continue
        start, chord = corners[:, i, bent], corners[:, j, bent] - corners[:, i, bent]
        across = corners[:, 3 - i - j, bent] - start
        left = np.sign(chord[0] * across[1] - chord[1] * across[0])
        turned = left * np.arcsin(bend[bent] * np.linalg.norm(chord, axis=0) / 2)
        at[i, bent] -= turned
        at[j, bent] -= turned
    return at


def _between(u: Points, v: Points) -> Real:
    shared = (u * v).sum(axis=0)
    area = np.sqrt(np.maximum((u**2).sum(axis=0) * (v**2).sum(axis=0) - shared**2, 0.0))
    return np.arctan2(area, shared)


MIN_EXPONENT, MAX_EXPONENT, STEP = 0.01, 5.0, 0.02
"""Range and step of the exponents searched.

Beyond the range, all is as smooth as elements are.
"""
ZOOMS, ZOOMED = 4, 21
Wedges = Sequence[tuple[float, float]]
"""Angle and conductance of each wedge, anticlockwise."""


def around(wedges: Wedges) -> float:
    """Smallest exponent at a point with wedges all around, 1 where they are equal."""
    return min(_first(lambda p: 2 - np.trace(_transfer(wedges, p)), 1.0), 1.0)


def between(wedges: Wedges, begins: bool, stops: bool) -> float:
    """Smallest exponent at a point of the rim.

    begins, stops: True if a foil fixes u at that side.
    """
    sign = 1 if begins or stops else -1
    return _first(lambda p: sign * _transfer(wedges, p)[0 if stops else 1, 1 if begins else 0])


def _transfer(wedges: Wedges, powers: Real) -> Real:
    """Matrices from potential and current over p at the first edge to the last.

    They are given for all powers, shape (2, 2, power).
    """
    M = np.eye(2)[:, :, None] * np.ones(len(powers))
    for angle, S in wedges:
        cos, sin = np.cos(powers * angle), np.sin(powers * angle)
        u, current = M
        M = np.stack([cos * u + sin / S * current, cos * current - S * sin * u])
    return M


def _first(values_at: Callable[[Real], Real], most: float = MAX_EXPONENT) -> float:
    """First power at which values that begin above 0 no longer are; inf if none."""
    low, high, count = MIN_EXPONENT, most, round((most - MIN_EXPONENT) / STEP) + 1
    for _ in range(ZOOMS + 1):
        powers = np.linspace(low, high, count)
        below = np.flatnonzero(values_at(powers) <= 0)
        if not below.size:
            return np.inf
        low, high, count = powers[max(below[0] - 1, 0)], powers[below[0]], ZOOMED
    return float(low + high) / 2


def stretched(along: Real, across: Real, S: Real) -> tuple[Real, Real]:
    """Angles between edges after a stretch that makes S isotropic, and S then.

    along, across: shape (2, ...). S: its xx, yy and xy, shape (3, ...). Both results are of shape
    (...).
    """
    xx, yy, xy = S
    isotropic = np.sqrt(xx * yy - xy**2)
    dot = yy * along[0] * across[0] + xx * along[1] * across[1]
    dot = dot - xy * (along[0] * across[1] + along[1] * across[0])
    area = isotropic * np.abs(along[0] * across[1] - along[1] * across[0])
    return np.arctan2(area, dot), isotropic
