"""Error of a sensor's readings by its model and its cells, estimated with random presses."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ..arrays import Real
from ..dataset.drawn_presses import drawn_presses
from ..dataset.skin_model import nominal_skin
from ..models.reduced.reduced_model import Reduced
from ..models.solution import reading_difference
from ..models.solver import Solver
from ..press.batch import PressBatch
from ..press.press import parse_press
from ..scene.parts import SceneParts
from .cell_spreading import SkinCells
from .skin_family import FAMILIES_KEPT, family_parts, highest_factor, trained_family

SAMPLE = 8
BEYOND_SAMPLE = 2.0
"""Largest error of all presses over that of a sample: of 160 presses it was 2.6 times the median
of samples at most."""
TRUTH_SHARE = 0.1
"""Tolerance of the full model over that of the sensor."""


@lru_cache(maxsize=FAMILIES_KEPT)
def estimated_error(parts: SceneParts, drawn: bool, rtol: float) -> float:
    """Estimated largest relative error of readings of a scene's sensor, without its meter.

    It is BEYOND_SAMPLE times the largest error of a sample of touches on the nominal skin, against
    the full model. drawn, rtol: see `family_parts`.
    """
    own = family_parts(parts, drawn, rtol)
    errors = press_errors(parts, own, trained_family(own, rtol), SAMPLE, rtol)
    return BEYOND_SAMPLE * float(errors.max())


def press_errors(
    parts: SceneParts,
    own: SceneParts,
    family: Reduced,
    count: int,
    rtol: float,
    seed: int = 0,
) -> Real:
    """Relative errors of readings of random touches, shape (press,).

    own: the parts of the family, which draws the touches. Presses that a sensor refuses because
    touches overlap are left out.
    """
    cells = SkinCells.of(parts.skin, family.grid)
    highest = highest_factor(parts.skin, parts.plan)
    presses = drawn_presses(own, np.random.default_rng(seed), count, cells.fine)
    texts, batch = presses.text, presses.batch
    some = [k for k in range(count) if batch.one(k).rises.max(initial=0.0) <= highest - 1]
    spread = cells.spread(PressBatch.of(batch.one(k) for k in some))
    found = parts.setup.at_meter(nominal_skin(own.skin, family).sweeps(spread))
    solver = Solver(parts, TRUTH_SHARE * rtol)
    exact = [solver.solve(parse_press(texts[k], np.nan)).Z for k in some]
    errors = reading_difference(found, np.stack(exact), parts.setup.kind)
    return np.asarray(np.nanmax(errors, axis=(0, 2, 3)))
