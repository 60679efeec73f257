"""Compiled relaxation of the electrode skins' membrane under indenters pushed by forces."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...compiled import compiled
from .membrane_nodes import WindowNodes

BALANCED = 1e-4
"""Largest relative difference of an indenter's force at the end of the relaxation."""


class MembraneLaw(NamedTuple):
    """Foam and skins. stress: of the foam, Pa, at equidistant strains from 0, of which there are
    `per_metre` for each m of deflection. tension: N/m. deepest: largest deflection, m."""

    stress: NDArray[np.float64]
    per_metre: float
    tension: float
    deepest: float


class RigidBodies(NamedTuple):
    """Indenters.

    shapes: of each x, y, half width, half height, radius (0 for a rectangle) and curvature radius,
    m. area: skin under each flat indenter, m²; 0 for a sphere. band: see `_returned`. force: N, NaN
    for an indenter of fixed depth. depth: of each indenter's middle, m; changed by the relaxation.
    """

    shapes: NDArray[np.float64]
    area: NDArray[np.float64]
    band: float
    force: NDArray[np.float64]
    depth: NDArray[np.float64]


@compiled()
def relaxed_under(
    w: NDArray,
    pressure: NDArray,
    nodes: WindowNodes,
    law: MembraneLaw,
    bodies: RigidBodies,
    relaxed: float,
    still: float,
    most: int,
) -> int:
    """Relax deflections w to the minimum of energy under a pressure and rigid indenters.

    Successive over-relaxation as in `relaxation_kernel.relaxed_in_place`; after each sweep every
    indenter moves towards the balance of its force, at most to `law.deepest`. Returns the number of
    sweeps, or `most` + 1 if `most` do not suffice. pressure: Pa, at nodes. Others: see there.
    """
    rows, columns = w.shape
    right, up, load, depth = nodes.right, nodes.up, nodes.load, bodies.depth
    least, by = np.zeros((rows, columns)), np.full((rows, columns), -1, np.int64)
    total, spans = np.empty((rows, columns)), np.empty((len(depth), 4), np.int64)
    for i in range(rows):
        for j in range(columns):
            total[i, j] = right[i, j] + up[i, j]
            total[i, j] += right[i, j - 1] if j > 0 else 0.0
            total[i, j] += up[i - 1, j] if i > 0 else 0.0
    for body in range(len(depth)):
        middle_x, middle_y, wide, high = bodies.shapes[body, :4]
        spans[body, 0] = np.searchsorted(nodes.y, middle_y - high)
        spans[body, 1] = np.searchsorted(nodes.y, middle_y + high, "right")
        spans[body, 2] = np.searchsorted(nodes.x, middle_x - wide)
        spans[body, 3] = np.searchsorted(nodes.x, middle_x + wide, "right")
    for sweep in range(most):
        _place(least, by, spans, nodes, bodies)
        moved = 0.0
        for i in range(rows):
            for j in range(columns):
                if load[i, j] == 0.0:
                    continue
                own = w[i, j]
                returned, slope = _pressure(law, own)
                pull = load[i, j] * (pressure[i, j] - returned)
                if j + 1 < columns:
                    pull += right[i, j] * (w[i, j + 1] - own)
                if j > 0:
                    pull += right[i, j - 1] * (w[i, j - 1] - own)
                if i > 0:
                    pull += up[i - 1, j] * (w[i - 1, j] - own)
                if i + 1 < rows:
                    pull += up[i, j] * (w[i + 1, j] - own)
                gain = relaxed / (total[i, j] + load[i, j] * slope)
                new = min(max(own + gain * pull, least[i, j]), law.deepest)
                moved = max(moved, abs(new - own))
                w[i, j] = new
        balanced = True
        for body in range(len(depth)):
            if np.isnan(bodies.force[body]):
                continue
            force, stiffness = _returned(
                body, w, least, by, spans[body], pressure, nodes, law, bodies
            )
            lack = bodies.force[body] - force
            new = min(max(depth[body] + relaxed * lack / stiffness, 0.0), law.deepest)
            near = abs(lack) <= BALANCED * bodies.force[body]
            balanced &= near or new == law.deepest == depth[body]
            shift, depth[body] = new - depth[body], new
            moved = max(moved, abs(shift))
            for i in range(spans[body, 0], spans[body, 1]):
                for j in range(spans[body, 2], spans[body, 3]):
                    if by[i, j] == body and w[i, j] <= least[i, j]:
                        w[i, j] = max(w[i, j] + shift, 0.0)
        if moved <= still and balanced:
            return sweep + 1
    return most + 1


@compiled()
def _place(
    least: NDArray, by: NDArray, spans: NDArray, nodes: WindowNodes, bodies: RigidBodies
) -> None:
    """Smallest deflection under each indenter, m, and the number of the indenter; -1 for none."""
    for body in range(len(spans)):
        for i in range(spans[body, 0], spans[body, 1]):
            for j in range(spans[body, 2], spans[body, 3]):
                least[i, j], by[i, j] = 0.0, -1
    for body in range(len(spans)):
        x, y, _, _, radius, curvature = bodies.shapes[body]
        for i in range(spans[body, 0], spans[body, 1]):
            for j in range(spans[body, 2], spans[body, 3]):
                far = (nodes.x[j] - x) ** 2 + (nodes.y[i] - y) ** 2
                if radius > 0.0 and far > radius * radius:
                    continue
                under = bodies.depth[body] - far / (2 * curvature)
                if under > least[i, j]:
                    least[i, j], by[i, j] = under, body


@compiled()
def _returned(
    body: int,
    w: NDArray,
    least: NDArray,
    by: NDArray,
    span: NDArray,
    pressure: NDArray,
    nodes: WindowNodes,
    law: MembraneLaw,
    bodies: RigidBodies,
) -> tuple[float, float]:
    """Force that foam and skins return to an indenter, N, and its derivative by the depth, N/m.

    The derivative takes the skin beside the indenter for fixed. A flat indenter also bears the foam
    beside its edge, up to the middle of each arm to the next node. band: share of these halves that
    is foam; the halves of different arms overlap.
    """
    rows, columns = w.shape
    steps, tension, area = nodes.steps, law.tension, bodies.area[body]
    force, stiffness = 0.0, 0.0
    for i in range(span[0], span[1]):
        for j in range(span[2], span[3]):
            if by[i, j] != body or w[i, j] > least[i, j]:
                continue
            own = w[i, j]
            if area == 0.0:
                p, slope = _pressure(law, own)
                force += tension * nodes.load[i, j] * (p - pressure[i, j])
                stiffness += tension * nodes.load[i, j] * slope
            for side in range(4):
                k, m = i + (side == 0) - (side == 1), j + (side == 2) - (side == 3)
                if not (0 <= k < rows and 0 <= m < columns):
                    continue
                under = by[k, m] == body and w[k, m] <= least[k, m]
                if under and area > 0.0:
                    continue
                along = k == i
                conductance = nodes.right[i, min(j, m)] if along else nodes.up[min(i, k), j]
                force += tension * conductance * (own - w[k, m])
                if under or conductance == 0.0:
                    continue
                stiffness += tension * conductance
                if area > 0.0:
                    arm = steps[1] / conductance if along else steps[0] / conductance
                    p, slope = _pressure(law, (3 * own + w[k, m]) / 4)
                    half = bodies.band * min(arm, steps[0] if along else steps[1]) / 2
                    half *= steps[1] if along else steps[0]
                    force += half * p
                    stiffness += half * slope
    if area > 0.0:
        p, slope = _pressure(law, bodies.depth[body])
        force += area * p
        stiffness += area * slope
    return force, max(stiffness, 1e-30)


@compiled()
def _pressure(law: MembraneLaw, w: float) -> tuple[float, float]:
    """Pressure of the foam at a deflection, Pa, and its derivative, Pa/m."""
    at = w * law.per_metre
    step = min(int(at), len(law.stress) - 2)
    slope = law.stress[step + 1] - law.stress[step]
    return law.stress[step] + (at - step) * slope, slope * law.per_metre
