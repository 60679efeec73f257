"""Rectangles, discs and points on the cells of a grid, compiled.

`press.rasterized` and sensors take them.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..compiled import compiled
from ..scene.planar import SAME_LINE
from .batch import PressBatch
from .pixels import SAMPLES, GridCells

Box = tuple[float, float, float, float]
"""Left, right, bottom and top, m."""
Span = tuple[int, int, int, int]
"""First and end of columns, first and end of rows."""
FAINT = 1e-12
"""Rises of sums below this are rounding errors."""
CELLS_AT_FIRST = 16
"""Cells of a press for which a batch has room at first."""


@compiled()
def cells_of_patches(
    counts: NDArray,
    boxes: NDArray,
    radii: NDArray,
    rises: NDArray,
    multiply: bool,
    cells: GridCells,
) -> PressBatch:
    """Presses of rectangles and discs on the cells of a grid.

    counts: patches of each press, the first in their row. boxes: left, right, bottom and top, m,
    shape (press, patch, 4). radii: of discs, m, 0 of rectangles; rises of c: shape (press, patch).
    multiply: True if factors 1 + rise multiply where patches overlap; False if rises add.
    """
    rows, columns = cells.cut.shape
    batch, found = empty_batch(len(counts), CELLS_AT_FIRST * len(counts)), 0
    unpressed = 1.0 if multiply else 0.0
    total = np.full((rows, columns), unpressed)
    for press in range(len(counts)):
        span = columns, 0, rows, 0
        for k in range(counts[press]):
            own = boxes[press, k]
            box, radius = (own[0], own[1], own[2], own[3]), radii[press, k]
            span = add_patch(total, span, box, radius, rises[press, k], multiply, cells)
        batch, found = moved_to_batch(total, span, unpressed, 0.0, batch, found)
        batch.starts[press + 1] = found
    return PressBatch(batch.cells[:found], batch.rises[:found], batch.starts)


@compiled()
def add_patch(
    total: NDArray,
    span: Span,
    box: Box,
    radius: float,
    rise: float,
    multiply: bool,
    cells: GridCells,
) -> Span:
    """Raise `total` under a patch; returns the span of cells widened by its own.

    A cell takes 1 + rise or the rise by the part of its skin that the patch covers; see
    `cells_of_patches`.
    """
    left, right, bottom, top = box_cells(box, cells)
    for i in range(bottom, top):
        for j in range(left, right):
            covered = covered_part(box, radius, i, j, cells)
            if multiply:
                total[i, j] *= (1 - covered) + (1 + rise) * covered
            else:
                total[i, j] += rise * covered
    return min(span[0], left), max(span[1], right), min(span[2], bottom), max(span[3], top)


@compiled()
def empty_batch(presses: int, room: int) -> PressBatch:
    """Batch with room for a number of cells."""
    return PressBatch(np.empty(room, np.int64), np.empty(room), np.zeros(presses + 1, np.int64))


@compiled()
def moved_to_batch(
    total: NDArray, span: Span, unpressed: float, faint: float, batch: PressBatch, found: int
) -> tuple[PressBatch, int]:
    """Batch with the pressed cells of a span behind the `found` first ones, and their new number.

    The span of `total` becomes `unpressed` again. faint: largest rise that is left out. A batch
    without room is replaced by a longer one.
    """
    left, right, bottom, top = span
    rows, columns = total.shape
    cells, rises, starts = batch.cells, batch.rises, batch.starts
    if found + max(right - left, 0) * max(top - bottom, 0) > len(cells):
        more = 2 * len(cells) + rows * columns
        old_cells, old_rises = cells, rises
        cells, rises = np.empty(more, np.int64), np.empty(more)
        for k in range(found):
            cells[k], rises[k] = old_cells[k], old_rises[k]
    for i in range(bottom, top):
        for j in range(left, right):
            rise, total[i, j] = total[i, j] - unpressed, unpressed
            if abs(rise) > faint:
                cells[found], rises[found] = i * columns + j, rise
                found += 1
    return PressBatch(cells, rises, starts), found


@compiled()
def box_cells(box: Box, cells: GridCells) -> Span:
    """Cells that a rectangle meets."""
    rows, columns = cells.cut.shape
    along, across = columns / cells.x[columns], rows / cells.y[rows]
    return (
        min(max(int(np.floor(box[0] * along)), 0), columns),
        max(min(int(np.ceil(box[1] * along)), columns), 0),
        min(max(int(np.floor(box[2] * across)), 0), rows),
        max(min(int(np.ceil(box[3] * across)), rows), 0),
    )


@compiled()
def covered_part(box: Box, radius: float, i: int, j: int, cells: GridCells) -> float:
    """Part of the skin in a cell that a patch covers; from samples where the skin's edge passes."""
    x, y, own = cells.x, cells.y, cells.cut[i, j]
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
            if not cells.mask[own, k, m]:
                continue
            there += 1
            at_x = x[j] + (m + 0.5) / SAMPLES * (x[j + 1] - x[j])
            if radius == 0.0:
                under += box[0] <= at_x <= box[1] and box[2] <= at_y <= box[3]
            else:
                under += (at_x - middle_x) ** 2 + (at_y - middle_y) ** 2 <= radius * radius
    return under / there if there else 0.0


@compiled()
def covered_fraction(box: Box, radius: float, sides: Box) -> float:
    """Fraction of a cell within a patch. sides: left, right, bottom, top of the cell, m.

    Areas under a disc are exact except for rounding errors of 1e-16 radius².
    """
    left, right, bottom, top = sides
    if radius == 0.0:
        wide = (min(right, box[1]) - max(left, box[0])) / (right - left)
        high = (min(top, box[3]) - max(bottom, box[2])) / (top - bottom)
        return max(wide, 0.0) * max(high, 0.0)
    x, y = (box[0] + box[1]) / 2, (box[2] + box[3]) / 2
    u0, u1, v0, v1 = (
        (left - x) / radius,
        (right - x) / radius,
        (bottom - y) / radius,
        (top - y) / radius,
    )
    near_u, near_v = max(u0, -u1, 0.0), max(v0, -v1, 0.0)
    if near_u * near_u + near_v * near_v >= 1.0:
        return 0.0
    far_u, far_v = max(-u0, u1), max(-v0, v1)
    if far_u * far_u + far_v * far_v <= 1.0:
        return 1.0
    area = (_below(u1, v1) - _below(u0, v1)) - (_below(u1, v0) - _below(u0, v0))
    return min(max(area / ((u1 - u0) * (v1 - v0)), 0.0), 1.0)


@compiled()
def covered_with_slopes(box: Box, radius: float, cells: GridCells) -> NDArray:
    """Part of each cell that a patch covers, and its derivatives by x and y of the patch, 1/m.

    Shape (3, row, column); each cell counts as all skin. A patch that moves enters a cell over the
    part of one side that it covers, and leaves it over that of the opposite side. An edge on the
    line between two cells is in the second one; edges at the skin's ends or beyond do not count.
    """
    x, y = cells.x.copy(), cells.y.copy()
    rows, columns = cells.cut.shape
    found = np.zeros((3, rows, columns))
    left, right, bottom, top = box_cells(box, cells)
    near_x, near_y = SAME_LINE * x[columns], SAME_LINE * y[rows]
    x[0], x[columns], y[0], y[rows] = near_x, x[columns] - near_x, near_y, y[rows] - near_y
    wide, high = (box[0], box[1]), (box[2], box[3])
    for i in range(max(bottom - 1, 0), min(top + 1, rows)):
        for j in range(max(left - 1, 0), min(right + 1, columns)):
            sides = cells.x[j], cells.x[j + 1], cells.y[i], cells.y[i + 1]
            found[0, i, j] = covered_fraction(box, radius, sides)
            area = (sides[1] - sides[0]) * (sides[3] - sides[2])
            enters = covered_length(wide, high, radius, x[j], sides[2], sides[3])
            leaves = covered_length(wide, high, radius, x[j + 1], sides[2], sides[3])
            found[1, i, j] = (enters - leaves) / area
            enters = covered_length(high, wide, radius, y[i], sides[0], sides[1])
            leaves = covered_length(high, wide, radius, y[i + 1], sides[0], sides[1])
            found[2, i, j] = (enters - leaves) / area
    return found


@compiled()
def covered_length(
    along: tuple[float, float],
    across: tuple[float, float],
    radius: float,
    at: float,
    low: float,
    high: float,
) -> float:
    """Length of a line at a position on one axis, from low to high on the other, under a patch.

    along, across: ends of the patch on the first and on the second axis; all in m.
    """
    first, last = across
    if radius > 0.0:
        middle, away = (first + last) / 2, at - (along[0] + along[1]) / 2
        half = np.sqrt(max(radius * radius - away * away, 0.0))
        first, last = middle - half, middle + half
    elif not along[0] < at <= along[1]:
        return 0.0
    return max(min(high, last) - max(low, first), 0.0)


@compiled()
def _below(u: float, v: float) -> float:
    """Area of the unit disc where its coordinates are <= u and <= v.

    It is the integral of w(t) + clip(v, -w, w) over t from -1 to u, w(t) = sqrt(1 - t²).
    """
    u, v = min(max(u, -1.0), 1.0), min(max(v, -1.0), 1.0)
    w = np.sqrt(1 - v * v)
    beside = _under_arc(min(u, -w)) + _under_arc(max(u, w)) - _under_arc(w)
    return _under_arc(u) + np.sign(v) * beside + v * (min(max(u, -w), w) + w)


@compiled()
def _under_arc(u: float) -> float:
    """Integral of sqrt(1 - t²) over t from -1 to u."""
    return (u * np.sqrt(1 - u * u) + np.arcsin(u)) / 2 + np.pi / 4


@compiled()
def axis_shares(at: float, count: int, extent: float) -> tuple[int, float, float, float]:
    """First of three cells along an axis and the share of each, as in `cell_spreading`.

    at: position over the side of a cell. extent: of what is shared, over that side.
    """
    cell = min(max(int(at), 0), count - 1)
    t = at - cell - 0.5
    if count == 1:
        return -1, 0.0, 1.0, 0.0
    if cell == 0:
        return -1, 0.0, 1 - t, t
    if cell == count - 1:
        return cell - 1, -t, 1 + t, 0.0
    second = t * t + (extent * extent - 1) / 12
    return cell - 1, (second - t) / 2, 1 - second, (second + t) / 2


@compiled()
def add_point(total: NDArray, u: float, v: float, amount: float, wide: float, high: float) -> None:
    """Share an amount at u along x and v along y, over the sides of a cell."""
    rows, columns = total.shape
    row, low, middle, up = axis_shares(v, rows, high)
    column, left, centre, right = axis_shares(u, columns, wide)
    for k in range(3):
        own = amount * (low if k == 0 else middle if k == 1 else up)
        if own != 0.0:
            if left != 0.0:
                total[row + k, column] += own * left
            total[row + k, column + 1] += own * centre
            if right != 0.0:
                total[row + k, column + 2] += own * right
