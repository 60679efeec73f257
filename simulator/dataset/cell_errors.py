"""How far touches laid on cells are from touches with their own edges."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..bounds.touches.errors import off_the_solver
from ..fem.error_estimate import relative_difference
from ..fem.safety_factors import SAMPLED
from ..measure.foam_state import FoamState
from ..measure.in_time import reading_moments
from ..measure.streams import CELLS, stream
from ..models.reduced.indented.draws import spreading
from ..press.batch import PressBatch
from ..press.press import parse_press
from ..scene.scene import Scene
from .anywhere.deflections import raised_by_triangles
from .creeping import at_the_end
from .drawn_presses import Presses, drawn_presses
from .skin_model import Family, own_skin

SAMPLE = 16


def error_of_cells(scene: Scene, family: Family, seed: int, rtol: float) -> float:
    """Largest relative error of Rs and Cp by laying touches on cells, of a sample of presses.

    On the scene's own skin; foam that creeps is compared as a sweep ends. Where a tension spreads
    presses it includes what `error_of_deflections` tells, and SAMPLED.
    """
    presses = _sample(scene, family, seed)
    creeps = bool(scene.skin.foam.in_time)
    batch = at_the_end(scene, presses.batch) if creeps else presses.batch
    laid = _answers(scene, family, batch)
    texts = (parse_press(text, np.nan) for text in presses.text)
    if creeps:
        _, whole = reading_moments(scene)
        texts = (FoamState(scene).then(press, 0.0).after(whole) for press in texts)
    return (SAMPLED if spreading(scene) else 1.0) * off_the_solver(scene, texts, laid, rtol)


def error_of_deflections(scene: Scene, family: Family, seed: int) -> float:
    """What deflections on a lattice change of Rs and Cp, relatively, by a sample of presses.

    Against the membrane on triangles, laid on the same cells.
    """
    presses = _sample(scene, family, seed)
    assert presses.placed is not None
    laid = _answers(scene, family, presses.batch)
    traced = raised_by_triangles(scene, presses.touches, presses.placed, family.grid)
    exact = _answers(scene, family, traced)
    return SAMPLED * float(relative_difference(laid, exact).max())


def _sample(scene: Scene, family: Family, seed: int) -> Presses:
    return drawn_presses(scene, stream(seed, 0, CELLS), SAMPLE, family.grid)


def _answers(scene: Scene, family: Family, batch: PressBatch) -> NDArray[np.complex128]:
    """Z in ohm of presses on the scene's own skin, behind its leads, shape (press, interface,
    frequency)."""
    Z = own_skin(scene, family).sweeps(batch)
    return scene.leads.seen_through(Z, scene.frequencies)
