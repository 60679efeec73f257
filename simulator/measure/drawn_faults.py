"""Random faults of the sessions of a data set."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np

from ..arrays import Real
from ..press.pixels import pixels_with_skin
from ..scene.draws.randomisation import FaultOdds
from ..scene.parts import Plan, SceneParts, Skin
from ..scene.readings.contacts import EDGES
from .skin_faults import AgedGain, DeadFoil, HalfFoil, SkinFault, StuckSpot, TornSheet
from .skins import FAULT, TEAR, DrawnSkin, drawn_skin, stream

MIDDLE = 0.1, 0.9
"""Range of the place of a tear along its edge."""

Item = TypeVar("Item")


def drawn_fault(skin: Skin, plan: Plan, seed: int, session: int) -> SkinFault | None:
    """Random fault of a session, if it has one. Other draws of the session do not change."""
    odds = plan.draws.session.faults
    if odds is None:
        return None
    which, place, further, *sizes = stream(seed, session, FAULT).random(5)
    number = int(np.searchsorted(np.cumsum(list(odds.odds.values())), which, side="right"))
    kind = [*odds.odds, None][number]
    if kind == "dead_foil":
        return DeadFoil(_one_of(skin.foils, place).name)
    if kind == "half_foil":
        return HalfFoil(_one_of(skin.foils, place).name, _one_of(("low", "high"), further))
    if kind == "tear":
        return drawn_tear(skin, odds, seed, int(place * odds.tears))
    if kind == "stuck_spot":
        factor = _rounded(odds.stuck_factor.at(further))
        return StuckSpot(*_one_of(pixels_with_skin(skin), place), factor)
    if kind == "aged_gain":
        low, high = (_rounded(odds.gain_factor.at(each)) for each in sizes)
        return AgedGain(low, high)
    return None


def faulty_skin(
    parts: SceneParts, seed: int, session: int, grid: tuple[int, int], modes: int
) -> tuple[DrawnSkin, SkinFault | None]:
    """Random skin of a session, with the stuck spot that it may have, and its fault."""
    skin = drawn_skin(parts, seed, session, grid, modes)
    fault = drawn_fault(parts.skin, parts.plan, seed, session)
    if not isinstance(fault, StuckSpot):
        return skin, fault
    capacitance = skin.variation.capacitance * fault.foam(parts.skin, grid)
    return replace(skin, variation=replace(skin.variation, capacitance=capacitance)), fault


def drawn_tear(skin: Skin, odds: FaultOdds, seed: int, number: int) -> TornSheet:
    """One of the different tears of a data set, by its number from 0."""
    sheet, edge, at, length = stream(seed, number, TEAR).random(4)
    one = "top" if skin.one_conductor else _one_of(("top", "bottom"), sheet)
    sheets = one if odds.torn_sheets == "one" or skin.one_conductor else "both"
    along = MIDDLE[0] + (MIDDLE[1] - MIDDLE[0]) * at
    longest = odds.tear_length.at(length)
    return TornSheet(sheets, _one_of(EDGES, edge), _rounded(along), _rounded(longest))  # type: ignore[arg-type]


def _rounded(value: float | Real) -> float:
    """The value that the text of a fault gives."""
    return float(f"{float(value):.4g}")


def _one_of(items: Sequence[Item], chance: float) -> Item:
    return items[int(chance * len(items))]
