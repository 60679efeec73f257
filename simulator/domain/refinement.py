"""Finer triangles where they are asked for: red, green and blue refinement by longest edges.

A marked triangle has all its edges halved, and becomes four of its own shape (red). Then every
triangle of which an edge is halved has its longest edge halved too, and becomes two (green), three
(blue) or four. Angles stay bounded from below, since only longest edges are cut alone:
C. Carstensen, Constructive Approximation 20 (2004) 549-564.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from simulator.domain.region import Domain, Numbers, Points
from simulator.domain.triangles import edges_of, halves


def refined(domain: Domain, marked: ArrayLike) -> Domain:
    """The domain with the marked triangles, by number, cut in four, and those beside as needed.

    Sides stay straight: what was a polygon stays the same one. Labels and foils are inherited.
    """
    t = _by_longest_edge(domain.p, domain.t)
    edges, of_triangle = edges_of(t)
    halved = _halved(of_triangle, np.asarray(marked, dtype=np.int64))
    middle = np.full(edges.shape[1], -1, dtype=np.int64)
    middle[halved] = domain.p.shape[1] + np.arange(np.count_nonzero(halved))
    p = np.hstack([domain.p, domain.p[:, edges[:, halved]].mean(axis=1)])
    children, parent = _split(t, middle[of_triangle])
    order = np.argsort(parent, kind="stable")
    parent = parent[order]
    return replace(
        domain,
        p=p,
        t=np.sort(children[:, order], axis=0),
        pixel=domain.pixel[parent],
        covered=domain.covered[:, parent],
        foils={name: halves(lines, edges, middle) for name, lines in domain.foils.items()},
    )


def _by_longest_edge(p: Points, t: Numbers) -> Numbers:
    """Triangles turned such that their longest edge leads from corner 0 to 1."""
    a, b, c = (p[:, corner] for corner in t)
    squared = np.array([((u - v) ** 2).sum(axis=0) for u, v in ((a, b), (b, c), (c, a))])
    turn = squared.argmax(axis=0)
    return np.take_along_axis(t, (np.arange(3)[:, None] + turn) % 3, axis=0)


def _halved(of_triangle: Numbers, marked: Numbers) -> NDArray[np.bool_]:
    """Edges to halve: those of marked triangles, and the longest beside each, shape (edge,)."""
    halved = np.zeros(of_triangle.max() + 1, dtype=bool)
    halved[of_triangle[:, marked]] = True
    while True:
        cut = halved[of_triangle]
        lacking = cut.any(axis=0) & ~cut[0]
        if not lacking.any():
            return halved
        halved[of_triangle[0, lacking]] = True


def _split(t: Numbers, middle: Numbers) -> tuple[Numbers, Numbers]:
    """The triangles within others, shape (3, child), and the number of the one around each.

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
