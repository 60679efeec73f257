"""Overlapping patches of point contacts, compiled: where they overlap, and the rise there."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...compiled import compiled
from ...models.mechanics.foam_law import FoamTables, rise_at, strain_under, stress
from ...press.cell_kernel import Box
from .patch_kernel import (
    ADDED,
    CURVATURE,
    FACTOR,
    FORCE,
    HEIGHT,
    RADIUS,
    ROUNDING,
    WIDTH,
    Stacks,
    X,
    Y,
    patch_box,
)

MAX_BITS = 62


@compiled()
def overlap_box(contacts: NDArray, by: int, stacks: Stacks) -> Box:
    """Rectangle around all overlaps of patches, m; infinite and reversed if there is none.

    Capacitances to earth of ADDED touches and spread contacts add, and have none.
    """
    left, right, bottom, top = np.inf, -np.inf, np.inf, -np.inf
    if by == ADDED:
        return left, right, bottom, top
    for k in range(len(contacts)):
        for m in range(k):
            own = stacks.radii[k, stacks.discs[k] - 1]
            other = stacks.radii[m, stacks.discs[m] - 1]
            if not _meet(contacts[k], contacts[m], own, other):
                continue
            one, two = patch_box(contacts[k], own), patch_box(contacts[m], other)
            left, right = min(left, max(one[0], two[0])), max(right, min(one[1], two[1]))
            bottom, top = min(bottom, max(one[2], two[2])), max(top, min(one[3], two[3]))
    return left, right, bottom, top


@compiled()
def _meet(one: NDArray, other: NDArray, radius: float, its: float) -> bool:
    """True if two patches may overlap: discs do, boxes around them do if one is a rectangle."""
    if radius > 0.0 and its > 0.0:
        far = (one[X] - other[X]) ** 2 + (one[Y] - other[Y]) ** 2
        return far < (radius + its) ** 2 * (1 - ROUNDING)
    first, second = patch_box(one, radius), patch_box(other, its)
    wide = min(first[1], second[1]) - max(first[0], second[0])
    high = min(first[3], second[3]) - max(first[2], second[2])
    return wide > ROUNDING * (first[1] - first[0]) and high > ROUNDING * (first[3] - first[2])


@compiled()
def _strain_at(
    contact: NDArray, strain: float, foam: FoamTables, at_x: float, at_y: float
) -> float:
    """Strain that a contact alone causes at a position, `strain` in its middle."""
    along, across = at_x - contact[X], at_y - contact[Y]
    if contact[WIDTH] > 0.0:
        under = abs(along) <= contact[WIDTH] / 2 and abs(across) <= contact[HEIGHT] / 2
        return strain if under else 0.0
    far = along * along + across * across
    if far > contact[RADIUS] * contact[RADIUS]:
        return 0.0
    return max(strain - far / (2 * contact[CURVATURE] * foam.thickness), 0.0)


@compiled()
def all_flat(contacts: NDArray) -> bool:
    """True if the rise is the same wherever the same patches overlap, of at most 62 contacts."""
    for contact in contacts:
        if contact[WIDTH] == 0.0 and contact[CURVATURE] < np.inf:
            return False
    return len(contacts) <= MAX_BITS


@compiled()
def contacts_over(
    contacts: NDArray, by: int, strain: NDArray, foam: FoamTables, at_x: float, at_y: float
) -> int:
    """Contacts that press a position, one bit each; of more than 62, all bits."""
    if len(contacts) > MAX_BITS:
        return -1
    found = 0
    for k in range(len(contacts)):
        deepest = 1.0 if by == FACTOR else strain[k]
        if _strain_at(contacts[k], deepest, foam, at_x, at_y) > 0.0:
            found |= 1 << k
    return found


@compiled()
def joint_minus_sum(
    contacts: NDArray, by: int, stacks: Stacks, foam: FoamTables, at_x: float, at_y: float
) -> tuple[float, bool]:
    """Rise under all patches at a position minus the sum of their own; True if it was limited.

    Pressures of forces add, of depths the deeper counts, and factors multiply.
    """
    deepest, pressure, apart, joint, under = 0.0, 0.0, 0.0, 1.0, 0
    for k in range(len(contacts)):
        if by == FACTOR:
            if _strain_at(contacts[k], 1.0, foam, at_x, at_y) > 0.0:
                rise, under = stacks.rises[k, 0], under + 1
                joint, apart = joint * (1 + rise), apart + rise
            continue
        depth = _strain_at(contacts[k], stacks.strain[k], foam, at_x, at_y)
        if depth > 0.0:
            deepest, under = max(deepest, depth), under + 1
            apart += rise_at(foam, depth)
            pressure += stress(foam, depth) if by == FORCE else 0.0
    if under < 2:
        return 0.0, False
    if by == FACTOR:
        return joint - 1 - apart, False
    limited = by == FORCE and pressure > foam.closed
    if by == FORCE:
        deepest = strain_under(foam, min(pressure, foam.closed))
    return rise_at(foam, deepest) - apart, limited
