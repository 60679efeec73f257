"""Low-rank part of M by solved surroundings, in the unknowns of elements.

It holds the charges of the sheets by potentials elsewhere on them. For potentials with coefficients
u, the nearest ones in the smooth basis of `SurroundingsMatrix` are G^-1 B u: G has the integrals of
products of basis functions, B those with trial functions. The remainder has no such charges.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csc_matrix

from ...arrays import Real
from ...fem.assembly import DROPPED
from ...fem.unknowns import Unknowns
from ...surroundings.surroundings_matrix import surroundings_matrix
from .elements import Elements
from .materials import Materials


def low_rank_charges(elements: Elements, materials: Materials, unknowns: Unknowns) -> Real | None:
    """F of `LowRankMass`, shape (unknown, rank); None if surroundings are not solved."""
    around = materials.skin.around
    if around is None or not around.solved:
        return None
    found, surface = surroundings_matrix(materials.skin), elements.surface
    b = found.basis.at(surface.x).reshape(found.basis.count, -1)
    weights = (surface.area * elements.rule.weights).ravel()
    gram = (b * weights) @ b.T
    of_cells = (b * weights).reshape(len(b), elements.cells, -1) @ elements.rule.values.T
    far = np.zeros((unknowns.pattern.size, found.factor.shape[-1]))
    for number, factor in zip(unknowns.number, found.factor, strict=True):
        own = number[elements.trial.dofs.element_dofs].T.ravel()
        there = np.flatnonzero(own != DROPPED)
        ones = np.ones(len(there))
        spread = csc_matrix((ones, (own[there], there)), (len(far), len(own)))
        far += (spread @ of_cells.reshape(len(b), -1).T) @ np.linalg.solve(gram, factor)
    return far


def describe_accuracy(materials: Materials) -> str:
    """Accuracy of solved surroundings as words for the model's description; else empty."""
    around = materials.skin.around
    if around is None or not around.solved:
        return ""
    return f", surroundings solved to {surroundings_matrix(materials.skin).error:.0e}"
