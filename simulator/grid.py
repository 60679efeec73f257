"""Nodes along one axis: on given lines, and closer together towards those that ask for it."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

SAME_LINE = 1e-9
SAME_EDGE = 1e-8
"""Over the skin's side, edges of touches are told apart by: in thinner elements rounding tells."""
Lines = tuple[tuple[float, ...], tuple[float, ...]]
"""Lines across x, and lines across y; m."""
NO_LINES: Lines = ((), ())


def distinct(lines: Sequence[float], same: float = SAME_LINE) -> NDArray[np.float64]:
    """The lines in ascending order, those that are the same but for that part of the last once."""
    ascending = np.sort(np.asarray(lines))
    apart = np.diff(ascending) > same * ascending[-1]
    return ascending[np.append(True, apart)]


def nodes(
    lines: NDArray[np.float64], cells: int, widths: Mapping[float, float], growth: float = np.inf
) -> NDArray[np.float64]:
    """Nodes on all `lines`, `cells` even cells between neighbours, finer where asked.

    widths: by line (given to within rounding) the width in m that cells beside it do not exceed;
    they are halved towards it until they are that narrow. growth: cells are divided until none is
    more than that many times as wide as its neighbour.
    """
    if cells == 1 and growth == np.inf and all(width == np.inf for width in widths.values()):
        return lines
    at_lines = [_narrowest(line, lines[-1], widths) for line in lines]
    pieces = [
        _halved(low, high, cells, at_low, at_high)
        for (low, high), (at_low, at_high) in zip(
            itertools.pairwise(lines), itertools.pairwise(at_lines), strict=True
        )
    ]
    return _growing(np.concatenate([lines[:1], *(piece[1:] for piece in pieces)]), growth)


def _narrowest(line: float, length: float, widths: Mapping[float, float]) -> float:
    same = [width for at, width in widths.items() if abs(at - line) <= SAME_LINE * length]
    return min(same, default=np.inf)


def _halved(
    low: float, high: float, cells: int, at_low: float, at_high: float
) -> NDArray[np.float64]:
    width = (high - low) / cells
    both = width > at_low and width > at_high
    even = np.linspace(low, high, (max(cells, 2) if both else cells) + 1)
    width = even[1] - even[0]
    above_low, below_high = _steps(width, at_low), _steps(width, at_high)
    return np.concatenate(
        [even[:1], low + above_low, even[1:-1], high - below_high[::-1], even[-1:]]
    )


def _steps(cell: float, widest: float) -> NDArray[np.float64]:
    """Distances from the line at which a cell beside it is divided, ascending."""
    divisions = int(np.ceil(np.log2(max(1.0, cell / widest)) - SAME_LINE))
    return cell * 0.5 ** np.arange(divisions, 0.0, -1.0)


def _growing(nodes: NDArray[np.float64], growth: float) -> NDArray[np.float64]:
    while True:
        width = np.diff(nodes)
        too_wide = growth * (1 + SAME_LINE)
        after = np.flatnonzero(width[1:] > too_wide * width[:-1]) + 1
        before = np.flatnonzero(width[:-1] > too_wide * width[1:])
        if after.size:
            cell = after[0]
            node = nodes[cell] + min(growth * width[cell - 1], width[cell] / 2)
        elif before.size:
            cell = before[0]
            node = nodes[cell + 1] - min(growth * width[cell + 1], width[cell] / 2)
        else:
            return nodes
        nodes = np.insert(nodes, cell + 1, node)
