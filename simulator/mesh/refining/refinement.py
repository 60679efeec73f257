"""Refines marked triangles: red, green and blue refinement by longest edges.

A marked triangle has all its edges halved and becomes four of its own shape (red). Then every
triangle of which an edge is halved has its longest edge halved too, and becomes two (green), three
(blue) or four. Angles stay bounded from below, since an edge that is cut alone is always the
longest: C. Carstensen, Constructive Approximation 20 (2004) 549-564.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import Integer, Mask
from ..arcs import on_arcs
from ..domain import Domain, Points
from ..edge_numbering import edges_of, halves


def refined(domain: Domain, marked: ArrayLike) -> Domain:
    """Domain with the marked triangles, by number, cut in four.

    Their neighbours are cut as needed. New points on arcs lie on these. Labels, foils, seams and
    arcs are inherited.
    """
    return _cut(domain, edges_of(domain.t)[1][:, np.asarray(marked, dtype=np.int64)])


def arcs_halved(domain: Domain, marked: ArrayLike) -> Domain:
    """Domain with the arcs of the marked triangles, by number, cut in two.

    Otherwise as `refined`.
    """
    some = np.asarray(marked, dtype=np.int64)
    own = edges_of(domain.t)[1][:, some]
    return _cut(domain, own[domain.curvature[:, some] != 0])


def _cut(domain: Domain, marked: Integer) -> Domain:
    """Domain with these edges halved, by number, and the longest of cut triangles."""
    edges, of_triangle = edges_of(domain.t)
    turn = _longest_first(domain.p, domain.t)
    t = np.take_along_axis(domain.t, turn, axis=0)
    of_triangle = np.take_along_axis(of_triangle, turn, axis=0)
    halved = _halved(of_triangle, marked)
    middle = np.full(edges.shape[1], -1, dtype=np.int64)
    middle[halved] = domain.p.shape[1] + np.arange(np.count_nonzero(halved))
    start, stop = (domain.p[:, end] for end in edges[:, halved])
    new = (start + stop) / 2
    if len(domain.arcs.curvature):
        new = on_arcs(start, stop, domain.arcs.of(edges)[halved])
    children, parent = _split(t, middle[of_triangle])
    order = np.argsort(parent, kind="stable")
    parent = parent[order]
    return replace(
        domain,
        p=np.hstack([domain.p, new]),
        t=np.sort(children[:, order], axis=0),
        pixel=domain.pixel[parent],
        covered=domain.covered[:, parent],
        foils={name: halves(lines, edges, middle) for name, lines in domain.foils.items()},
        seams=halves(domain.seams, edges, middle),
        arcs=domain.arcs.halved(edges, middle),
    )


def _longest_first(p: Points, t: Integer) -> Integer:
    """Order of corners, shape (3, cell): the longest edge joins the first two."""
    a, b, c = (p[:, corner] for corner in t)
    squared = np.array([((u - v) ** 2).sum(axis=0) for u, v in ((a, b), (b, c), (c, a))])
    return (np.arange(3)[:, None] + squared.argmax(axis=0)) % 3


def _halved(of_triangle: Integer, marked: Integer) -> Mask:
    """True for edges to halve, shape (edge,).

    These are the marked ones, and the longest edge of every triangle with a halved edge.
    """
    halved = np.zeros(of_triangle.max() + 1, dtype=bool)
    halved[marked] = True
    while True:
        cut = halved[of_triangle]
        lacking = cut.any(axis=0) & ~cut[0]
        if not lacking.any():
            return halved
        halved[of_triangle[0, lacking]] = True


def _split(t: Integer, middle: Integer) -> tuple[Integer, Integer]:
    """Triangles after cuts, shape (3, child), and the number of the parent of each.

    middle: points in the middle of the edges 0-1, 1-2, 2-0, -1 where there is none.
    """
    (a, b, c), (ab, bc, ca) = t, middle
    first, second, third = middle >= 0
    cases = [
        (~first, [(a, b, c)]),
        (first & ~second & ~third, [(a, ab, c), (ab, b, c)]),
        (first & second & ~third, [(a, ab, c), (ab, b, bc), (ab, bc, c)]),
        (first & ~second & third, [(ab, b, c), (a, ab, ca), (ab, c, ca)]),
        (second & third, [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]),
    ]
    children = [np.stack(child)[:, case] for case, parts in cases for child in parts]
    parents = [np.flatnonzero(case) for case, parts in cases for _ in parts]
    return np.concatenate(children, axis=1), np.concatenate(parents)
