"""How far touches laid on cells are from touches with their own edges."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..fem.estimate import relative_difference
from ..measure.streams import CELLS, stream
from ..models.parameters import nominal
from ..models.solver import Solver
from ..press.press import parse_press
from ..scene.scene import Scene
from .model import Family
from .presses import drawn_presses

SAMPLE = 16


def error_of_cells(scene: Scene, family: Family, seed: int, rtol: float) -> float:
    """Largest relative error of Rs and Cp by laying touches on cells, of a sample of presses.

    Against the full model, which follows every edge, on the scene's own skin.
    """
    presses = drawn_presses(scene, stream(seed, 0, CELLS), SAMPLE, family.grid)
    own = nominal(scene, family.modes)
    rest = replace(own, capacitance=np.ones(family.grid))
    laid = family.skin(rest).sweeps(presses.cells, presses.rises, presses.starts)
    solver = Solver(scene, rtol)
    exact = np.stack([solver.solve(parse_press(text, np.nan)).Z for text in presses.text])
    return float(np.max(relative_difference(laid, exact)))
