"""Tables of round indenters on skins with tension: depth, and rises of c around, by force."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Real
from ...compiled import compiled
from ...models.mechanics.foam_law import FoamTables
from ...models.mechanics.lattice_presses import relax
from ...models.mechanics.relaxation_kernel import Bodies, Nodes
from ...models.mechanics.skin_lattice import Lattice

FINE = 16
"""Steps of the radius per length in which the skins spread a press."""
MAX_NODES = 4000
LEVELS = 80
DISCS = 12
NEGLIGIBLE = 3e-3
"""Rise of c, over the largest one, beyond which an indenter has no influence."""


class RadialTable(NamedTuple):
    """One indenter at depths from 0 to the largest.

    depth: m, shape (level,). force: N. radii [m], rises: discs whose rises add up to those around
    the indenter, shape (level, disc). reach: radius of its influence, m, shape (level,).
    """

    depth: Real
    force: Real
    radii: Real
    rises: Real
    reach: Real

    def each(self) -> Iterator[RadialTable]:
        """Each of several tables that are stacked along a first axis."""
        return (RadialTable(*arrays) for arrays in zip(*self, strict=True))


_LEVEL, _DISCS = np.zeros((0, 2)), np.zeros((0, 2, DISCS))
NO_TABLES = RadialTable(_LEVEL, _LEVEL, _DISCS, _DISCS, _LEVEL)
"""No indenter: stacked tables of none."""


def radial_table(lattice: Lattice, radius: float, curvature: float) -> RadialTable:
    """Table of an indenter of a radius with a spherical end of a radius of curvature, far from any
    edge of the skin of a lattice; m.

    The first is infinite for a sphere, the second for a flat end. Nodes are rings around it: a
    lattice of one row. Raises ToleranceError if the relaxation does not converge.
    """
    law, tension = lattice.law, lattice.mechanics.tension
    reach, thickness = lattice.reach(law.deepest), law.thickness
    patch = float(min(radius, np.sqrt(2 * curvature * law.deepest)))
    spread = lattice.mechanics.spread(thickness)
    step = max(min(spread, patch) / FINE, (patch + reach) / MAX_NODES)
    limit = int(np.ceil(patch / step))
    flat = limit if np.isinf(curvature) else 0
    step = patch / (limit if flat else limit - 0.5)  # the rim of a sphere lies on a node
    count = int(np.ceil((patch + reach) / step)) + 2
    rings = np.arange(count, dtype=np.float64) + 0.5
    area = 2 * np.pi * step**2 * rings
    arms = 2 * np.pi * (rings + 0.5)[None]
    arms[0, -1] = 0.0
    depth = _levels(law) * thickness
    w = np.zeros((len(depth), count))
    body = Bodies.by_depth(np.array([[-patch, patch, -patch, patch]]), np.array([patch]), depth[:1])
    body = body._replace(curvature=np.array([curvature]))
    at, none = (step * rings, np.zeros(1)), np.zeros_like(arms)
    for level in range(1, len(depth)):
        own = body._replace(depth=depth[[level]])
        nodes = Nodes(*at, arms.copy(), none, area[None] / tension, (step, step), tension)
        w[level] = w[level - 1]
        relax(lattice, nodes, own, w[level : level + 1], none)
    rise = lattice.rises(w)
    radii, rises = np.zeros((len(depth), DISCS)), np.zeros((len(depth), DISCS))
    stacked_rings(rise, step, flat, radii, rises)
    radii[0] = radii[1]  # without depth there are no rings
    counts = (rise > NEGLIGIBLE * rise[:, :1]).sum(axis=1)
    force = lattice.mechanics.elastic.stress(w / thickness) @ area
    return RadialTable(depth, force, radii, rises, counts * step)


def _levels(law: FoamTables) -> Real:
    """Strains of the levels, from 0: denser where the cells buckle and where they close."""
    greatest, t = law.greatest, np.linspace(0.0, 1.0, LEVELS + 1)
    if not law.elastomer:
        return t * greatest
    close = law.densified * (1 - (1 - greatest / law.densified) ** t)
    return np.unique(np.concatenate([greatest * t**1.5, close]).clip(0.0, greatest))


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
