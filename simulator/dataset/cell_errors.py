"""Errors by rasterizing touches on cells, estimated with a sample of presses."""

from __future__ import annotations

import numpy as np

from ..arrays import Complex
from ..bounds.rasterization_errors import error_against_solver
from ..fem.error_estimate import SAMPLED
from ..measure.foam_state import FoamState, reading_moments
from ..measure.skins import CELLS, stream
from ..models.reduced.touches import spreading
from ..models.solution import reading_difference
from ..press.batch import PressBatch
from ..press.press import parse_press
from ..scene.parts import SceneParts, Setup, Skin
from .creeping import at_sweep_end
from .drawn_presses import Presses, drawn_presses
from .skin_model import SkinFamily, nominal_skin
from .touch_places import cell_presses_by_triangles

SAMPLE = 16


def rasterization_error(parts: SceneParts, family: SkinFamily, seed: int, rtol: float) -> float:
    """Largest relative error of readings by rasterizing touches on cells, for a sample of presses.

    The skin is the scene's nominal one; creeping foam is compared at the end of a sweep. If a
    tension spreads presses, the error includes `lattice_error` and the safety factor SAMPLED.
    """
    presses = _sample(parts, family, seed)
    creeps = bool(parts.skin.foam.in_time)
    batch = at_sweep_end(parts, presses.batch) if creeps else presses.batch
    on_cells = _answers(parts.skin, parts.setup, family, batch)
    texts = (parse_press(text, np.nan) for text in presses.text)
    if creeps:
        _, whole = reading_moments(parts)
        texts = (FoamState(parts.skin).then(press, 0.0).after(whole) for press in texts)
    return (SAMPLED if spreading(parts.skin, parts.plan.press) else 1.0) * error_against_solver(
        parts, texts, on_cells, rtol
    )


def lattice_error(parts: SceneParts, family: SkinFamily, seed: int) -> float:
    """Relative error of readings by solving deflections on a lattice, for a sample of presses.

    The reference is the membrane on triangles, rasterized on the same cells.
    """
    presses = _sample(parts, family, seed)
    assert presses.placed is not None
    on_cells = _answers(parts.skin, parts.setup, family, presses.batch)
    traced = cell_presses_by_triangles(parts.skin, parts.plan, presses.placed, family.grid)
    exact = _answers(parts.skin, parts.setup, family, traced)
    return SAMPLED * float(reading_difference(on_cells, exact, parts.setup.kind).max())


def _sample(parts: SceneParts, family: SkinFamily, seed: int) -> Presses:
    return drawn_presses(parts, stream(seed, 0, CELLS), SAMPLE, family.grid)


def _answers(skin: Skin, setup: Setup, family: SkinFamily, batch: PressBatch) -> Complex:
    """Readings of presses on the nominal skin, (press, interface, frequency)."""
    Z = nominal_skin(skin, family).sweeps(batch)
    return setup.at_meter(Z)
