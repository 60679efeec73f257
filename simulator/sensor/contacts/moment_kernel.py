"""Stacks of discs under contacts on coarse cells so that moments are kept, compiled.

Each patch is divided into points, and each point is shared between three cells along each axis, as
`cell_spreading` shares fine cells: integrals of polynomials of degree 2 are kept.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...compiled import compiled
from ...models.mechanics.foam_law import FoamTables
from ...press.batch import PressBatch
from ...press.cell_kernel import CELLS_AT_FIRST, FAINT, add_point, empty_batch, moved_to_batch
from ...press.pixels import SAMPLES, GridCells
from .patch_kernel import (
    FINE,
    Fault,
    Stacks,
    X,
    Y,
    area_on_skin,
    of_press,
    patch_box,
    within_skin,
)
from .stack_kernel import all_flat, contacts_over, joint_minus_sum, overlap_box
from .winkler_kernel import winkler_stacks

PARTS = 4
"""Number of points along the side of a cell, at least."""
MIN_ANGLES = 5
"""Smallest number of points on a ring: it keeps polynomials of degree 4."""


@compiled()
def pressed_moments(
    values: NDArray,
    counts: NDArray,
    by: int,
    foam: FoamTables,
    cells: GridCells,
    grid: tuple[int, int],
) -> tuple[PressBatch, NDArray, NDArray, Fault]:
    """Presses by `winkler_stacks` and `moments_of_stacks`, and further results of the first.

    It is one call: most of a single press is the cost of a call.
    """
    stacks, limited, patches, fault = winkler_stacks(values, counts, by, foam, cells)
    if fault[2] != FINE:
        return empty_batch(len(values), 0), limited, patches, fault
    batch = moments_of_stacks(values, counts, by, stacks, limited, foam, cells, grid)
    return batch, limited, patches, fault


@compiled()
def moments_of_stacks(
    values: NDArray,
    counts: NDArray,
    by: int,
    stacks: Stacks,
    limited: NDArray,
    foam: FoamTables,
    cells: GridCells,
    grid: tuple[int, int],
) -> PressBatch:
    """Presses on a coarse grid (rows, columns) of a rectangular skin.

    cells: of any grid. Others: see `cells_of_stacks`.
    """
    presses, (rows, columns) = len(values), grid
    length, width = cells.x[-1], cells.y[-1]
    batch, found = empty_batch(presses, CELLS_AT_FIRST * presses), 0
    total = np.zeros((rows, columns))
    for press in range(presses):
        left, right, bottom, top = columns, 0, rows, 0
        for k in range(counts[press]):
            discs = stacks.discs[press, k]
            if discs == 0:
                continue
            contact, outer = values[press, k], stacks.radii[press, k, discs - 1]
            box = patch_box(contact, outer)
            left = min(left, max(int(box[0] / length * columns) - 1, 0))
            right = max(right, min(int(box[1] / length * columns) + 2, columns))
            bottom = min(bottom, max(int(box[2] / width * rows) - 1, 0))
            top = max(top, min(int(box[3] / width * rows) + 2, rows))
            if outer == 0.0:
                _add_rectangle(total, contact, stacks.rises[press, k, 0], length, width)
                continue
            mean, inner = 0.0, 0.0
            for disc in range(discs):
                mean += stacks.rises[press, k, disc]
            whole = within_skin(contact, outer, cells)
            for disc in range(discs):
                radius, scale = stacks.radii[press, k, disc], 1.0
                if not whole:
                    scale = area_on_skin(contact, radius, cells)
                    if disc > 0:
                        scale -= area_on_skin(contact, inner, cells)
                _add_ring(total, contact, mean, inner, radius, scale, whole, length, width)
                mean, inner = mean - stacks.rises[press, k, disc], radius
        if counts[press] > 1:
            contacts, own = values[press, : counts[press]], of_press(stacks, press)
            limited[press] |= _add_overlaps(contacts, by, own, foam, total, length, width)
        batch, found = moved_to_batch(total, (left, right, bottom, top), 0.0, FAINT, batch, found)
        batch.starts[press + 1] = found
    return PressBatch(batch.cells[:found], batch.rises[:found], batch.starts)


@compiled()
def _add_ring(
    total: NDArray,
    contact: NDArray,
    rise: float,
    inner: float,
    outer: float,
    area: float,
    whole: bool,
    length: float,
    width: float,
) -> None:
    """Share a ring of one rise. area: of the ring on the skin, m², unless it is on it entirely."""
    rows, columns = total.shape
    if rise == 0.0 or outer <= inner:
        return
    along, across = columns / length, rows / width
    densest = PARTS * max(along, across)
    rings = int((outer - inner) * densest) + 1
    step = (outer - inner) / rings
    scale = 1.0
    if not whole:
        there = 0.0
        for ring in range(rings):
            low = inner + ring * step
            radius = np.sqrt((low * low + (low + step) ** 2) / 2)
            count = max(int(2 * np.pi * radius * densest) + 1, MIN_ANGLES)
            own = np.pi * step * (2 * low + step) / count
            for k in range(count):
                angle = 2 * np.pi * (k + 0.5) / count
                at_x = contact[X] + radius * np.cos(angle)
                at_y = contact[Y] + radius * np.sin(angle)
                if 0.0 <= at_x <= length and 0.0 <= at_y <= width:
                    there += own
        if there == 0.0:
            return
        scale = area / there
    for ring in range(rings):
        low = inner + ring * step
        radius = np.sqrt((low * low + (low + step) ** 2) / 2)
        count = max(int(2 * np.pi * radius * densest) + 1, MIN_ANGLES)
        amount = scale * rise * np.pi * step * (2 * low + step) / count * along * across
        turn_x, turn_y = np.cos(2 * np.pi / count), np.sin(2 * np.pi / count)
        to_x, to_y = radius * np.cos(np.pi / count), radius * np.sin(np.pi / count)
        for _ in range(count):
            at_x, at_y = contact[X] + to_x, contact[Y] + to_y
            to_x, to_y = to_x * turn_x - to_y * turn_y, to_x * turn_y + to_y * turn_x
            if whole or (0.0 <= at_x <= length and 0.0 <= at_y <= width):
                add_point(total, at_x * along, at_y * across, amount, 0.0, 0.0)


@compiled()
def _add_rectangle(
    total: NDArray, contact: NDArray, rise: float, length: float, width: float
) -> None:
    """Share a rectangle of one rise, without its part beyond the skin."""
    rows, columns = total.shape
    box = patch_box(contact, 0.0)
    left, right = max(box[0], 0.0) / length * columns, min(box[1], length) / length * columns
    low, high = max(box[2], 0.0) / width * rows, min(box[3], width) / width * rows
    wide, tall = int((right - left) * PARTS) + 1, int((high - low) * PARTS) + 1
    along, across = (right - left) / wide, (high - low) / tall
    for i in range(tall):
        for j in range(wide):
            u, v = left + (j + 0.5) * along, low + (i + 0.5) * across
            add_point(total, u, v, rise * along * across, along, across)


@compiled()
def _add_overlaps(
    contacts: NDArray,
    by: int,
    own: Stacks,
    foam: FoamTables,
    total: NDArray,
    length: float,
    width: float,
) -> bool:
    """Correct the summed rises where patches overlap; True if one was limited."""
    left, right, bottom, top = overlap_box(contacts, by, own)
    left, right, bottom, top = max(left, 0.0), min(right, length), max(bottom, 0.0), min(top, width)
    if left >= right or bottom >= top:
        return False
    rows, columns = total.shape
    wide = max(int((right - left) / length * columns * PARTS) + 1, SAMPLES)
    tall = max(int((top - bottom) / width * rows * PARTS) + 1, SAMPLES)
    along, across, limited = (right - left) / wide, (top - bottom) / tall, False
    flat = all_flat(contacts)
    before, change = -1, 0.0
    for i in range(tall):
        at_y = bottom + (i + 0.5) * across
        for j in range(wide):
            at_x = left + (j + 0.5) * along
            over = contacts_over(contacts, by, own.strain, foam, at_x, at_y)
            if over & (over - 1) == 0:
                continue
            if not flat or over != before:
                change, beyond = joint_minus_sum(contacts, by, own, foam, at_x, at_y)
                limited |= beyond
                before = over
            u, v = at_x / length * columns, at_y / width * rows
            amount = change * along * across / (length * width) * rows * columns
            add_point(total, u, v, amount, 0.0, 0.0)
    return limited
