"""Tables of round indenters on skins with tension: depth, and rises of c around, by force."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ...arrays import Real
from ...models.mechanics.foam_law import FoamTables
from ...scene.parts import Skin

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


def radial_table(
    skin: Skin, foam: FoamTables, radius: float, curvature: float, reach: float
) -> RadialTable:
    """Table of an indenter of a radius with a spherical end of a radius of curvature; m.

    The first is infinite for a sphere, the second for a flat end. reach: distance from the contact
    without influence, m.
    """
    from .radial_kernel import radial_deflections, stacked_rings

    mechanics = skin.foam.mechanics
    assert mechanics is not None
    greatest, thickness = foam.greatest, foam.thickness
    patch = float(min(radius, np.sqrt(2 * curvature * greatest * thickness)))
    spread = np.sqrt(mechanics.tension * thickness / mechanics.young)
    step = max(min(spread, patch) / FINE, (patch + reach) / MAX_NODES)
    limit = int(np.ceil(patch / step))
    step = patch / limit
    nodes = int(np.ceil((patch + reach) / step)) + 2
    flat = limit if np.isinf(curvature) else 0
    depth = _levels(foam) * thickness
    w = radial_deflections(foam, mechanics.tension, step, nodes, limit, curvature, depth)
    strain = np.minimum(w / thickness, greatest)
    ring = 2 * np.pi * step**2 * (np.arange(nodes) + 0.5)
    rise = skin.foam.factor_at(strain) - 1
    radii, rises = np.zeros((len(depth), DISCS)), np.zeros((len(depth), DISCS))
    stacked_rings(rise, step, flat, radii, rises)
    radii[0] = radii[1]  # without depth there are no rings
    counts = (rise > NEGLIGIBLE * rise[:, :1]).sum(axis=1)
    force = mechanics.elastic.stress(strain) @ ring
    return RadialTable(depth, force, radii, rises, counts * step)


def _levels(foam: FoamTables) -> Real:
    """Strains of the levels, from 0: denser where the cells buckle and where they close."""
    greatest, t = foam.greatest, np.linspace(0.0, 1.0, LEVELS + 1)
    if not foam.elastomer:
        return t * greatest
    close = foam.densified * (1 - (1 - greatest / foam.densified) ** t)
    return np.unique(np.concatenate([greatest * t**1.5, close]).clip(0.0, greatest))
