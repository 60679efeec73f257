"""Contacts to coarse cells in one compiled call: most of a single press is the cost of the call."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...compiled import compiled
from .moment_kernel import moments_of_stacks
from .winkler_kernel import winkler_stacks


@compiled()
def pressed_moments(
    values: NDArray,
    counts: NDArray,
    by: int,
    law: NDArray,
    relative: NDArray,
    strains: NDArray,
    x: NDArray,
    y: NDArray,
    cut: NDArray,
    mask: NDArray,
    part: NDArray,
    whole: bool,
    grid: tuple[int, int],
) -> tuple[NDArray, NDArray, NDArray, NDArray, NDArray, NDArray]:  # pragma: no cover
    """Cells, rises and starts of presses by `winkler_stacks` and `moments_of_stacks`.

    Returned as well: True for limited presses, radius of each patch, and the first invalid contact.
    """
    radii, stacked, discs, strain, limited, patches, fault = winkler_stacks(
        values, counts, by, law, relative, strains, x, y, cut, mask, part, whole
    )
    if fault[2] != 0:
        return np.zeros(0, np.int64), np.zeros(0), counts, limited, patches, fault
    cells, rises, starts = moments_of_stacks(
        values,
        counts,
        by,
        radii,
        stacked,
        discs,
        strain,
        limited,
        law,
        relative,
        strains,
        x,
        y,
        cut,
        mask,
        part,
        grid,
    )
    return cells, rises, starts, limited, patches, fault
