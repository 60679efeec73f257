"""Patches under contacts, and the part of cells that they cover, compiled."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...compiled import compiled
from ...press.overlap_kernel import covered_fraction
from .cell_samples import SAMPLES

X, Y, STRENGTH, RADIUS, CURVATURE, WIDTH, HEIGHT = range(7)
"""Columns of a contact's numbers, see `contact_types.COLUMNS`."""
FINE, BAD_PLACE, BAD_STRENGTH, BAD_PATCH, OFF_SKIN = range(5)
FORCE, DEPTH, FACTOR, ADDED = range(4)
"""How a contact is given; ADDED: factors of touches that add a capacitance to earth."""
ROUNDING = 1e-9

Box = tuple[float, float, float, float]
"""Left, right, bottom and top, m."""
Span = tuple[int, int, int, int]
"""First and end of columns, first and end of rows."""


@compiled()
def patch_box(contact: NDArray, radius: float) -> Box:  # pragma: no cover
    """Rectangle around a patch. radius: of a disc, 0 for a rectangle, m."""
    wide, high = radius, radius
    if radius == 0.0:
        wide, high = contact[WIDTH] / 2, contact[HEIGHT] / 2
    return contact[X] - wide, contact[X] + wide, contact[Y] - high, contact[Y] + high


@compiled()
def box_cells(box: Box, x: NDArray, y: NDArray) -> Span:  # pragma: no cover
    """Cells that a rectangle meets. x, y: lines between cells, m."""
    columns, rows = len(x) - 1, len(y) - 1
    along, across = columns / x[columns], rows / y[rows]
    return (
        min(max(int(np.floor(box[0] * along)), 0), columns),
        max(min(int(np.ceil(box[1] * along)), columns), 0),
        min(max(int(np.floor(box[2] * across)), 0), rows),
        max(min(int(np.ceil(box[3] * across)), rows), 0),
    )


@compiled()
def covered_part(
    box: Box, radius: float, i: int, j: int, x: NDArray, y: NDArray, cut: NDArray, mask: NDArray
) -> float:  # pragma: no cover
    """Part of the skin in a cell that a patch covers; from samples where the skin's edge passes.

    cut: number of the cell's samples in `mask`, -1 for a cell that is all skin. mask: True where a
    sample is on the skin, shape (cut cell, SAMPLES, SAMPLES).
    """
    own = cut[i, j]
    if own < 0:
        if box[0] >= x[j] and box[1] <= x[j + 1] and box[2] >= y[i] and box[3] <= y[i + 1]:
            area = (box[1] - box[0]) * (box[3] - box[2]) * (np.pi / 4 if radius > 0.0 else 1.0)
            return area / ((x[j + 1] - x[j]) * (y[i + 1] - y[i]))
        return covered_fraction(box, radius, (x[j], x[j + 1], y[i], y[i + 1]))
    middle_x, middle_y = (box[0] + box[1]) / 2, (box[2] + box[3]) / 2
    there, under = 0, 0
    for k in range(SAMPLES):
        at_y = y[i] + (k + 0.5) / SAMPLES * (y[i + 1] - y[i])
        for m in range(SAMPLES):
            if not mask[own, k, m]:
                continue
            there += 1
            at_x = x[j] + (m + 0.5) / SAMPLES * (x[j + 1] - x[j])
            if radius == 0.0:
                under += box[0] <= at_x <= box[1] and box[2] <= at_y <= box[3]
            else:
                under += (at_x - middle_x) ** 2 + (at_y - middle_y) ** 2 <= radius * radius
    return under / there if there else 0.0


@compiled()
def area_on_skin(
    contact: NDArray,
    radius: float,
    x: NDArray,
    y: NDArray,
    cut: NDArray,
    mask: NDArray,
    part: NDArray,
) -> float:  # pragma: no cover
    """Area of the skin under a patch, m². part: of each cell that is skin, shape (row, column)."""
    box, area = patch_box(contact, radius), 0.0
    left, right, bottom, top = box_cells(box, x, y)
    for i in range(bottom, top):
        for j in range(left, right):
            own = (x[j + 1] - x[j]) * (y[i + 1] - y[i]) * part[i, j]
            area += own * covered_part(box, radius, i, j, x, y, cut, mask)
    return area


@compiled()
def within_skin(
    contact: NDArray, radius: float, length: float, width: float, whole: bool
) -> bool:  # pragma: no cover
    """True if a patch lies on the skin entirely; also False where that is not certain."""
    box = patch_box(contact, radius)
    inside = box[0] >= 0.0 and box[1] <= length and box[2] >= 0.0 and box[3] <= width
    return whole and inside


@compiled()
def reason_invalid(
    contact: NDArray, by: int, length: float, width: float
) -> int:  # pragma: no cover
    """Number of the reason why a contact is invalid; FINE if it is not."""
    near_x, near_y = ROUNDING * length, ROUNDING * width
    if not (-near_x <= contact[X] <= length + near_x and -near_y <= contact[Y] <= width + near_y):
        return BAD_PLACE
    strength = contact[STRENGTH]
    if not 0.0 <= strength < np.inf or (by >= FACTOR and strength == 0.0):
        return BAD_STRENGTH
    if contact[WIDTH] != 0.0 or contact[HEIGHT] != 0.0:
        known = 0.0 < contact[WIDTH] < np.inf and 0.0 < contact[HEIGHT] < np.inf
        return FINE if known else BAD_PATCH
    if not (contact[RADIUS] > 0.0 and contact[CURVATURE] > 0.0):
        return BAD_PATCH
    if contact[RADIUS] == np.inf and (contact[CURVATURE] == np.inf or by >= FACTOR):
        return BAD_PATCH
    return FINE
