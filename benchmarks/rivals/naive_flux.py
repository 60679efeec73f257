"""Nodal potentials by bilinear elements; the current from their slope at the foil."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.rivals.bilinear import build
from rcskin.benchmarks.rivals.cells import Cells, Fields
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.scene import Scene


def impedance(scene: Scene, press: Press, frequencies: NDArray, cells: Cells) -> NDArray:
    """Z = 1 V / I, I = (mean fall of the potential over one cell) / h * width of the foil / R."""
    system, fields = build(scene, press, cells), Fields.of_scene(scene)
    foil = fields.high
    under, inside = cells.under(foil)
    into, along_foil = cells.sides(scene), (scene.skin.width, scene.skin.length)
    axis = 0 if foil.edge in ("left", "right") else 1
    width = (foil.span[1] - foil.span[0]) * along_foil[axis]
    u = np.stack([system.potential(2j * np.pi * f) for f in frequencies])
    slope = (u[:, under] - u[:, inside]).mean(axis=1) / into[axis]
    return fields.resistances[0] / (slope * width)
