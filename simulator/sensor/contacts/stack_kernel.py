"""Stacks of discs under contacts on the cells of a grid, compiled."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...compiled import compiled
from .cell_samples import SAMPLES
from .patch_kernel import FACTOR, Box, box_cells, covered_part, patch_box
from .shared_patches import joint_minus_sum, overlap_box

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
