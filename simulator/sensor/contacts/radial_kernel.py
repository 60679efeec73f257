"""Compiled deflection around one round indenter on skins with tension, far from any edge."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...compiled import compiled
from ...models.mechanics.foam_law import FoamTables, stress

MAX_NEWTON_STEPS = 100
STILL = 1e-9
"""Largest last step of a deflection, over the largest deflection."""


@compiled()
def radial_deflections(
    foam: FoamTables,
    tension: float,
    step: float,
    nodes: int,
    limit: int,
    curvature: float,
    levels: NDArray,
) -> NDArray:
    """Deflection under an indenter of each depth, m, shape (level, node).

    T / r d/dr (r dw/dr) = p(w / d) outside the contact, by finite volumes between equidistant radii
    0, step, 2 step ...; nodes lie in the middles. limit: nodes under the end of the indenter; the
    skin follows it where it meets it. curvature: radius of the end, m; inf if it is flat. levels:
    depths, m, ascending.
    """
    w, found = np.zeros(nodes), np.zeros((len(levels), nodes))
    fixed, most = 1, min(limit, nodes - 2)
    for level in range(len(levels)):
        while True:
            for k in range(fixed):
                w[k] = _surface(k, step, curvature, levels[level])
            _solve(w, fixed, foam, tension, step, fixed == limit)
            under = _surface(fixed, step, curvature, levels[level])
            if fixed >= most or w[fixed] >= under:
                break
            fixed += 1
        for k in range(nodes):
            found[level, k] = w[k]
    return found


@compiled()
def _surface(k: int, step: float, curvature: float, depth: float) -> float:
    """Depth of the indenter's surface at a node, m."""
    return depth - ((k + 0.5) * step) ** 2 / (2 * curvature)


@compiled()
def _solve(
    w: NDArray, fixed: int, foam: FoamTables, tension: float, step: float, edge: bool
) -> None:
    """Newton's method for the nodes from `fixed` on, in place; the node before has its depth.

    edge: True if an edge of the indenter, half a step before the first of these, has that depth.
    """
    nodes, thickness = len(w), foam.thickness
    above, change, slope = np.zeros(nodes), np.zeros(nodes), np.zeros(nodes)
    for _ in range(MAX_NEWTON_STEPS):
        moved = 0.0
        for k in range(fixed, nodes):
            strain = min(max(w[k] / thickness, 0.0), foam.greatest)
            ahead, behind = min(strain + 1e-6, foam.greatest), max(strain - 1e-6, 0.0)
            slope[k] = (stress(foam, ahead) - stress(foam, behind)) / (ahead - behind) / thickness
            area = (k + 0.5) * step * step
            inner = tension * k * (2.0 if edge and k == fixed else 1.0)
            outer = tension * (k + 1) if k + 1 < nodes else 0.0
            pull = inner * (w[k - 1] - w[k]) - area * stress(foam, strain)
            if k + 1 < nodes:
                pull += outer * (w[k + 1] - w[k])
            diagonal = inner + outer + area * slope[k]
            if k > fixed:
                diagonal -= inner * above[k - 1]
                pull += inner * change[k - 1]
            above[k], change[k] = outer / diagonal, pull / diagonal
        for k in range(nodes - 1, fixed - 1, -1):
            if k + 1 < nodes:
                change[k] += above[k] * change[k + 1]
            new = max(w[k] + change[k], 0.0)
            moved = max(moved, abs(new - w[k]))
            w[k] = new
        if moved <= STILL * w[fixed - 1]:
            return


@compiled()
def stacked_rings(rise: NDArray, step: float, flat: int, radii: NDArray, rises: NDArray) -> None:
    """Discs of each level whose rises add up to those at the nodes, into `radii` and `rises`.

    rise: at nodes, shape (level, node). Each ring between discs takes its mean; rings are chosen so
    that the product of a ring's area and the fall of the rise over it is the same for all. A flat
    indenter is the first disc. radii: m, shape (level, disc).
    """
    levels, nodes = rise.shape
    discs = radii.shape[1]
    weight = np.zeros(nodes)
    for level in range(levels):
        total = 0.0
        for node in range(flat, nodes):
            before = rise[level, node - 1] if node > 0 else rise[level, 0]
            total += np.sqrt(max(before - rise[level, node], 0.0) * (node + 0.5))
            weight[node] = total
        first, node = 0, flat
        if flat > 0:
            radii[level, 0], rises[level, 0], first = flat * step, rise[level, 0], 1
        for disc in range(first, discs):
            until = total * (disc + 1 - first) / (discs - first)
            content, area = 0.0, 0.0
            last = disc == discs - 1
            while node < nodes and (last or weight[node] <= until or area == 0.0):
                content += rise[level, node] * (node + 0.5)
                area += node + 0.5
                node += 1
            radii[level, disc] = node * step
            rises[level, disc] = content / area if area > 0.0 else 0.0
        for disc in range(discs - 1):
            rises[level, disc] -= rises[level, disc + 1]
