"""Stacks of discs under contacts on the cells of a grid, compiled."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...compiled import compiled
from .cell_samples import SAMPLES
from .foam_kernel import rise_at, strain_under, stress
from .patch_kernel import (
    ADDED,
    CURVATURE,
    FACTOR,
    FORCE,
    HEIGHT,
    RADIUS,
    ROUNDING,
    WIDTH,
    Box,
    X,
    Y,
    box_cells,
    covered_part,
    patch_box,
)

MAX_BITS = 62
FAINT = 1e-12
"""Rises below this are rounding errors."""


@compiled()
def cells_of_stacks(
    values: NDArray,
    counts: NDArray,
    by: int,
    radii: NDArray,
    stacked: NDArray,
    discs: NDArray,
    strain: NDArray,
    limited: NDArray,
    law: NDArray,
    relative: NDArray,
    strains: NDArray,
    x: NDArray,
    y: NDArray,
    cut: NDArray,
    mask: NDArray,
    part: NDArray,
) -> tuple[NDArray, NDArray, NDArray]:  # pragma: no cover
    """Cells, rises and starts of presses, each a number of contacts with stacks of discs.

    radii [m], stacked: radius of each disc, 0 for the contact's rectangle, and the rise that it
    adds, shape (press, contact, disc). discs: their number; 0 leaves a contact out. strain: in the
    middle of each contact. Where patches of forces or depths overlap, a correction is sampled;
    `limited` becomes True where that needs more than the largest strain.
    """
    presses, rows, columns = values.shape[0], len(y) - 1, len(x) - 1
    cells, rises = np.empty(presses * 16, np.int64), np.empty(presses * 16)
    starts = np.zeros(presses + 1, np.int64)
    unpressed = 1.0 if by == FACTOR else 0.0
    total, found = np.full((rows, columns), unpressed), 0
    for press in range(presses):
        left, right, bottom, top = columns, 0, rows, 0
        for k in range(counts[press]):
            for disc in range(discs[press, k]):
                radius, rise = radii[press, k, disc], stacked[press, k, disc]
                box = patch_box(values[press, k], radius)
                span = box_cells(box, x, y)
                left, right = min(left, span[0]), max(right, span[1])
                bottom, top = min(bottom, span[2]), max(top, span[3])
                for i in range(span[2], span[3]):
                    for j in range(span[0], span[1]):
                        covered = covered_part(box, radius, i, j, x, y, cut, mask)
                        if by == FACTOR:
                            total[i, j] *= (1 - covered) + (1 + rise) * covered
                        else:
                            total[i, j] += rise * covered
        if by < FACTOR and counts[press] > 1:
            limited[press] |= _add_overlaps(
                values[press],
                counts[press],
                by,
                radii[press],
                stacked[press],
                discs[press],
                strain[press],
                law,
                relative,
                strains,
                x,
                y,
                cut,
                mask,
                part,
                total,
            )
        if found + max(right - left, 0) * max(top - bottom, 0) > len(cells):
            cells, rises = _longer(cells, rises, found, 2 * len(cells) + rows * columns)
        for i in range(bottom, top):
            for j in range(left, right):
                rise = total[i, j] - unpressed
                total[i, j] = unpressed
                if abs(rise) > FAINT:
                    cells[found], rises[found] = i * columns + j, rise
                    found += 1
        starts[press + 1] = found
    return cells[:found], rises[:found], starts


@compiled()
def _longer(
    cells: NDArray, rises: NDArray, found: int, more: int
) -> tuple[NDArray, NDArray]:  # pragma: no cover
    new_cells, new_rises = np.empty(more, np.int64), np.empty(more)
    for k in range(found):
        new_cells[k], new_rises[k] = cells[k], rises[k]
    return new_cells, new_rises


@compiled()
def _add_overlaps(
    contacts: NDArray,
    count: int,
    by: int,
    radii: NDArray,
    stacked: NDArray,
    discs: NDArray,
    strain: NDArray,
    law: NDArray,
    relative: NDArray,
    strains: NDArray,
    x: NDArray,
    y: NDArray,
    cut: NDArray,
    mask: NDArray,
    part: NDArray,
    total: NDArray,
) -> bool:  # pragma: no cover
    """Correct the summed rises of cells where patches overlap; True if one was limited.

    The correction is sampled in a rectangle around all overlaps.
    """
    left, right, bottom, top = overlap_box(contacts, count, by, radii, discs)
    if left >= right:
        return False
    limited, span = False, box_cells((left, right, bottom, top), x, y)
    for i in range(span[2], span[3]):
        for j in range(span[0], span[1]):
            within = (
                max(left, x[j]),
                min(right, x[j + 1]),
                max(bottom, y[i]),
                min(top, y[i + 1]),
            )
            change, beyond = _overlap_rise(
                contacts,
                count,
                strain,
                stacked,
                by,
                law,
                relative,
                strains,
                within,
                i,
                j,
                x,
                y,
                cut,
                mask,
            )
            limited |= beyond
            if part[i, j] > 0.0:
                area = (within[1] - within[0]) * (within[3] - within[2])
                cell = (x[j + 1] - x[j]) * (y[i + 1] - y[i]) * part[i, j]
                total[i, j] += change * area / cell
    return limited


@compiled()
def overlap_box(
    contacts: NDArray, count: int, by: int, radii: NDArray, discs: NDArray
) -> Box:  # pragma: no cover
    """Rectangle around all overlaps of patches, m; infinite and reversed if there is none.

    Capacitances to earth of ADDED touches and spread contacts add, and have none.
    """
    left, right, bottom, top = np.inf, -np.inf, np.inf, -np.inf
    if by == ADDED:
        return left, right, bottom, top
    for k in range(count):
        for m in range(k):
            own, other = radii[k, discs[k] - 1], radii[m, discs[m] - 1]
            if not _meet(contacts[k], contacts[m], own, other):
                continue
            one, two = patch_box(contacts[k], own), patch_box(contacts[m], other)
            left, right = min(left, max(one[0], two[0])), max(right, min(one[1], two[1]))
            bottom, top = min(bottom, max(one[2], two[2])), max(top, min(one[3], two[3]))
    return left, right, bottom, top


@compiled()
def _meet(one: NDArray, other: NDArray, radius: float, its: float) -> bool:  # pragma: no cover
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
    contact: NDArray, strain: float, law: NDArray, at_x: float, at_y: float
) -> float:  # pragma: no cover
    """Strain that a contact alone causes at a position, `strain` in its middle."""
    along, across = at_x - contact[X], at_y - contact[Y]
    if contact[WIDTH] > 0.0:
        under = abs(along) <= contact[WIDTH] / 2 and abs(across) <= contact[HEIGHT] / 2
        return strain if under else 0.0
    far = along * along + across * across
    if far > contact[RADIUS] * contact[RADIUS]:
        return 0.0
    return max(strain - far / (2 * contact[CURVATURE] * law[5]), 0.0)


@compiled()
def _overlap_rise(
    contacts: NDArray,
    count: int,
    strain: NDArray,
    stacked: NDArray,
    by: int,
    law: NDArray,
    relative: NDArray,
    strains: NDArray,
    within: Box,
    i: int,
    j: int,
    x: NDArray,
    y: NDArray,
    cut: NDArray,
    mask: NDArray,
) -> tuple[float, bool]:  # pragma: no cover
    """Rise under all patches minus the sum of their own, averaged over a rectangle in a cell.

    True if a strain was limited.
    """
    own, total, limited = cut[i, j], 0.0, False
    for k in range(SAMPLES):
        at_y = within[2] + (k + 0.5) / SAMPLES * (within[3] - within[2])
        row = min(int((at_y - y[i]) / (y[i + 1] - y[i]) * SAMPLES), SAMPLES - 1)
        for m in range(SAMPLES):
            at_x = within[0] + (m + 0.5) / SAMPLES * (within[1] - within[0])
            column = min(int((at_x - x[j]) / (x[j + 1] - x[j]) * SAMPLES), SAMPLES - 1)
            if own >= 0 and not mask[own, row, column]:
                continue
            change, beyond = joint_minus_sum(
                contacts, count, strain, stacked, by, law, relative, strains, at_x, at_y
            )
            limited |= beyond
            total += change
    return total / SAMPLES**2, limited


@compiled()
def all_flat(contacts: NDArray, count: int) -> bool:  # pragma: no cover
    """True if the rise is the same wherever the same patches overlap, of at most 62 contacts."""
    for k in range(count):
        if contacts[k, WIDTH] == 0.0 and contacts[k, CURVATURE] < np.inf:
            return False
    return count <= MAX_BITS


@compiled()
def contacts_over(
    contacts: NDArray, count: int, strain: NDArray, by: int, law: NDArray, at_x: float, at_y: float
) -> int:  # pragma: no cover
    """Contacts that press a position, one bit each; of more than 62, all bits."""
    if count > MAX_BITS:
        return -1
    found = 0
    for k in range(count):
        deepest = 1.0 if by == FACTOR else strain[k]
        if _strain_at(contacts[k], deepest, law, at_x, at_y) > 0.0:
            found |= 1 << k
    return found


@compiled()
def joint_minus_sum(
    contacts: NDArray,
    count: int,
    strain: NDArray,
    stacked: NDArray,
    by: int,
    law: NDArray,
    relative: NDArray,
    strains: NDArray,
    at_x: float,
    at_y: float,
) -> tuple[float, bool]:  # pragma: no cover
    """Rise under all patches at a position minus the sum of their own; True if it was limited.

    Pressures of forces add, of depths the deeper counts, and factors multiply.
    """
    deepest, pressure, apart, joint, under = 0.0, 0.0, 0.0, 1.0, 0
    for k in range(count):
        if by == FACTOR:
            if _strain_at(contacts[k], 1.0, law, at_x, at_y) > 0.0:
                joint, apart, under = joint * (1 + stacked[k, 0]), apart + stacked[k, 0], under + 1
            continue
        depth = _strain_at(contacts[k], strain[k], law, at_x, at_y)
        if depth > 0.0:
            deepest, under = max(deepest, depth), under + 1
            apart += rise_at(law, relative, depth)
            pressure += stress(law, depth) if by == FORCE else 0.0
    if under < 2:
        return 0.0, False
    if by == FACTOR:
        return joint - 1 - apart, False
    limited = by == FORCE and pressure > law[6]
    if by == FORCE:
        deepest = strain_under(law, strains, min(pressure, law[6]))
    return rise_at(law, relative, deepest) - apart, limited
