"""What the others are judged by where no formula is known: high order, graded towards foil ends.

The mesh of the plain script, solved for the deviation from the driven potential, so that neither
thin cells nor low frequencies cost digits.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.rivals.scikit_fem_script import GRADING, Elements, discretised
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.scene import Scene
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu

STEPS = 25
POWERS = (1, 2, 3)
"""Of the cells at a foil's end, in the error: the field there goes as r^1/2, r^3/2, r^5/2."""
SYMMETRIC: dict = {
    "permc_spec": "MMD_AT_PLUS_A",
    "diag_pivot_thresh": 0.0,
    "options": {"SymmetricMode": True},
}


def impedance(scene: Scene, press: Press, frequencies: NDArray, elements: Elements) -> NDArray:
    """Z of the mesh or, where it has layers, of ever more of them: at least as many as POWERS.

    It is extrapolated from a few, for in cells below some 1e-5 of a pixel rounding costs more than
    they gain.
    """
    if elements.layers == 0:
        return of_mesh(scene, press, frequencies, elements)
    counts = range(elements.layers - len(POWERS), elements.layers + 1)
    Z = [of_mesh(scene, press, frequencies, replace(elements, layers=count)) for count in counts]
    for power in POWERS:
        ratio = GRADING**power
        Z = [fine + (fine - coarse) * ratio / (1 - ratio) for coarse, fine in pairwise(Z)]
    return Z[0]


def of_mesh(scene: Scene, press: Press, frequencies: NDArray, elements: Elements) -> NDArray:
    """Z = 1/Y, Y = s g'Mg - s² b'(1 + s T)^-1 b in the space of (K^-1 M)^k K^-1 M g.

    b and T: M g and M in a basis V of that space with V'KV = 1. For omega R C up to some hundreds,
    where 25 dimensions leave nothing but rounding.
    """
    system = discretised(scene, press, elements)
    free = system.free
    charge = system.M @ system.one
    K, M = (csc_matrix(A[free][:, free]) for A in (system.K, system.M))
    factors = splu(K, **SYMMETRIC)
    V = np.zeros((len(free), 0))
    following = charge[free]
    for _ in range(STEPS):
        v = factors.solve(following)
        for _ in range(2):
            v -= V @ (V.T @ (K @ v))
        v /= np.sqrt(v @ (K @ v))
        V = np.column_stack([V, v])
        following = M @ v
    b, T = V.T @ charge[free], V.T @ (M @ V)
    return np.array(
        [
            1 / (s * (system.one @ charge) - s**2 * b @ np.linalg.solve(np.eye(STEPS) + s * T, b))
            for s in 2j * np.pi * np.asarray(frequencies)
        ]
    )
