"""Patches under contacts, compiled: their boxes, their area on the skin, and their faults."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...compiled import compiled
from ...press.cell_kernel import Box, box_cells, covered_part
from ...press.pixels import GridCells
from ...sweeps.press_text import MAX_FACTOR, MIN_FACTOR

X, Y, STRENGTH, RADIUS, CURVATURE, WIDTH, HEIGHT = range(7)
"""Columns of a contact's numbers, see `contact_types.COLUMNS`."""
FINE, BAD_PLACE, BAD_STRENGTH, BAD_PATCH, OFF_SKIN = range(5)
FORCE, DEPTH, FACTOR, ADDED = range(4)
"""How a contact is given; ADDED: factors of touches that add a capacitance to earth."""
ROUNDING = 1e-9

Fault = tuple[int, int, int]
"""Press, contact and reason of the first invalid contact; the reason is FINE if there is none."""


class Stacks(NamedTuple):
    """Discs of rises under contacts, of many presses or of one.

    radii [m], rises: of each disc; a rectangle has the radius 0; shape (press, contact, disc).
    discs: their number, 0 leaves a contact out; strain: in the middle; shape (press, contact).
    """

    radii: NDArray[np.float64]
    rises: NDArray[np.float64]
    discs: NDArray[np.int64]
    strain: NDArray[np.float64]


@compiled()
def of_press(stacks: Stacks, press: int) -> Stacks:
    """Stacks of one press, without the first axis."""
    radii, rises = stacks.radii[press], stacks.rises[press]
    return Stacks(radii, rises, stacks.discs[press], stacks.strain[press])


@compiled()
def patch_box(contact: NDArray, radius: float) -> Box:
    """Rectangle around a patch. radius: of a disc, 0 for a rectangle, m."""
    wide, high = radius, radius
    if radius == 0.0:
        wide, high = contact[WIDTH] / 2, contact[HEIGHT] / 2
    return contact[X] - wide, contact[X] + wide, contact[Y] - high, contact[Y] + high


@compiled()
def skin_of_cell(i: int, j: int, cells: GridCells) -> float:
    """Area of the skin in a cell, m²."""
    x, y = cells.x, cells.y
    return (x[j + 1] - x[j]) * (y[i + 1] - y[i]) * cells.part[i, j]


@compiled()
def area_on_skin(contact: NDArray, radius: float, cells: GridCells) -> float:
    """Area of the skin under a patch, m²."""
    box, area = patch_box(contact, radius), 0.0
    left, right, bottom, top = box_cells(box, cells)
    for i in range(bottom, top):
        for j in range(left, right):
            area += skin_of_cell(i, j, cells) * covered_part(box, radius, i, j, cells)
    return area


@compiled()
def within_borders(contact: NDArray, radius: float, cells: GridCells) -> bool:
    """True if a patch lies within the length and width of the skin."""
    box, length, width = patch_box(contact, radius), cells.x[-1], cells.y[-1]
    return box[0] >= 0.0 and box[1] <= length and box[2] >= 0.0 and box[3] <= width


@compiled()
def within_skin(contact: NDArray, radius: float, cells: GridCells) -> bool:
    """True if a patch lies on the skin entirely; also False where that is not certain."""
    return cells.whole and within_borders(contact, radius, cells)


@compiled()
def reason_invalid(contact: NDArray, by: int, cells: GridCells) -> int:
    """Number of the reason why a contact is invalid; FINE if it is not."""
    length, width = cells.x[-1], cells.y[-1]
    near_x, near_y = ROUNDING * length, ROUNDING * width
    if not (-near_x <= contact[X] <= length + near_x and -near_y <= contact[Y] <= width + near_y):
        return BAD_PLACE
    strength = contact[STRENGTH]
    if not 0.0 <= strength < np.inf:
        return BAD_STRENGTH
    if by >= FACTOR and not MIN_FACTOR <= strength <= MAX_FACTOR:
        return BAD_STRENGTH
    if contact[WIDTH] != 0.0 or contact[HEIGHT] != 0.0:
        known = 0.0 < contact[WIDTH] < np.inf and 0.0 < contact[HEIGHT] < np.inf
        return FINE if known else BAD_PATCH
    if not (contact[RADIUS] > 0.0 and contact[CURVATURE] > 0.0):
        return BAD_PATCH
    if contact[RADIUS] == np.inf and (contact[CURVATURE] == np.inf or by >= FACTOR):
        return BAD_PATCH
    return FINE
