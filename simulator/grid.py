"""Nodes along one axis: on given lines, and closer together towards those that ask for it."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

GRADING = 0.2
SAME_LINE = 1e-9


@dataclass(frozen=True)
class Refinement:
    """How cells shrink towards a line.

    width: they are halved until none beside the line is wider, in m: for a layer of the field.
    tip: then divided at GRADING of their length until none is wider, in m: for a singularity.
    """

    width: float = np.inf
    tip: float = np.inf

    def merged(self, other: Refinement) -> Refinement:
        """Fine enough for both."""
        return Refinement(min(self.width, other.width), min(self.tip, other.tip))


NONE = Refinement()


def distinct(lines: Sequence[float]) -> NDArray[np.float64]:
    """The lines in ascending order, those that are the same but for rounding once."""
    ascending = np.sort(np.asarray(lines))
    apart = np.diff(ascending) > SAME_LINE * ascending[-1]
    return ascending[np.append(True, apart)]


def nodes(
    lines: NDArray[np.float64], cells: int, refinements: Mapping[float, Refinement]
) -> NDArray[np.float64]:
    """Nodes on all `lines`, `cells` even cells between neighbours, refined as asked.

    refinements: by the line they are for, given to within rounding.
    """
    at_lines = [_at(line, lines[-1], refinements) for line in lines]
    pieces = [
        _graded(low, high, cells, towards_low, towards_high)
        for (low, high), (towards_low, towards_high) in zip(
            itertools.pairwise(lines), itertools.pairwise(at_lines), strict=True
        )
    ]
    return np.concatenate([lines[:1], *(piece[1:] for piece in pieces)])


def _at(line: float, length: float, refinements: Mapping[float, Refinement]) -> Refinement:
    wanted = NONE
    for other, refinement in refinements.items():
        if abs(other - line) <= SAME_LINE * length:
            wanted = wanted.merged(refinement)
    return wanted


def _graded(
    low: float, high: float, cells: int, towards_low: Refinement, towards_high: Refinement
) -> NDArray[np.float64]:
    width = (high - low) / cells
    both = _steps(width, towards_low).size and _steps(width, towards_high).size
    even = np.linspace(low, high, (max(cells, 2) if both else cells) + 1)
    width = even[1] - even[0]
    above_low, below_high = _steps(width, towards_low), _steps(width, towards_high)
    return np.concatenate(
        [even[:1], low + above_low, even[1:-1], high - below_high[::-1], even[-1:]]
    )


def _steps(cell: float, refinement: Refinement) -> NDArray[np.float64]:
    """Distances from the line at which a cell beside it is divided, ascending."""
    halved = cell * 0.5 ** np.arange(_divisions(cell, refinement.width, 0.5) + 1.0)
    divisions = _divisions(halved[-1], refinement.tip, GRADING)
    graded = halved[-1] * GRADING ** np.arange(1.0, divisions + 1.0)
    return np.concatenate([halved[1:], graded])[::-1].astype(np.float64)


def _divisions(cell: float, widest: float, ratio: float) -> int:
    """How often a cell shrinks by a ratio until it is no wider than that."""
    return int(np.ceil(np.log(min(1.0, widest / cell)) / np.log(ratio) - SAME_LINE))
