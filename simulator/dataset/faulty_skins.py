"""Skins with faults in a data set: the families that they are drawn from, and their draws."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from ..arrays import Complex
from ..measure.skin_faults import OPEN, SkinFault, StuckSpot
from ..measure.skins import drawn_fault
from ..models.parameters import Variation
from ..scene.parts import SceneParts, Setup, Skin
from ..scene.randomisation import FaultOdds
from .audit import Audit
from .dataset_plan import DatasetPlan
from .skin_model import SkinFamily

NO_FAULT = ""
"""Name of the family of skins whose sheets, foils and foam have no fault."""


def family_name(fault: SkinFault | None) -> str:
    """Name of the family that a skin with this fault belongs to.

    A reader's fault changes no skin. All stuck spots have one family.
    """
    if fault is None or not fault.place:
        return NO_FAULT
    return fault.kind if isinstance(fault, StuckSpot) else str(fault)


def family_parts(plan: DatasetPlan) -> dict[str, SceneParts | None]:
    """Parts of all families that the plan draws from, by name, in the order of the sessions.

    None where the fault leaves nothing to solve.
    """
    parts, odds = plan.parts, plan.parts.plan.draws.session.faults
    healthy = without_faults(parts)
    found: dict[str, SceneParts | None] = {NO_FAULT: healthy}
    for session in range(plan.sessions if odds else 0):
        fault = drawn_fault(parts.skin, parts.plan, plan.seed, session)
        name = family_name(fault)
        if fault is not None and name not in found:
            fault.check(parts)
            stuck = isinstance(fault, StuckSpot)
            found[name] = _all_stuck(parts) if stuck else fault.changed(healthy)
    return found


def faulty_families(
    plan: DatasetPlan, train: Callable[[SceneParts, float], SkinFamily]
) -> Mapping[str, SkinFamily]:
    """Trained families of the faults that the plan draws, by name."""
    return {
        name: train(parts, plan.rtol)
        for name, parts in family_parts(plan).items()
        if name != NO_FAULT and parts is not None
    }


def without_faults(parts: SceneParts) -> SceneParts:
    """The parts with sessions that have no faults."""
    return _with_odds(parts, None)


def answered_with(
    fault: SkinFault | None,
    skin: Skin,
    setup: Setup,
    variation: Variation,
    answer: Callable[[Variation], tuple[Complex, Audit]],
    presses: int,
) -> tuple[Complex, Audit]:
    """Z in ohm of a session at all interfaces, OPEN where the fault leaves them open, and its
    audit.

    answer: function of the variation of the foils that remain; it gives Z at the interfaces that
    remain, shape (press, interface, frequency).
    """
    if fault is None:
        return answer(variation)
    connected = fault.connected(setup)
    if not connected.any():
        shape = presses, len(connected), len(setup.frequency)
        return np.full(shape, OPEN, dtype=complex), Audit(0, 0, 0.0)
    found, audit = answer(replace(variation, films=variation.films[fault.remaining(skin)]))
    Z = np.full((len(found), len(connected), found.shape[2]), OPEN, dtype=complex)
    Z[:, connected] = found
    return Z, audit


def _all_stuck(parts: SceneParts) -> SceneParts:
    """The parts with a stuck spot in every session."""
    odds = parts.plan.draws.session.faults
    assert odds is not None
    changed = {**dict.fromkeys(odds.odds, 0.0), "stuck_spot": 1.0}
    return _with_odds(parts, odds.model_copy(update=changed))


def _with_odds(parts: SceneParts, odds: FaultOdds | None) -> SceneParts:
    draws = parts.plan.draws
    session = draws.session.model_copy(update={"faults": odds})
    draws = draws.model_copy(update={"session": session})
    return replace(parts, plan=replace(parts.plan, draws=draws))
