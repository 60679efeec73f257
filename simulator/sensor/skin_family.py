"""Family of skins that a sensor draws from: a scene's skins under touches anywhere on cells."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np

from ..arrays import Real
from ..dataset.dataset_plan import MAX_CELLS, DatasetPlan
from ..dataset.drawn_presses import drawn_presses
from ..dataset.skin_model import nominal_skin, reduced
from ..measure.skins import drawn_skin
from ..models.reduced.cases import Case
from ..models.reduced.compressing import COMPRESSED_SHARE, compressed
from ..models.reduced.reduced_model import Reduced
from ..models.solution import reading_difference
from ..models.solver import Solver
from ..press.batch import PressBatch
from ..press.foam_creep import Creep
from ..press.press import parse_press
from ..scene.parts import Plan, Pressing, SceneParts, Setup, Skin
from ..scene.randomisation import DrawnPress, Fixed, Randomisation, Session, Uniform
from ..sweeps import InputError
from .cell_spreading import SkinCells

STRONGEST, BY_FOAM = 4.0, 8.0
"""Largest factor on c that training includes; a scene that draws larger ones, or whose foam allows
them up to BY_FOAM, extends it."""
SMALLEST, LARGEST = 0.25, 0.5
"""Smallest touch in training over a pixel's side, and the largest over the skin's shorter side."""
TOUCHES, ON_CREEPING_FOAM = (0.05, 0.45, 0.5), (0.1, 0.9)
"""Probabilities of 0, 1 and 2 touches; presses on creeping foam leave traces for later ones."""
FAMILIES_KEPT = 8
TRAINED_TO = 3.0
"""Tolerance of the training over that of the sensor. Training keeps a bound; the largest error of
40 random presses was a tenth of it."""
CREEPING_SHARE = 0.999
"""Largest factor on creeping foam over the one under which it reaches its greatest strain."""
RANK_SKINS, PRESSES_ON_SKIN = 8, 8
RANK_SHARE = 0.1
"""Share of the tolerance by which factors of lower rank may change readings."""
CELL_OF_DECAY, AT_RTOL = 0.3, 1e-3
"""Largest side of a cell over the length in which a potential decays, at a tolerance. Errors follow
the third power of the side. On 80 random presses 9 in 10 were below half the tolerance, and all
below it."""
CELLS_OF_SIDE = 4
"""Smallest number of cells along each side of the skin, as far as MAX_CELLS allows."""

NOMINAL = Session(
    sheet_resistance=Fixed(value=1.0),
    sheet_mismatch=Fixed(value=1.0),
    unevenness=0.0,
    capacitance=Fixed(value=1.0),
    foam_spread=0.0,
    loss_tangent=Fixed(value=0.0),
    contact_resistance=Fixed(value=1.0),
    stray_capacitance=Fixed(value=0.0),
    lead_resistance=Fixed(value=0.0),
)
"""Session without any variation."""


def family_parts(parts: SceneParts, drawn: bool, rtol: float) -> SceneParts:
    """The parts with the random touches and skins that its family is trained on.

    The cells are fine enough for a relative tolerance. drawn: True if skins vary as in
    `dataset.session`. Presses by depth or force become factors: cells take the factors that these
    cause.
    """
    skin, plan = parts.skin, parts.plan
    press, own = plan.press, plan.draws.press
    if not press.by_factor:
        press = Pressing(factor_spread=press.factor_spread, finger=press.finger)
    length, width = skin.sides
    pixel = min(length / skin.pixels.columns, width / skin.pixels.rows)
    touch = DrawnPress(
        touches=ON_CREEPING_FOAM if skin.foam.in_time else TOUCHES,
        place="anywhere",
        size=Uniform(low=SMALLEST * pixel, high=LARGEST * min(length, width)),
        cells_per_pixel=_cells_per_pixel(skin, parts.setup, plan, rtol),
        factor=Uniform(low=1.0, high=highest_factor(skin, plan)),
        finger=own.finger,
        without_press=own.without_press,
    )
    session = plan.draws.session if drawn else NOMINAL
    draws = Randomisation(press=touch, session=session)
    return replace(parts, plan=replace(plan, press=press, draws=draws))


def _cells_per_pixel(skin: Skin, setup: Setup, plan: Plan, rtol: float) -> int:
    """Cells along each side of a pixel; see CELL_OF_DECAY and CELLS_OF_SIDE.

    Raises InputError if a tolerance needs more cells than a model can be trained for.
    """
    omega = 2 * math.pi * float(setup.frequency[-1])
    c = highest_factor(skin, plan) * skin.foam.unpressed_capacitance_per_area
    decay = 1 / math.sqrt(omega * sum(skin.sheet_resistances) * c)
    largest = CELL_OF_DECAY * (rtol / AT_RTOL) ** (1 / 3) * decay
    counts, most = skin.pixels.shape[::-1], MAX_CELLS // max(skin.pixels.shape)
    sides = zip(skin.sides, counts, strict=True)
    needed = max(math.ceil(side / largest / count) for side, count in sides)
    if needed > most:
        raise InputError(
            f"{skin.name}: `rtol` must be larger: {rtol:g} needs {needed} cells along each side "
            f"of a pixel, and a sensor has at most {MAX_CELLS} along each side of the skin"
        )
    return max(needed, min(most, math.ceil(CELLS_OF_SIDE / min(counts))))


def highest_factor(skin: Skin, plan: Plan) -> float:
    """Largest factor on c that the family of a scene is trained on.

    Foam that creeps must stay within its greatest strain.
    """
    drawn, foam = plan.draws.press.factor, skin.foam
    highest = STRONGEST if drawn is None else max(STRONGEST, drawn.high)
    if foam.mechanics is not None:
        highest = max(highest, min(skin.max_factor, BY_FOAM))
    if not foam.in_time:
        return highest
    at_once = foam.greatest_strain / float(Creep.of(foam).greatest(np.zeros((0,)), np.array(1.0)))
    return min(highest, CREEPING_SHARE * float(foam.factor_at(np.array(at_once))))


@lru_cache(maxsize=FAMILIES_KEPT)
def trained_family(parts: SceneParts, rtol: float) -> Reduced:
    """Reduced model of a `family_parts`, trained once per process.

    Raises InputError for a scene that cannot be reduced, ToleranceError if rtol is not reached.
    """
    DatasetPlan(parts, 1, 0, rtol)
    model = reduced(parts, TRAINED_TO * rtol)
    return _with_lower_rank(parts, model, rtol)


def _with_lower_rank(parts: SceneParts, model: Reduced, rtol: float) -> Reduced:
    """Model whose factors of M have the lowest rank that RANK_SHARE allows."""
    random = np.random.default_rng(0)
    cases = []
    for session in range(RANK_SKINS):
        skin = drawn_skin(parts, 0, session, model.grid, model.modes)
        presses = drawn_presses(parts, random, PRESSES_ON_SKIN, model.grid).batch
        cases += [Case(skin.variation, *press) for press in presses.each()]
    looser = replace(model, rtol=RANK_SHARE / COMPRESSED_SHARE * rtol)
    return replace(compressed(looser, cases), rtol=model.rtol, built=model.built)


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
