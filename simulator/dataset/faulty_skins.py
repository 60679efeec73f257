"""Skins with faults in a data set: the families that they are drawn from, and their draws."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from ..arrays import Complex
from ..measure.drawn_faults import drawn_fault
from ..measure.skin_faults import OPEN, SkinFault, StuckSpot
from ..models.parameters import Variation
from ..scene.draws.fault_odds import FaultOdds
from ..scene.scene import Scene
from .audit import Audit
from .dataset_plan import Plan
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


def family_scenes(plan: Plan) -> dict[str, Scene | None]:
    """Scenes of all families that the plan draws from, by name, in the order of the sessions.

    None where the fault leaves nothing to solve.
    """
    scene, odds = plan.scene, plan.scene.dataset.session.faults
    healthy = without_faults(scene)
    found: dict[str, Scene | None] = {NO_FAULT: healthy}
    for session in range(plan.sessions if odds else 0):
        fault = drawn_fault(scene.parts.skin, scene.parts.plan, plan.seed, session)
        name = family_name(fault)
        if fault is not None and name not in found:
            fault.check(scene.parts)
            stuck = isinstance(fault, StuckSpot)
            changed = None if stuck else fault.changed(healthy.parts)
            found[name] = _all_stuck(scene) if stuck else changed and changed.scene
    return found


def faulty_families(
    plan: Plan, train: Callable[[Scene, float], SkinFamily]
) -> Mapping[str, SkinFamily]:
    """Trained families of the faults that the plan draws, by name."""
    return {
        name: train(scene, plan.rtol)
        for name, scene in family_scenes(plan).items()
        if name != NO_FAULT and scene is not None
    }


def without_faults(scene: Scene) -> Scene:
    """The scene with sessions that have no faults."""
    return _with_odds(scene, None)


def answered_with(
    fault: SkinFault | None,
    scene: Scene,
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
    connected = fault.connected(scene.parts.setup)
    if not connected.any():
        shape = presses, len(connected), len(scene.frequencies)
        return np.full(shape, OPEN, dtype=complex), Audit(0, 0, 0.0)
    found, audit = answer(
        replace(variation, films=variation.films[fault.remaining(scene.parts.skin)])
    )
    Z = np.full((len(found), len(connected), found.shape[2]), OPEN, dtype=complex)
    Z[:, connected] = found
    return Z, audit


def _all_stuck(scene: Scene) -> Scene:
    """The scene with a stuck spot in every session."""
    odds = scene.dataset.session.faults
    assert odds is not None
    return _with_odds(
        scene,
        odds.model_copy(update={**dict.fromkeys(odds.odds, 0.0), "stuck_spot": 1.0}),
    )


def _with_odds(scene: Scene, odds: FaultOdds | None) -> Scene:
    session = scene.dataset.session.model_copy(update={"faults": odds})
    dataset = scene.dataset.model_copy(update={"session": session})
    return scene.model_copy(update={"dataset": dataset})
