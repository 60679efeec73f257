"""A flat mesh that conforms to chords, made to conform to the arcs over them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from simulator.domain.arcs import Arcs, on_arcs
from simulator.domain.arrangement import Arrangement
from simulator.domain.region import Domain, Points
from simulator.domain.triangles import edges_of
from simulator.planar import nearest


def bent(mesh: Domain, drawing: Arrangement, curvature: Points, same: float) -> Domain:
    """The mesh with its points between the ends of chords moved onto the arcs.

    drawing: pieces that edges of the mesh make up, points nearer to them than `same` [m] lie on
    them. curvature: of the arc over each piece in 1/m, 0 where it is straight.
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
