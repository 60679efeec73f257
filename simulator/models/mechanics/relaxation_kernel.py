"""Compiled relaxation of the membrane on a lattice of nodes under rigid bodies and pressure."""

from __future__ import annotations

from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from ...arrays import Integer, Real
from ...compiled import compiled
from .foam_law import FoamTables

MIN_ARM = 1e-3
"""Smallest distance of a node from a body's edge, over a step, and smallest area, over a node's."""
BALANCED = 1e-4
"""Largest relative difference of a body's force at the end of the relaxation."""


class Nodes(NamedTuple):
    """Nodes at x and y, m, `steps` apart.

    right, up: conductance of each to the next along x and y, 0 at the last; load: area; all over
    the tension, shape (row, column). tension: N/m.
    """

    x: NDArray[np.float64]
    y: NDArray[np.float64]
    right: NDArray[np.float64]
    up: NDArray[np.float64]
    load: NDArray[np.float64]
    steps: tuple[float, float]
    tension: float


class Bodies(NamedTuple):
    """Rigid bodies of one press that push the skin.

    boxes: left, right, bottom and top in m, shape (body, 4). radius: of discs in m, 0 of
    rectangles. curvature: radius of a spherical end, m; inf if flat. depth: of each middle, m;
    of a body by force the largest that it may have. force: N, nan for a body of given depth.
    """

    boxes: Real
    radius: Real
    curvature: Real
    depth: Real
    force: Real

    @classmethod
    def by_depth(cls, boxes: Real, radius: Real, depth: Real) -> Self:
        """Flat bodies of given depth."""
        count = len(depth)
        return cls(boxes, radius, np.full(count, np.inf), depth, np.full(count, np.nan))

    def some(self, which: Integer | list[int]) -> Self:
        """Those of some numbers."""
        return self._make(each[which] for each in self)


@compiled()
def relaxed_in_place(
    w: NDArray,
    pressure: NDArray,
    nodes: Nodes,
    foam: FoamTables,
    bodies: Bodies,
    relaxed: float,
    still: float,
    most: int,
) -> int:  # pragma: no cover
    """Relax deflections w to the minimum of energy under a pressure and rigid bodies.

    Successive over-relaxation by the factor `relaxed`, with one Newton step at each node and
    projection onto the surface of bodies, until a sweep moves no node by more than `still`. After
    each sweep a body by force moves towards the balance of its force, at most to the foam's largest
    strain; beyond that the foam's stress goes on as a line. Returns the number of sweeps, or `most`
    + 1 if `most` sweeps do not suffice. w, still: m. pressure: Pa, at nodes. The depths of `bodies`
    become those reached; arms of `nodes` end at the edges of flat bodies, see `cut_at_edges`.
    """
    rows, columns = w.shape
    right, up, load, depth = nodes.right, nodes.up, nodes.load, bodies.depth
    cut_at_edges(nodes, bodies)
    spans = _spans(nodes, bodies)
    least, by = np.zeros((rows, columns)), np.full((rows, columns), -1, np.int64)
    total = _conductance_sums(right, up)
    per_metre = (len(foam.stresses) - 1) / (foam.greatest * foam.thickness)
    law, last = foam.stresses, len(foam.stresses) - 2
    by_force = False
    for body in range(len(depth)):
        by_force |= not np.isnan(bodies.force[body])
    for sweep in range(most):
        if by_force or sweep == 0:
            _place(least, by, spans, nodes, bodies, False)
        moved = 0.0
        for i in range(rows):
            left = 0.0
            for j in range(columns):
                own = w[i, j]
                if load[i, j] == 0.0:
                    left = own
                    continue
                at = own * per_metre
                step = min(int(at), last)
                slope = law[step + 1] - law[step]
                pull = load[i, j] * (pressure[i, j] - law[step] - (at - step) * slope)
                if j + 1 < columns:
                    pull += right[i, j] * (w[i, j + 1] - own)
                if i > 0:
                    pull += up[i - 1, j] * (w[i - 1, j] - own)
                if i + 1 < rows:
                    pull += up[i, j] * (w[i + 1, j] - own)
                gain = relaxed / (total[i, j] + load[i, j] * slope * per_metre)
                if j > 0:  # last: this neighbour has just moved, all others are known earlier
                    pull += right[i, j - 1] * (left - own)
                left = max(own + gain * pull, least[i, j])
                moved = max(moved, abs(left - own))
                w[i, j] = left
        balanced = True
        if by_force:
            shift, balanced = _balance(w, pressure, least, by, spans, nodes, foam, bodies, relaxed)
            moved = max(moved, shift)
        if moved <= still and balanced:
            return sweep + 1
    return most + 1


@compiled()
def _conductance_sums(right: NDArray, up: NDArray) -> NDArray:  # pragma: no cover
    """Sum of the conductances of each node to its neighbours, over the tension."""
    rows, columns = right.shape
    total = np.empty((rows, columns))
    for i in range(rows):
        for j in range(columns):
            total[i, j] = right[i, j] + up[i, j]
            if j > 0:
                total[i, j] += right[i, j - 1]
            if i > 0:
                total[i, j] += up[i - 1, j]
    return total


@compiled()
def _spans(nodes: Nodes, bodies: Bodies) -> NDArray:  # pragma: no cover
    """First and end of the rows, then of the columns, of nodes within each body's box."""
    spans = np.empty((len(bodies.depth), 4), np.int64)
    for body in range(len(spans)):
        left, right, bottom, top = bodies.boxes[body]
        spans[body, 0] = np.searchsorted(nodes.y, bottom)
        spans[body, 1] = np.searchsorted(nodes.y, top, "right")
        spans[body, 2] = np.searchsorted(nodes.x, left)
        spans[body, 3] = np.searchsorted(nodes.x, right, "right")
    return spans


@compiled()
def _place(
    least: NDArray, by: NDArray, spans: NDArray, nodes: Nodes, bodies: Bodies, flat: bool
) -> None:  # pragma: no cover
    """Smallest deflection under each body, m, and the number of the deepest body; -1 for none.

    flat: True to place flat bodies alone.
    """
    for body in range(len(spans)):
        for i in range(spans[body, 0], spans[body, 1]):
            for j in range(spans[body, 2], spans[body, 3]):
                least[i, j], by[i, j] = 0.0, -1
    for body in range(len(spans)):
        box, radius, curvature = bodies.boxes[body], bodies.radius[body], bodies.curvature[body]
        if flat and curvature < np.inf:
            continue
        x, y = (box[0] + box[1]) / 2, (box[2] + box[3]) / 2
        for i in range(spans[body, 0], spans[body, 1]):
            for j in range(spans[body, 2], spans[body, 3]):
                far = (nodes.x[j] - x) ** 2 + (nodes.y[i] - y) ** 2
                if radius > 0.0 and far > radius * radius:
                    continue
                under = bodies.depth[body] - far / (2 * curvature)
                if under > least[i, j]:
                    least[i, j], by[i, j] = under, body


@compiled()
def cut_at_edges(nodes: Nodes, bodies: Bodies) -> None:  # pragma: no cover
    """Let the arms between nodes end at the edges of flat bodies, in place.

    Where an edge lies between two nodes, the conductance becomes that of an arm from the shallower
    node to the edge. The area between the middle of this arm and that between the nodes goes from
    the shallower node to the deeper one.
    """
    rows, columns = nodes.load.shape
    least, by = np.zeros((rows, columns)), np.full((rows, columns), -1, np.int64)
    _place(least, by, _spans(nodes, bodies), nodes, bodies, True)
    area, along, across = np.ones((rows, columns)), bodies.boxes[:, :2], bodies.boxes[:, 2:]
    _shorten(least, by, along, across, bodies.radius, nodes.x, nodes.y, nodes.right, area)
    least, by, right, areas = least.T, by.T, nodes.up.T, area.T
    _shorten(least, by, across, along, bodies.radius, nodes.y, nodes.x, right, areas)
    for i in range(rows):
        for j in range(columns):
            nodes.load[i, j] *= max(area[i, j], MIN_ARM)


@compiled()
def _shorten(
    least: NDArray,
    by: NDArray,
    own: NDArray,
    other: NDArray,
    radius: NDArray,
    x: NDArray,
    y: NDArray,
    right: NDArray,
    area: NDArray,
) -> None:  # pragma: no cover
    """Shorten arms along one axis, x, that end at an edge, see `cut_at_edges`.

    by: number of the body above each node. own, other: sides of each along x and across it. area:
    of nodes, over that of one away from edges.
    """
    rows, columns = least.shape
    for i in range(rows):
        for j in range(columns - 1):
            if least[i, j] == least[i, j + 1]:
                continue
            ahead = least[i, j + 1] > least[i, j]
            body = int(by[i, j + 1] if ahead else by[i, j])
            low, high = _across(own[body], other[body], radius[body], y[i])
            gap = low - x[j] if ahead else x[j + 1] - high
            part = min(max(gap / (x[j + 1] - x[j]), MIN_ARM), 1.0)
            right[i, j] /= part
            area[i, j] += (part - 1) / 2 if ahead else (1 - part) / 2
            area[i, j + 1] += (1 - part) / 2 if ahead else (part - 1) / 2


@compiled()
def _across(
    own: NDArray, other: NDArray, radius: float, at: float
) -> tuple[float, float]:  # pragma: no cover
    """Start and end of a body on a line, m; inf and -inf if they do not meet.

    own: its sides along that line. other: those across. at: position of the line, between the
    latter.
    """
    if not other[0] <= at <= other[1]:
        return np.inf, -np.inf
    if radius == 0.0:
        return own[0], own[1]
    middle, off = (own[0] + own[1]) / 2, at - (other[0] + other[1]) / 2
    half = np.sqrt(max(radius * radius - off * off, 0.0))
    return middle - half, middle + half


@compiled()
def _balance(
    w: NDArray,
    pressure: NDArray,
    least: NDArray,
    by: NDArray,
    spans: NDArray,
    nodes: Nodes,
    foam: FoamTables,
    bodies: Bodies,
    relaxed: float,
) -> tuple[float, bool]:  # pragma: no cover
    """Move each body by force, and the skin on it, towards the balance of its force.

    Returns the largest movement, m, and True if all forces are balanced.
    """
    moved, balanced, depth = 0.0, True, bodies.depth
    deepest = foam.greatest * foam.thickness
    for body in range(len(depth)):
        if np.isnan(bodies.force[body]):
            continue
        span = spans[body]
        force, stiffness = _returned(body, w, pressure, least, by, span, nodes, foam)
        lack = bodies.force[body] - force
        new = min(max(depth[body] + relaxed * lack / stiffness, 0.0), deepest)
        near = abs(lack) <= BALANCED * bodies.force[body]
        balanced &= near or new == deepest == depth[body]
        shift, depth[body] = new - depth[body], new
        moved = max(moved, abs(shift))
        for i in range(span[0], span[1]):
            for j in range(span[2], span[3]):
                if by[i, j] == body and w[i, j] <= least[i, j]:
                    w[i, j] = max(w[i, j] + shift, 0.0)
    return moved, balanced


@compiled()
def _returned(
    body: int,
    w: NDArray,
    pressure: NDArray,
    least: NDArray,
    by: NDArray,
    span: NDArray,
    nodes: Nodes,
    foam: FoamTables,
) -> tuple[float, float]:  # pragma: no cover
    """Force that foam and skins return to a body, N, and its derivative by the depth, N/m.

    The derivative takes the skin beside the body for fixed.
    """
    rows, columns = w.shape
    force, stiffness = 0.0, 0.0
    for i in range(span[0], span[1]):
        for j in range(span[2], span[3]):
            if by[i, j] != body or w[i, j] > least[i, j]:
                continue
            own = w[i, j]
            p, slope = _pressure(foam, own)
            force += nodes.load[i, j] * (p - pressure[i, j])
            stiffness += nodes.load[i, j] * slope
            for side in range(4):
                k, m = i + (side == 0) - (side == 1), j + (side == 2) - (side == 3)
                if not (0 <= k < rows and 0 <= m < columns):
                    continue
                conductance = nodes.right[i, min(j, m)] if k == i else nodes.up[min(i, k), j]
                force += conductance * (own - w[k, m])
                if by[k, m] != body or w[k, m] > least[k, m]:
                    stiffness += conductance
    return nodes.tension * force, nodes.tension * max(stiffness, 1e-30)


@compiled()
def _pressure(foam: FoamTables, w: float) -> tuple[float, float]:  # pragma: no cover
    """Pressure of the foam at a deflection, Pa, and its derivative, Pa/m."""
    law = foam.stresses
    per_metre = (len(law) - 1) / (foam.greatest * foam.thickness)
    at = w * per_metre
    step = min(int(at), len(law) - 2)
    slope = law[step + 1] - law[step]
    return law[step] + (at - step) * slope, slope * per_metre
