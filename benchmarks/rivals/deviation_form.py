"""Bilinear elements for the deviation from the driven potential, of which no digits are lost.

With g = 1 V all over the driven field, K g = 0 and (K + s M) d = -s M g; then
Y = s g'Mg + s (Mg)'d.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import DTypeLike, NDArray
from rcskin.benchmarks.rivals.bilinear import build
from rcskin.benchmarks.rivals.cells import Cells, Fields
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.scene import Scene
from scipy.sparse.linalg import spsolve


def impedance(
    scene: Scene,
    press: Press,
    frequencies: NDArray,
    cells: Cells,
    number: DTypeLike = np.complex128,
) -> NDArray:
    """Z = 1/Y with all arithmetic in `number`, complex64 or complex128."""
    system = build(scene, press, cells)
    free = system.free
    fields = len(Fields.of_scene(scene).resistances)
    g = np.arange(fields * cells.nodes) < cells.nodes
    charge = (system.M @ g).astype(number)
    at_once = charge[g].sum()
    K, M = (A[free][:, free].astype(number) for A in (system.K, system.M))

    def admittance(s: np.complexfloating) -> np.complexfloating:
        d = spsolve(K + s * M, -s * charge[free])
        return s * at_once + s * (charge[free] @ d)

    s = (2j * np.pi * np.asarray(frequencies)).astype(number)
    return np.reciprocal(np.array([admittance(each) for each in s], dtype=number))
