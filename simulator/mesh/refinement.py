"""Local refinement of triangles, until predicted errors are small enough.

A marked triangle has all its edges halved and becomes four of its own shape (red). Then every
triangle of which an edge is halved has its longest edge halved too, and becomes two (green), three
(blue) or four. Angles stay bounded from below, since an edge that is cut alone is always the
longest: C. Carstensen, Constructive Approximation 20 (2004) 549-564.

Every triangle has a part of each error. A child with the fraction A of its area keeps the fraction
A^(p + 1) of that part where the field is smooth, p being the order of the elements. At a corner,
where the field varies as r^a, the child there keeps the fraction A^a.

Triangles are kept upright however their arcs bend: edges are turned, then arcs halved.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Integer, Mask, Real
from ..sweeps import ToleranceError
from .arcs import edge_numbers, edges_of, halves, mapped, on_arcs
from .corner_exponents import WHOLE
from .domain import Domain, Points, areas

LEFT = 0.7
"""Fraction of the sufficient error that lies in triangles that are not marked."""
STRENGTH = 0.12
"""Part of Rs and Cp due to a corner, over (1 - a)^2.

It is that with triangles as large as the skin.
"""
MAX_GRADING_ROUNDS = 16
MAX_GROWTH = 8.0
"""Largest ratio of triangles after and before; predictions beyond are unreliable."""


def graded(
    mesh: Domain, parts: Real, enough: float, order: int, exponents: Real
) -> tuple[Domain, Real]:
    """Mesh with triangles halved until about `enough` is left of each error.

    Also returns the predicted parts of its triangles. parts: those of each triangle in some errors,
    shape (error, triangle). order: that of the elements. exponents: at points, as from
    `corner_exponents`. Raises what `finer` raises.
    """
    pixel, found, most = mesh.pixel, mesh, MAX_GROWTH * mesh.t.shape[1]
    for _ in range(MAX_GRADING_ROUNDS):
        large = parts[parts.sum(axis=1) > enough]
        if not len(large) or found.t.shape[1] > most:
            break
        marked = [fewest(each, each.sum() - LEFT * enough) for each in large]
        numbers = np.arange(found.t.shape[1])
        cut = finer(replace(found, pixel=numbers), np.unique(np.concatenate(marked)))
        parts = parts[:, cut.pixel] * _kept(found, cut, order, exponents)
        pixel = pixel[cut.pixel]
        found = replace(cut, pixel=pixel)
    return found, parts


def corner_parts(mesh: Domain, exponents: Real) -> Real:
    """Approximate part of each corner in Rs and Cp on a coarse mesh.

    It needs no solution. Shape (corner, triangle): the part is spread over the triangles at the
    corner. On 20 random skins half of the corners had between a third and three times that.
    exponents: at points, as from `corner_exponents`.
    """
    area, corners = areas(mesh.p, mesh.t), np.flatnonzero(exponents < 1 - WHOLE)
    parts = np.zeros((len(corners), len(area)))
    for part, corner in zip(parts, corners.tolist(), strict=True):
        there, power = (mesh.t == corner).any(axis=0), float(exponents[corner])
        size = area[there].mean() / area.sum()
        part[there] = STRENGTH * (1 - power) ** 2 * size**power / np.count_nonzero(there)
    return parts


def fewest(parts: Real, target: float) -> Integer:
    """Fewest triangles whose parts sum to `target`, by number, ascending.

    There is at least one.
    """
    order = np.argsort(-parts, kind="stable")
    return np.sort(order[: int(np.searchsorted(np.cumsum(parts[order]), target)) + 1])


def _kept(before: Domain, after: Domain, order: int, exponents: Real) -> Real:
    """Predicted fraction that each triangle keeps of its parent's part, (triangle,)."""
    area, whole = areas(after.p, after.t), areas(before.p, before.t)
    of_corners = np.append(exponents, np.inf)[np.minimum(after.t, len(exponents))].min(axis=0)
    return np.minimum(area / whole[after.pixel], 1.0) ** np.minimum(of_corners, order + 1)


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


STEPS = 6
"""Number of parts of an edge; triangles are checked at the ends of the parts."""
MIN_AREA_RATIO = 1e-3
"""Smallest area of a bent triangle over that of the straight one, but at corners.

Where a circle touches a line, it falls linearly from 1 to 0 at the corner.
"""
ROUNDING = 1e-6
MAX_UNTANGLING_ROUNDS = 10


def finer(mesh: Domain, marked: ArrayLike) -> Domain:
    """Mesh with the marked triangles, by number, cut in four.

    Raises what `without_inversions` raises.
    """
    return without_inversions(refined(mesh, marked))


def without_inversions(mesh: Domain) -> Domain:
    """Mesh in which arcs turn no triangle over, or nearly.

    Raises ToleranceError where triangles would be halved without end.
    """
    if not len(mesh.arcs.curvature):
        return mesh
    for _ in range(MAX_UNTANGLING_ROUNDS):
        if not _inverted(mesh).size:
            return mesh
        mesh = _turned(mesh)
        mesh = arcs_halved(mesh, _inverted(mesh))
    raise ToleranceError("circles of the skin or of the press are too near to other lines to mesh")


def _inverted(mesh: Domain) -> Integer:
    """Triangles that their arcs turn over, and those that lie upon a neighbour."""
    curvature = mesh.curvature
    bent = np.flatnonzero(curvature.any(axis=0))
    turned = bent[_upright(mesh, mesh.t[:, bent], curvature[:, bent]) < MIN_AREA_RATIO]
    return np.union1d(turned, _folded(mesh))


def _folded(mesh: Domain) -> Integer:
    """Smaller one of each two triangles on the same side of their common edge."""
    edges, of_triangle = edges_of(mesh.t)
    order = np.argsort(of_triangle.ravel(), kind="stable")
    edge, triangle = of_triangle.ravel()[order], np.tile(np.arange(mesh.t.shape[1]), 3)[order]
    first = np.flatnonzero(edge[:-1] == edge[1:])
    pair, (start, stop) = triangle[[first, first + 1]], edges[:, edge[first]]
    apex = mesh.t[:, pair].sum(axis=0) - start - stop
    run = mesh.p[:, stop] - mesh.p[:, start]
    side = _cross(run[:, None], mesh.p[:, apex] - mesh.p[:, start][:, None])
    same = np.flatnonzero(side[0] * side[1] > 0)
    return np.unique(pair[np.abs(side[:, same]).argmin(axis=0), same])


def _upright(mesh: Domain, t: Integer, curvature: Real) -> Real:
    """Smallest area ratio of a bent and the straight triangle, shape (triangle,).

    t: of ascending points. At corners, where the ratio may be 0, MIN_AREA_RATIO is added. It is -1
    for a straight triangle without area.
    """
    a, b = (each.ravel() / STEPS for each in np.meshgrid(*2 * [np.arange(STEPS + 1.0)]))
    within = a + b < 1 + ROUNDING
    a, b = a[within], b[within]
    cornered = np.maximum(np.maximum(a, b), 1 - a - b) > 1 - ROUNDING
    _, along, across = mapped(mesh.p, t, curvature, np.stack([a, b]))
    straight = _area(mesh, t)[:, None]
    flat = np.full((t.shape[1], len(a)), -1.0)
    part = np.divide(_cross(along, across), straight, out=flat, where=straight != 0)
    return (part + (MIN_AREA_RATIO + ROUNDING) * cornered).min(axis=1)


def _turned(mesh: Domain) -> Domain:
    """Mesh with edges of tangled triangles turned within pairs if both improve."""
    for triangle in _inverted(mesh).tolist():
        edges, of_triangle = edges_of(mesh.t)
        fixed = np.zeros(edges.shape[1], dtype=bool)
        fixed[edge_numbers(mesh.seams, edges)] = True
        best, chosen = 0.0, mesh
        for number in of_triangle[:, triangle][~fixed[of_triangle[:, triangle]]]:
            pair = np.flatnonzero((of_triangle == number).any(axis=0))
            beyond = np.sort(mesh.t[:, pair].sum(axis=0) - edges[:, number].sum())
            if edge_numbers(beyond[:, None], edges)[0] >= 0:
                continue
            found = _with_diagonal(mesh, pair, edges[:, number], beyond)
            gain = _gain(mesh, found, pair)
            if gain > best:
                best, chosen = gain, found
        mesh = chosen
    return mesh


def _gain(mesh: Domain, other: Domain, pair: Integer) -> float:
    """Improvement of the worst of a pair of triangles in another mesh.

    Infinite if they no longer lie upon each other, minus infinity if they then do or one is flat.
    """
    before, after = (np.abs(_area(each, each.t[:, pair])) for each in (mesh, other))
    if after.sum() > before.sum() * (1 + ROUNDING) or after.min() < ROUNDING * before.max():
        return -np.inf
    if after.sum() < before.sum() * (1 - ROUNDING):
        return np.inf
    worst = [_upright(m, m.t[:, pair], m.curvature[:, pair]).min() for m in (other, mesh)]
    return float(worst[0] - worst[1])


def _with_diagonal(mesh: Domain, pair: Integer, edge: Integer, beyond: Integer) -> Domain:
    """Mesh with the edge between `beyond` in place of the edge between two triangles."""
    t = mesh.t.copy()
    t[:, pair] = np.sort([edge, np.full(2, beyond[0]), np.full(2, beyond[1])], axis=0)
    return replace(mesh, t=t)


def _area(mesh: Domain, t: Integer) -> Real:
    """Twice the area of straight triangles, negative where they run clockwise, m²."""
    origin, first, second = (mesh.p[:, each] for each in t)
    return _cross(first - origin, second - origin)


def _cross(u: Real, v: Real) -> Real:
    return u[0] * v[1] - u[1] * v[0]
