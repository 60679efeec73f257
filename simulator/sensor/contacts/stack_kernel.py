"""Stacks of discs under contacts on the cells of a grid, also coarse ones, compiled.

On coarse cells moments are kept: each patch is divided into points, and each point is shared
between three cells along each axis, as `cell_spreading` shares fine cells. Integrals of polynomials
of degree 2 are kept.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...compiled import compiled
from ...models.mechanics.foam_law import FoamTables, rise_at, strain_under, stress
from ...press.batch import PressBatch
from ...press.cell_kernel import (
    CELLS_AT_FIRST,
    FAINT,
    Box,
    add_patch,
    add_point,
    box_cells,
    empty_batch,
    moved_to_batch,
)
from ...press.pixels import SAMPLES, GridCells
from .patch_kernel import (
    ADDED,
    CURVATURE,
    FACTOR,
    FINE,
    FORCE,
    HEIGHT,
    RADIUS,
    ROUNDING,
    WIDTH,
    Fault,
    Stacks,
    X,
    Y,
    area_on_skin,
    of_press,
    patch_box,
    skin_of_cell,
    winkler_stacks,
    within_skin,
)

MAX_BITS = 62
POINTS = 4
"""Number of points along the side of a cell, at least."""


@compiled()
def cells_of_stacks(
    values: NDArray,
    counts: NDArray,
    by: int,
    stacks: Stacks,
    limited: NDArray,
    foam: FoamTables,
    cells: GridCells,
) -> PressBatch:
    """Presses on the cells of a grid, each of a number of contacts with stacks of discs.

    values: see `contact_types.COLUMNS`, shape (press, contact, 7). counts: contacts of each press.
    Where patches of forces or depths overlap, a correction is sampled; `limited` becomes True where
    that needs more than the largest strain.
    """
    presses, (rows, columns) = len(values), cells.cut.shape
    batch, found = empty_batch(presses, CELLS_AT_FIRST * presses), 0
    unpressed = 1.0 if by == FACTOR else 0.0
    total = np.full((rows, columns), unpressed)
    for press in range(presses):
        span = columns, 0, rows, 0
        for k in range(counts[press]):
            for disc in range(stacks.discs[press, k]):
                radius, rise = stacks.radii[press, k, disc], stacks.rises[press, k, disc]
                box = patch_box(values[press, k], radius)
                span = add_patch(total, span, box, radius, rise, by == FACTOR, cells)
        if by < FACTOR and counts[press] > 1:
            contacts, own = values[press, : counts[press]], of_press(stacks, press)
            limited[press] |= _add_overlaps(contacts, by, own, foam, cells, total, False)
        batch, found = moved_to_batch(total, span, unpressed, FAINT, batch, found)
        batch.starts[press + 1] = found
    return PressBatch(batch.cells[:found], batch.rises[:found], batch.starts)


@compiled()
def _add_overlaps(
    contacts: NDArray,
    by: int,
    own: Stacks,
    foam: FoamTables,
    cells: GridCells,
    total: NDArray,
    coarse: bool,
) -> bool:
    """Correct the summed rises of cells where patches overlap; True if one was limited.

    The correction is sampled in the rectangle around all overlaps: in each cell of `cells`, or at
    points that are shared between coarse cells.
    """
    left, right, bottom, top = overlap_box(contacts, by, own)
    rows, columns = total.shape
    length, width = cells.x[-1], cells.y[-1]
    left, right, bottom, top = max(left, 0.0), min(right, length), max(bottom, 0.0), min(top, width)
    if left >= right or bottom >= top:
        return False
    if coarse:
        wide = max(int((right - left) / length * columns * POINTS) + 1, SAMPLES)
        high = max(int((top - bottom) / width * rows * POINTS) + 1, SAMPLES)
        sides = left, right, bottom, top
        return _add_samples(contacts, by, own, foam, cells, total, sides, (wide, high), (-1, -1))
    limited, span = False, box_cells((left, right, bottom, top), cells)
    x, y = cells.x, cells.y
    for i in range(span[2], span[3]):
        for j in range(span[0], span[1]):
            sides = max(left, x[j]), min(right, x[j + 1]), max(bottom, y[i]), min(top, y[i + 1])
            counts = SAMPLES, SAMPLES
            limited |= _add_samples(contacts, by, own, foam, cells, total, sides, counts, (i, j))
    return limited


@compiled()
def _add_samples(
    contacts: NDArray,
    by: int,
    own: Stacks,
    foam: FoamTables,
    cells: GridCells,
    total: NDArray,
    sides: Box,
    counts: tuple[int, int],
    cell: tuple[int, int],
) -> bool:
    """Add the rise under all patches minus the sum of their own at points of a rectangle.

    counts: of points along x and y. cell: row and column of the one around the rectangle; (-1, -1)
    if points are shared between coarse cells. True if a strain was limited.
    """
    rows, columns = total.shape
    length, width = cells.x[-1], cells.y[-1]
    along, across = (sides[1] - sides[0]) / counts[0], (sides[3] - sides[2]) / counts[1]
    share = along * across / (length * width) * rows * columns
    flat, before, change = all_flat(contacts), 0, 0.0
    limited, added, cut = False, 0.0, -1 if cell[0] < 0 else cells.cut[cell]
    left, wide = cells.x[cell[1]], cells.x[cell[1] + 1] - cells.x[cell[1]]
    low, high = cells.y[cell[0]], cells.y[cell[0] + 1] - cells.y[cell[0]]
    for k in range(counts[1]):
        at_y = sides[2] + (k + 0.5) * across
        for m in range(counts[0]):
            at_x = sides[0] + (m + 0.5) * along
            if cut >= 0:
                row = min(int((at_y - low) / high * SAMPLES), SAMPLES - 1)
                column = min(int((at_x - left) / wide * SAMPLES), SAMPLES - 1)
                if not cells.mask[cut, row, column]:
                    continue
            over = contacts_over(contacts, by, own.strain, foam, at_x, at_y) if flat else -1
            if over & (over - 1) == 0:
                continue
            if over != before or not flat:
                change, beyond = joint_minus_sum(contacts, by, own, foam, at_x, at_y)
                limited |= beyond
                before = over
            if change == 0.0:
                continue
            if cell[0] >= 0:
                added += change * along * across
            else:
                u, v = at_x / length * columns, at_y / width * rows
                add_point(total, u, v, change * share, 0.0, 0.0)
    if added != 0.0:
        total[cell] += added / skin_of_cell(cell[0], cell[1], cells)
    return limited


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


@compiled(inline="always")  # a call at each sample takes a third of the time
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


MIN_ANGLES = 5
"""Smallest number of points on a ring: it keeps polynomials of degree 4."""


@compiled()
def pressed_moments(
    values: NDArray,
    counts: NDArray,
    by: int,
    tables: tuple,
    lines: tuple,
    grid: tuple[int, int],
) -> tuple[PressBatch, NDArray, NDArray, Fault]:
    """Presses by `winkler_stacks` and `moments_of_stacks`, and further results of the first.

    tables, lines: fields of `FoamTables` and `GridCells`. It is one call, and plain tuples are
    passed faster: most of a single press is the cost of a call.
    """
    foam, cells = FoamTables(*tables), GridCells(*lines)
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
            limited[press] |= _add_overlaps(contacts, by, own, foam, cells, total, True)
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
    densest = POINTS * max(along, across)
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
    wide, tall = int((right - left) * POINTS) + 1, int((high - low) * POINTS) + 1
    along, across = (right - left) / wide, (high - low) / tall
    for i in range(tall):
        for j in range(wide):
            u, v = left + (j + 0.5) * along, low + (i + 0.5) * across
            add_point(total, u, v, rise * along * across, along, across)
