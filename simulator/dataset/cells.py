"""How far touches laid on cells are from touches with their own edges."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..fem.estimate import relative_difference
from ..fem.safety import SAMPLED
from ..measure.streams import CELLS, stream
from ..models.parameters import nominal
from ..models.reduced.indented.draws import spreading
from ..models.solver import Solver
from ..press.batch import PressBatch
from ..press.press import parse_press
from ..scene.scene import Scene
from .anywhere.deep import raised_by_triangles
from .model import Family
from .presses import Presses, drawn_presses

SAMPLE = 16


def error_of_cells(scene: Scene, family: Family, seed: int, rtol: float) -> float:
    """Largest relative error of Rs and Cp by laying touches on cells, of a sample of presses.

    Against the full model, which follows every edge, on the scene's own skin. Where a tension
    spreads presses it includes what `error_of_deflections` tells, and SAMPLED.
    """
    presses = _sample(scene, family, seed)
    solver = Solver(scene, rtol)
    exact = np.stack([solver.solve(parse_press(text, np.nan)).Z for text in presses.text])
    laid = _answers(scene, family, presses.batch)
    return (SAMPLED if spreading(scene) else 1.0) * _largest(laid, exact)


def error_of_deflections(scene: Scene, family: Family, seed: int) -> float:
    """What deflections on a lattice change of Rs and Cp, relatively, by a sample of presses.

    Against the membrane on triangles, laid on the same cells.
    """
    presses = _sample(scene, family, seed)
    assert presses.placed is not None
    laid = _answers(scene, family, presses.batch)
    traced = raised_by_triangles(scene, presses.touches, presses.placed, family.grid)
    exact = _answers(scene, family, traced)
    return SAMPLED * _largest(laid, exact)


def _sample(scene: Scene, family: Family, seed: int) -> Presses:
    return drawn_presses(scene, stream(seed, 0, CELLS), SAMPLE, family.grid)


def _answers(scene: Scene, family: Family, batch: PressBatch) -> NDArray[np.complex128]:
    """Z in ohm of presses on the scene's own skin, shape (press, interface, frequency)."""
    rest = replace(nominal(scene, family.modes), capacitance=np.ones(family.grid))
    return family.skin(rest).sweeps(batch)


def _largest(found: NDArray[np.complex128], exact: NDArray[np.complex128]) -> float:
    return float(np.max(relative_difference(found, exact)))
