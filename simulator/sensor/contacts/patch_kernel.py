"""Patches under point contacts as stacks of discs, and the part of cells that they cover."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...compiled import compiled
from ...press.overlap_kernel import covered_fraction
from .cell_samples import SAMPLES
from .foam_kernel import edge_strain, mean_stress, patch_radius, rise_at

X, Y, STRENGTH, RADIUS, CURVATURE, WIDTH, HEIGHT = range(7)


@compiled()
def patch_box(contact: NDArray, radius: float) -> NDArray:  # pragma: no cover
    """Left, right, bottom and top of a patch, m. radius: of a disc, 0 for a rectangle, m."""
    wide = radius if radius > 0.0 else contact[WIDTH] / 2
    high = radius if radius > 0.0 else contact[HEIGHT] / 2
    box = np.empty(4)
    box[0], box[1] = contact[X] - wide, contact[X] + wide
    box[2], box[3] = contact[Y] - high, contact[Y] + high
    return box


@compiled()
def box_cells(box: NDArray, x: NDArray, y: NDArray, span: NDArray) -> None:  # pragma: no cover
    """Columns and rows of the cells that a box meets: first, end, first, end into `span`."""
    columns, rows = len(x) - 1, len(y) - 1
    across, along = x[columns] / columns, y[rows] / rows
    span[0] = min(max(int(np.floor(box[0] / across)), 0), columns)
    span[1] = max(min(int(np.ceil(box[1] / across)), columns), 0)
    span[2] = min(max(int(np.floor(box[2] / along)), 0), rows)
    span[3] = max(min(int(np.ceil(box[3] / along)), rows), 0)


@compiled()
def covered_part(
    box: NDArray,
    radius: float,
    i: int,
    j: int,
    x: NDArray,
    y: NDArray,
    cut: NDArray,
    mask: NDArray,
) -> float:  # pragma: no cover
    """Part of the skin in a cell that a patch covers; from samples where the skin's edge passes.

    cut: number of the cell's samples in `mask`, -1 for a cell that is all skin.
    mask: True where a sample is on the skin, shape (cut cell, SAMPLES, SAMPLES).
    """
    own = cut[i, j]
    sides = x[j], x[j + 1], y[i], y[i + 1]
    if own < 0:
        return covered_fraction(box, radius, sides)
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
    box, span, area = patch_box(contact, radius), np.empty(4, np.int64), 0.0
    box_cells(box, x, y, span)
    for i in range(span[2], span[3]):
        for j in range(span[0], span[1]):
            own = (x[j + 1] - x[j]) * (y[i + 1] - y[i]) * part[i, j]
            area += own * covered_part(box, radius, i, j, x, y, cut, mask)
    return area


@compiled()
def stack_of_discs(
    contact: NDArray,
    strain: float,
    law: NDArray,
    relative: NDArray,
    radii: NDArray,
    rises: NDArray,
    pressures: NDArray,
) -> int:  # pragma: no cover
    """Discs whose rises and pressures add up to those under an indenter; returns their number.

    The patch is divided into rings of equal area; each takes the mean of the rise over it, by
    Simpson's rule, and the mean pressure. Radii ascend, m; a rectangle has the radius 0.
    """
    if contact[WIDTH] > 0.0 or contact[CURVATURE] == np.inf:
        radii[0] = 0.0 if contact[WIDTH] > 0.0 else contact[RADIUS]
        rises[0] = rise_at(law, relative, strain)
        pressures[0] = mean_stress(law, strain, strain) if law[1] > 0.0 else 0.0
        return 1
    rings = len(radii)
    patch = patch_radius(law, strain, contact[RADIUS], contact[CURVATURE])
    low = edge_strain(law, strain, contact[RADIUS], contact[CURVATURE])
    outer = strain
    for k in range(rings):
        inner, outer = outer, strain - (strain - low) * (k + 1) / rings
        radii[k] = patch * np.sqrt((k + 1) / rings)
        middle = rise_at(law, relative, (inner + outer) / 2)
        ends = rise_at(law, relative, inner) + rise_at(law, relative, outer)
        rises[k] = (ends + 4 * middle) / 6
        pressures[k] = mean_stress(law, outer, inner) if law[1] > 0.0 else 0.0
    for k in range(rings - 1):
        rises[k] -= rises[k + 1]
        pressures[k] -= pressures[k + 1]
    return rings
