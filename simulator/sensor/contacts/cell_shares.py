"""A point's amount shared between three coarse cells along each axis, compiled."""

from __future__ import annotations

from numpy.typing import NDArray

from ...compiled import compiled


@compiled()
def _shares(at: float, count: int, extent: float) -> tuple[int, float, float, float]:
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
    row, low, middle, up = _shares(v, rows, high)
    column, left, centre, right = _shares(u, columns, wide)
    for k in range(3):
        own = amount * (low if k == 0 else middle if k == 1 else up)
        if own != 0.0:
            if left != 0.0:
                total[row + k, column] += own * left
            total[row + k, column + 1] += own * centre
            if right != 0.0:
                total[row + k, column + 2] += own * right
