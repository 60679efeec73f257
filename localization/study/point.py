"""One point of a study: accuracy of a localizer on a data set, and separation of pixels."""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from ...simulator.arrays import Complex
from ...simulator.dataset.dataset_plan import DatasetPlan, check_cells
from ...simulator.dataset.drawn_presses import FIRST_BASELINES, pressed_pixels
from ...simulator.dataset.drawn_session import audited
from ...simulator.dataset.memory_dataset import in_memory
from ...simulator.dataset.skin_model import OtherSheets, SkinFamily, nominal_skin, reduced
from ...simulator.measure.experiment import own_presses
from ...simulator.measure.simulate import check_fits
from ...simulator.measure.skins import AUDIT, stream
from ...simulator.measure.symmetry import representative
from ...simulator.models.reduced.reduced_model import Reduced
from ...simulator.press.pixels import pixels_with_skin
from ...simulator.press.press import Press, every_press, pressed_factor
from ...simulator.scene.parts import Meter, Plan, Pressing, SceneParts, Skin
from ...simulator.scene.randomisation import DrawnPress
from ...simulator.sweeps import InputError
from ...simulator.sweeps.errors import named
from ..evaluation.evaluation import held_out_accuracies
from .separation import (
    TARGETS,
    Label,
    Separation,
    in_units_of_error,
    label_of,
    require_noise_for_study,
    separation,
)

FOLDS, MAX_RTOL = 5, 1e-4


SWEEPS = 2000
"""Number of sweeps of a draw, as in the data sets of the documentation."""
SESSIONS = 4
"""Minimum number of skins of a draw: one is tested by a localizer trained on three others."""
MAX_DECADES = 3.01
"""Range of sheet resistances that one family of skins is trained for."""
MAX_CACHED_FAMILIES = 4
"""Number of skin families that a process caches for further points."""
REST_EVERY = 5
"""Number of presses between sweeps of the unpressed skin, in draws of few presses."""


@dataclass(frozen=True)
class EvaluationSettings:
    """Settings by which every point is scored, on sweeps as `rcskin dataset` draws them.

    target: "column", "row" or "pixel". draws: number of independent draws of skins, presses and
    noise. repeated: True if the scene's `experiment.repetitions` sets the number of presses of each
    pixel; else a draw has SWEEPS sweeps.
    """

    target: str = "column"
    draws: int = 1
    repeated: bool = False

    def check(self, parts: SceneParts) -> None:
        """Raise InputError if a scene's presses cannot be drawn or scored."""
        if self.target not in TARGETS:
            raise InputError(
                f"{named('target')} must be one of {', '.join(TARGETS)}, got {self.target!r}"
            )
        if not 1 <= self.draws <= 1000:
            raise InputError(f"{named('draws')} must be from 1 to 1000, got {self.draws}")
        require_noise_for_study(parts.meter.readout)
        check_cells(parts.skin, parts.plan)
        nominal = self.nominal(parts.skin, parts.plan)
        sizes = Counter(label_of(press.pixel, self.target) for press in nominal)
        if len(sizes) < 2:
            raise InputError(
                f"need at least 2 classes of {named('target')} {self.target}, got {len(sizes)}"
            )
        least = min(sizes.values()) * parts.plan.repetitions
        if self.repeated and least < FOLDS:
            raise InputError(
                f"`experiment.repetitions` must give at least {FOLDS} presses of each class of "
                f"{named('target')} {self.target}, got {least}"
            )
        check_fits(parts.setup, self.plan(parts, 0, MAX_RTOL).sweeps)

    def plan(self, parts: SceneParts, draw: int, rtol: float) -> DatasetPlan:
        """Plan the data set of one draw.

        `dataset.session` sets the number of skins; there are at least SESSIONS. The strength of
        presses follows the scene's `press`, as for the bounds of `rcskin limits`, unless
        `dataset.press` sets it. Raises InputError as `Plan` does.
        """
        drawn, sweeps = parts.plan.draws, SWEEPS
        every = drawn.session.rest_every
        if self.repeated:
            share = drawn.press.touches[1] if len(drawn.press.touches) > 1 else 0.0
            pressed = parts.plan.repetitions * len(pixels_with_skin(parts.skin))
            every = every or REST_EVERY
            sweeps = (
                math.ceil(pressed / max(share, 0.1) * (1 + 1 / every)) + SESSIONS * FIRST_BASELINES
            )
        session = {
            "sweeps_per_session": min(drawn.session.sweeps_per_session, -(-sweeps // SESSIONS)),
            "rest_every": every,
        }
        unstated = drawn.press.factor is None and drawn.press.depth is None
        press = {"factor": own_presses(parts.skin, parts.plan.press)} if unstated else {}
        own = drawn.model_copy(
            update={
                "session": drawn.session.model_copy(update=session),
                "press": drawn.press.model_copy(update=press),
            }
        )
        plan = replace(parts.plan, draws=own)
        return DatasetPlan(replace(parts, plan=plan), sweeps, plan.seed + draw, rtol)

    def presses(self, plan: Plan) -> str:
        """The amount of data of each point, in words."""
        each = f"{plan.repetitions} presses of each pixel"
        amount = each if self.repeated else f"{SWEEPS} sweeps"
        return amount if self.draws == 1 else f"{self.draws} draws of {amount}"

    def unpressed(self, plan: Plan) -> float | None:
        """Weight of the unpressed skin in the accuracy; None: as often as it is drawn.

        Draws of few presses sweep it more often than a data set, which must not raise the accuracy.
        """
        none, one = (*plan.draws.press.touches, 0.0)[:2]
        return none / (none + one) if self.repeated and none + one > 0 else None

    def nominal(self, skin: Skin, plan: Plan) -> list[Press]:
        """One press of nominal strength for each pixel on the skin.

        The unpressed skin comes first if it is a class.
        """
        return every_press(skin, plan.press)[0 if plan.unpressed else 1 :]


@dataclass(frozen=True)
class PointFindings:
    """Findings at a point.

    accuracies: accuracy on each held-out part of each draw. separation: distances of the classes.
    """

    accuracies: tuple[float, ...]
    separation: Separation


def strength(skin: Skin, press: Press) -> float:
    """The capacitance factor under a press of one pixel; 1 for the unpressed skin."""
    return pressed_factor(skin, press.touches[0]) if press.touches else 1.0


def score_point(
    parts: SceneParts, trial: EvaluationSettings, skins: FamilyOfSkins
) -> PointFindings:
    """Draw a scene's sweeps, cross-validate a localizer on them, and separate the presses.

    Raises InputError if a draw has too few sweeps of a class.
    """
    rtol, family = skins.rtol, skins.at(parts.skin.top.sheet_resistance)
    nominal = trial.nominal(parts.skin, parts.plan)
    labels: list[Label] = [label_of(press.pixel, trial.target) for press in nominal]
    plans = [trial.plan(parts, draw, rtol) for draw in range(trial.draws)]
    Z = impedances(parts, nominal, family, rtol)
    reading = parts.setup
    readings = in_units_of_error(
        Z, parts.meter.readout, reading.frequency, reading.taken, reading.phases
    )
    unpressed = trial.unpressed(parts.plan)
    shares = [
        held_out_accuracies(in_memory(plan, family), trial.target, unpressed) for plan in plans
    ]
    return PointFindings(
        tuple(share for each in shares for share in each),
        separation(readings, labels, parts.setup.frequency),
    )


@dataclass(frozen=True)
class FamilyOfSkins:
    """What the skins of some points have in common, for one trained model.

    parts: of the scene with the largest resistance of the sheets, without what no skin depends on.
    resistances: of the points' sheets over that, ascending. rtol: tolerance of the sweeps.
    """

    parts: SceneParts
    resistances: tuple[float, ...]
    rtol: float

    def at(self, sheet_resistance: float) -> SkinFamily:
        """The skins of a point. sheet_resistance: of its top sheet, ohm/sq."""
        largest = self.parts.skin.top.sheet_resistance
        return OtherSheets(_trained(self), sheet_resistance / largest)


@lru_cache(maxsize=MAX_CACHED_FAMILIES)
def _trained(family: FamilyOfSkins) -> Reduced:
    return reduced(family.parts, family.rtol, family.resistances)


def families(
    points: Sequence[SceneParts], trial: EvaluationSettings, rtol: float
) -> list[FamilyOfSkins]:
    """The family of each point. Points whose skins differ by a factor on both sheets share one."""
    drawn = [_without_readings(trial.plan(each, 0, rtol).parts) for each in points]
    alike = defaultdict[SceneParts, list[int]](list)
    for k, parts in enumerate(drawn):
        alike[_with_unit_sheet(parts)].append(k)
    found = dict[int, FamilyOfSkins]()
    for group in alike.values():
        resistance = np.array([drawn[k].skin.top.sheet_resistance for k in group])
        decades = np.log10(resistance / resistance.min())
        count = math.ceil(decades.max() / MAX_DECADES)
        ends = np.linspace(0, decades.max(), count + 1)
        part = np.searchsorted(ends[1:-1], decades)
        for each in np.unique(part):
            some = np.flatnonzero(part == each)
            largest = some[resistance[some].argmax()]
            factors = np.unique(resistance[some] / resistance[largest]).tolist()
            family = FamilyOfSkins(drawn[group[largest]], tuple(factors), rtol)
            found |= dict.fromkeys((group[k] for k in some), family)
    return [found[k] for k in range(len(points))]


def _with_unit_sheet(parts: SceneParts) -> SceneParts:
    """The parts with a top sheet of 1 ohm/sq, and the same ratio of the sheets but for rounding."""
    top, bottom = parts.skin.top, parts.skin.bottom
    ratio = float(f"{bottom.sheet_resistance / top.sheet_resistance:.12g}")
    sheets = {
        "top": top.model_copy(update={"sheet_resistance": 1.0}),
        "bottom": bottom.model_copy(update={"sheet_resistance": ratio}),
    }
    return replace(parts, skin=parts.skin.with_parts(**sheets))


def _without_readings(parts: SceneParts) -> SceneParts:
    """The parts with defaults for everything on which their family of skins does not depend."""
    press, own = parts.plan.press, parts.plan.draws.press
    kept = {name: getattr(own, name) for name in ("touches", "finger", "without_press")}
    drawn = {"press": DrawnPress(place="pixel", **kept)}
    same = own.place == "pixel" and own.offset == 0
    if press.by_factor:
        press = Pressing(capacitance_factor=2.0, finger=press.finger)
        drawn = drawn if same else {}
    else:
        drawn = {}
    plan = Plan(press=press, draws=parts.plan.draws.model_copy(update=drawn))
    return replace(parts, skin=replace(parts.skin, name=""), meter=Meter(), plan=plan)


def impedances(
    parts: SceneParts, presses: Sequence[Press], family: SkinFamily, rtol: float
) -> Complex:
    """Z in ohm of presses on the scene's own skin, as in a data set.

    presses: presses of one pixel or none. Shape (press, interface, frequency); pixels that mirror
    each other have the same Z.
    """
    of = representative(parts.skin, parts.setup, parts.plan.press)
    strengths = {of(press.pixel): strength(parts.skin, press) for press in presses}
    pixels = np.array(list(strengths)) - 1
    factor = np.array(list(strengths.values()))
    pressed = pressed_pixels(parts, pixels, factor, family.grid)
    random = stream(parts.plan.seed, 0, AUDIT)
    Z, _ = audited(nominal_skin(parts.skin, family), pressed, random, 0, rtol)
    number = {pixel: k for k, pixel in enumerate(strengths)}
    found = Z[[number[of(press.pixel)] for press in presses]]
    return parts.setup.at_meter(found)
