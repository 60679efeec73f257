"""Nodal potentials by bilinear elements; the current that the foil's nodes draw, then Z = 1/Y."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.rivals.bilinear import build
from rcskin.benchmarks.rivals.cells import Cells
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.scene import Scene


def impedance(scene: Scene, press: Press, frequencies: NDArray, cells: Cells) -> NDArray:
    """Z = 1/Y, Y = the sum of (K + s M) u over the nodes held at 1 V."""
    system = build(scene, press, cells)

    def admittance(s: complex) -> complex:
        drawn = (system.K + s * system.M) @ system.potential(s)
        return drawn[system.high].sum()

    return 1 / np.array([admittance(2j * np.pi * f) for f in frequencies])
