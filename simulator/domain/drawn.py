"""A skin drawn by its outline: everything that the mesh conforms to, meshed and labelled."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from simulator.contour import curves, section
from simulator.domain.arrangement import Arrangement, arranged
from simulator.domain.mesher import meshed
from simulator.domain.region import Domain, Numbers, Points, corners, labelled, sharp_touches
from simulator.foam import pixel_lines
from simulator.planar import inside, sides
from simulator.press import Press
from simulator.scene import Contact, Scene

SAME = 1e-8
"""What is nearer than this times the skin's longer side is at one place."""


def drawn(scene: Scene, press: Press, size: float, creases: Sequence[Points]) -> Domain:
    """See `simulator.domain.domain`."""
    skin = scene.skin
    around = curves(skin)
    marks = np.array([end for contact in scene.contacts for end in contact.ends(skin)])
    segments = np.concatenate([*map(sides, around), *inner_segments(scene, press, creases)])
    same = SAME * max(skin.length, skin.width)
    drawing = _clipped(arranged(segments, same, marks), around)
    curve, middle = _on_boundary(drawing, around)
    mesh = meshed(drawing.points, drawing.pieces, curve, size)

    def under(contact: Contact) -> Numbers:
        along = section(contact, skin)
        there = (curve == along.curve) & (along.start < middle) & (middle < along.stop)
        return mesh.lines[:, there[mesh.piece]]

    foils = {contact.name: under(contact) for contact in scene.contacts}
    return labelled(scene, press, mesh.p, mesh.t, foils)


def inner_segments(scene: Scene, press: Press, creases: Sequence[Points]) -> list[Points]:
    """Lines between pixels, edges of touches and `creases`, each of shape (segment, end, 2)."""
    x, y = pixel_lines(scene, 0), pixel_lines(scene, 1)
    return [
        np.array([[(line, y[0]), (line, y[-1])] for line in x[1:-1]]).reshape(-1, 2, 2),
        np.array([[(x[0], line), (x[-1], line)] for line in y[1:-1]]).reshape(-1, 2, 2),
        *(sides(corners(scene, touch)) for touch in sharp_touches(press)),
        *(np.stack([crease[:-1], crease[1:]], axis=1) for crease in creases),
    ]


def _clipped(whole: Arrangement, around: Sequence[Points]) -> Arrangement:
    """The boundary, and the pieces within the outline and in none of its holes."""
    middle = whole.points[whole.pieces].mean(axis=1).T
    outline, *holes = around
    kept = inside(outline, middle)
    for hole in holes:
        kept &= ~inside(hole, middle)
    kept |= whole.segment < sum(map(len, around))
    return Arrangement(whole.points, whole.pieces[kept], whole.segment[kept])


def _on_boundary(drawing: Arrangement, around: Sequence[Points]) -> tuple[Numbers, Points]:
    """The closed curve that each piece is part of, -1 inside, and how far along it, m.

    Both of shape (piece,); the latter is that of the piece's middle.
    """
    each = np.concatenate([sides(curve) for curve in around])
    lengths = np.linalg.norm(each[:, 1] - each[:, 0], axis=1)
    of_curve = np.repeat(np.arange(len(around)), [len(curve) for curve in around])
    before = np.concatenate([np.cumsum(lengths[of_curve == k]) for k in range(len(around))])
    segment = np.minimum(drawing.segment, len(each) - 1)
    middle = drawing.points[drawing.pieces].mean(axis=1)
    at = (before - lengths)[segment] + np.linalg.norm(middle - each[segment, 0], axis=1)
    return np.where(drawing.segment < len(each), of_curve[segment], -1), at
