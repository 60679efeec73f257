"""Divides pieces of a drawing, straight or arcs, into lines of requested length."""

from __future__ import annotations

import numpy as np

from ...arrays import Integer, Real
from ...scene.planar import Points
from ..arcs import on_arcs
from .sizing import Sizing

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
