"""Errors by rasterizing touches on cells, estimated with a sample of presses."""

from __future__ import annotations

import numpy as np

from ..arrays import Complex
from ..bounds.touches.rasterization_errors import error_against_solver
from ..fem.safety_factors import SAMPLED
from ..measure.creeping_sweeps import reading_moments
from ..measure.foam_state import FoamState
from ..measure.streams import CELLS, stream
from ..models.reduced.indentation.indentation_draws import spreading
from ..models.solution import reading_difference
from ..press.batch import PressBatch
from ..press.press import parse_press
from ..scene.scene import Scene
from .anywhere.deflections import cell_presses_by_triangles
from .creeping import at_sweep_end
from .drawn_presses import Presses, drawn_presses
from .skin_model import SkinFamily, nominal_skin

SAMPLE = 16


def rasterization_error(scene: Scene, family: SkinFamily, seed: int, rtol: float) -> float:
    """Largest relative error of readings by rasterizing touches on cells, for a sample of presses.

    The skin is the scene's nominal one; creeping foam is compared at the end of a sweep. If a
    tension spreads presses, the error includes `lattice_error` and the safety factor SAMPLED.
    """
    presses = _sample(scene, family, seed)
    creeps = bool(scene.skin.foam.in_time)
    batch = at_sweep_end(scene, presses.batch) if creeps else presses.batch
    on_cells = _answers(scene, family, batch)
    texts = (parse_press(text, np.nan) for text in presses.text)
    if creeps:
        _, whole = reading_moments(scene.parts)
        texts = (FoamState(scene.parts.skin).then(press, 0.0).after(whole) for press in texts)
    return (SAMPLED if spreading(scene.parts.skin, scene.press) else 1.0) * error_against_solver(
        scene, texts, on_cells, rtol
    )


def lattice_error(scene: Scene, family: SkinFamily, seed: int) -> float:
    """Relative error of readings by solving deflections on a lattice, for a sample of presses.

    The reference is the membrane on triangles, rasterized on the same cells.
    """
    presses = _sample(scene, family, seed)
    assert presses.placed is not None
    on_cells = _answers(scene, family, presses.batch)
    traced = cell_presses_by_triangles(scene, presses.touches, presses.placed, family.grid)
    exact = _answers(scene, family, traced)
    return SAMPLED * float(reading_difference(on_cells, exact, scene.parts.setup.kind).max())


def _sample(scene: Scene, family: SkinFamily, seed: int) -> Presses:
    return drawn_presses(scene, stream(seed, 0, CELLS), SAMPLE, family.grid)


def _answers(scene: Scene, family: SkinFamily, batch: PressBatch) -> Complex:
    """Readings of presses on the nominal skin, (press, interface, frequency)."""
    Z = nominal_skin(scene, family).sweeps(batch)
    return scene.parts.setup.at_meter(Z)
