"""Certificates of many cases at once, skin by skin."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .cases import Case, by_skin
from .model import Reduced


def bounds(reduced: Reduced, cases: list[Case], s: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Of each case, the largest bound on the relative errors of Rs and Cp. s: rad/s."""
    found = np.empty(len(cases))
    for group in by_skin(cases, reduced.scene):
        own = [cases[k] for k in group]
        presses = [(case.cells, case.rises) for case in own]
        foams = [reduced.family.foam_of(case) for case in own]
        told = reduced.skin_under(own[0]).certificates(presses, foams, s)
        found[group] = told.max(axis=(0, 2, 3))
    return found
