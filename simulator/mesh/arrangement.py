"""Lines and circles in the plane, divided where they meet each other or points."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..arrays import Integer, Real
from ..scene.planar import Circle, Points, crossings, nearest

NO_MARKS = np.empty((0, 2))


class Arrangement(NamedTuple):
    """Segments divided at their crossings.

    points: m, shape (point, 2). pieces: numbers of their ends, shape (piece, 2), sorted by segment
    and then along it. segment: the first segment that each piece is part of, shape (piece,).
    """

    points: Points
    pieces: Integer
    segment: Integer


def arranged(segments: Points, same: float, marks: Points = NO_MARKS) -> Arrangement:
    """Arrangement of segments, shape (segment, end, 2), and points `marks` on them.

    Points nearer to each other than `same` [m] are merged; a point nearer than that to a segment
    lies on it. Points of earlier segments keep their places.
    """
    if not len(segments):
        return Arrangement(marks, np.empty((0, 2), np.int64), np.empty(0, np.int64))
    start, run = segments[:, 0], segments[:, 1] - segments[:, 0]
    t = crossings(segments, segments)
    first, second = np.nonzero(~np.isnan(np.triu(t)) & ~np.eye(len(t), dtype=bool))
    upper = first < second
    first, second = first[upper], second[upper]
    met = start[first] + t[first, second, None] * run[first]
    points = _merged(np.concatenate([segments.reshape(-1, 2), marks, met]), same)
    where, off = nearest(points, segments)
    on = off <= same
    pieces, owner = [], []
    for number in range(len(segments)):
        there = np.flatnonzero(on[:, number])
        there = there[np.argsort(where[there, number], kind="stable")]
        pieces.append(np.stack([there[:-1], there[1:]], axis=1))
        owner.append(np.full(len(there) - 1, number))
    every = np.concatenate(pieces)
    first_time = np.unique(np.sort(every, axis=1), axis=0, return_index=True)[1]
    kept = np.sort(first_time)
    return Arrangement(points, every[kept], np.concatenate(owner)[kept])


def _merged(points: Points, same: float) -> Points:
    """Points without those nearer than `same` to an earlier one."""
    from scipy.spatial import KDTree

    kept = np.ones(len(points), dtype=bool)
    pairs = KDTree(points).query_pairs(same, output_type="ndarray")
    for early, late in pairs[np.lexsort(pairs.T[::-1])]:
        if kept[early]:
            kept[late] = False
    return points[kept]


Angles = Real

WIDEST = np.pi / 8
"""Largest angle of an arc, seen from the centre, rad."""

CLOSE = 0.05
"""Distance to a circle over its radius within which points divide it at their angles."""

MAX_ARRANGEMENT_ROUNDS = 20


class Chords(NamedTuple):
    """Straight segments, and chords of arcs.

    segments: m, shape (segment, end, 2). curvature: that of the arcs over them, 1/m, shape
    (segment,); positive where an arc lies left of its chord, 0 where it is straight.
    """

    segments: Points
    curvature: Real


def chords(
    shapes: Sequence[Circle | Points], marks: Points, same: float, widest: float = WIDEST
) -> list[Chords]:
    """Chords of circles, and straight segments, shape (segment, end, 2); m.

    marks: points that divide the circles on which they lie, shape (point, 2). same: distance [m]
    within which a point lies on a circle. widest: largest angle of an arc, rad. A circle that
    repeats an earlier one has no chords.
    """
    straight = np.concatenate(
        [np.empty((0, 2, 2)), *(shape for shape in shapes if not isinstance(shape, Circle))]
    )
    circles = [shape for shape in shapes if isinstance(shape, Circle)]
    first = [circle for k, circle in enumerate(circles) if not _known(circle, circles[:k], same)]
    points = np.concatenate([straight.reshape(-1, 2), marks])
    divided = _divided(first, straight, points, same, widest)
    found = {circle: _around(circle, at) for circle, at in zip(first, divided, strict=True)}
    none = np.empty((0, 2, 2))
    return [
        found.pop(shape, Chords(none, np.zeros(0)))
        if isinstance(shape, Circle)
        else Chords(shape, np.zeros(len(shape)))
        for shape in shapes
    ]


def _known(circle: Circle, others: Sequence[Circle], same: float) -> bool:
    return any(np.abs(np.subtract(circle, other)).max() <= same for other in others)


def _around(circle: Circle, angles: Angles) -> Chords:
    points = circle.at(angles)
    segments = np.stack([points, np.roll(points, -1, axis=0)], axis=1)
    return Chords(segments, np.full(len(angles), -1 / circle.radius))


def _divided(
    circles: Sequence[Circle], segments: Points, points: Points, same: float, widest: float
) -> list[Angles]:
    """Angles of the points that divide each circle, ascending, rad."""
    found = []
    for k, circle in enumerate(circles):
        others = [*circles[:k], *circles[k + 1 :]]
        pairs = [_crossings(circle, segments, same), *(_met(circle, each, same) for each in others)]
        nearby = [points, _feet(circle, segments), *(c.at(_towards(c, circle)) for c in others)]
        first = [
            _near(circle, points, same),
            *_with_middles(pairs),
            _near(circle, np.concatenate(nearby), CLOSE * circle.radius),
        ]
        distinct = _distinct(np.concatenate(first), same / circle.radius)
        found.append(_filled(distinct, widest))
    for _ in range(MAX_ARRANGEMENT_ROUNDS):
        before = sum(map(len, found))
        for k, circle in enumerate(circles):
            there = [c.at(at) for c, at in zip(circles, found, strict=True) if c is not circle]
            cut_off = _cut_off(circle, found[k], np.concatenate([points, *there]), same)
            found[k] = np.sort(_distinct([*found[k], *cut_off], same / circle.radius))
        if sum(map(len, found)) == before:
            break
    return found


def _near(circle: Circle, points: Points, reach: float) -> Angles:
    """Angles of points within reach [m] of a circle."""
    return circle.angle(points[np.abs(circle.beyond(points)) <= reach])


def _feet(circle: Circle, segments: Points) -> Points:
    """Points of segments that are nearest to a circle's centre, shape (segment, 2)."""
    along, _ = nearest(circle.centre[None], segments)
    return segments[:, 0] + along[0][:, None] * (segments[:, 1] - segments[:, 0])


def _towards(circle: Circle, other: Circle) -> Angles:
    """Angles of the points of a circle that are nearest to and farthest from another."""
    angle = circle.angle(other.centre)
    return np.array([angle, angle + np.pi])


def _crossings(circle: Circle, segments: Points, same: float) -> Real:
    """Angles at which segments meet a circle, shape (segment, 2); NaN where they do not."""
    start, run = segments[:, 0], segments[:, 1] - segments[:, 0]
    length = np.linalg.norm(run, axis=1)
    run = run / length[:, None]
    foot = ((circle.centre - start) * run).sum(axis=1)
    off = np.linalg.norm(start + foot[:, None] * run - circle.centre, axis=1)
    half = np.sqrt(np.maximum(circle.radius**2 - off**2, 0.0))
    half[np.abs(off - circle.radius) <= same] = 0.0
    at = foot[:, None] + half[:, None] * [-1, 1]
    met = (off <= circle.radius + same)[:, None] & (at >= -same) & (at <= length[:, None] + same)
    angle = circle.angle(start[:, None] + at[:, :, None] * run[:, None])
    return np.where(met, angle, np.nan)


def _met(circle: Circle, other: Circle, same: float) -> Real:
    """Angles on a circle at which it meets another, shape (1, 2); NaN where it does not."""
    r, R = circle.radius, other.radius
    far = float(np.linalg.norm(other.centre - circle.centre))
    towards = circle.angle(other.centre)
    if abs(far - r - R) <= same or abs(r - R - far) <= same:
        return np.full((1, 2), towards)
    if abs(R - r - far) <= same:
        return np.full((1, 2), (towards + np.pi) % (2 * np.pi))
    if not abs(r - R) < far < r + R:
        return np.full((1, 2), np.nan)
    aside = np.arccos((far**2 + r**2 - R**2) / (2 * far * r))
    return (towards + np.array([[-aside, aside]])) % (2 * np.pi)


def _with_middles(pairs: Sequence[Real]) -> tuple[Angles, Angles]:
    """All angles, then those half-way between two at which one shape meets a circle.

    The half-way points keep a chord of the circle from lying along a segment or along a chord of
    another circle.
    """
    every = np.concatenate(pairs)
    middle = every[every[:, 0] != every[:, 1]].mean(axis=1)
    both = np.concatenate([middle, (middle + np.pi) % (2 * np.pi)])
    return every[~np.isnan(every)], both[~np.isnan(both)]


def _distinct(angles: Sequence[float] | Angles, same: float) -> Angles:
    """Angles in order, without those that equal an earlier one on the circle."""
    kept: list[float] = []
    for angle in angles:
        gap = np.abs(np.array(kept) - angle)
        if (np.minimum(gap, 2 * np.pi - gap) > 2 * same).all():
            kept.append(float(angle))
    return np.array(kept)


def _filled(angles: Angles, widest: float) -> Angles:
    """Angles, ascending, with evenly spaced ones added in gaps wider than `widest`."""
    start = np.sort(angles) if len(angles) else np.zeros(1)
    gaps = np.diff(np.append(start, start[0] + 2 * np.pi))
    parts = np.ceil(gaps / widest - 1e-9).astype(int)
    every = [at + gap * np.arange(n) / n for at, gap, n in zip(start, gaps, parts, strict=True)]
    return np.sort(np.concatenate(every) % (2 * np.pi))


def _cut_off(circle: Circle, angles: Angles, points: Points, same: float) -> Angles:
    """Angles of points between a circle's chords and its arcs, or on the chords."""
    at, beyond = circle.angle(points), circle.beyond(points)
    number = np.searchsorted(angles, at, side="right") - 1
    start = angles[number]
    half = (angles[(number + 1) % len(angles)] - start) % (2 * np.pi) / 2
    from_middle = (at - start - half + np.pi) % (2 * np.pi) - np.pi
    chord = circle.radius * np.cos(half) / np.cos(from_middle)
    return at[(beyond < -same) & (circle.radius + beyond > chord - 2 * same)]
