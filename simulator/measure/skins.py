"""Random skin of a session: sheets, foam, contacts and leads, from its own random generators."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from ..arrays import Real
from ..models.parameters import HALF_WAVES, Variation, mode_values
from ..press.pixels import cell_centres, pixels_with_skin
from ..scene.contacts import EDGES
from ..scene.foam import AMBIENT, ambient_factors
from ..scene.meter import Leads
from ..scene.parts import Plan, SceneParts, Skin
from ..scene.randomisation import CUT, AnyDistribution, FaultOdds, truncated_normal
from .skin_faults import AgedGain, DeadFoil, HalfFoil, SkinFault, StuckSpot, TornSheet

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


SKIN, PRESSES, METER, AUDIT, CELLS, ORDER, FAULT, TEAR = range(8)


def stream(seed: int, session: int, purpose: int) -> np.random.Generator:
    """Random generator of one purpose (such as SKIN or METER) in one session."""
    return np.random.Generator(
        np.random.Philox(np.random.SeedSequence(seed, spawn_key=(session, purpose)))
    )


@dataclass(frozen=True)
class DrawnSkin:
    """A session's skin and leads, as factors on the scene's (see `Variation`)."""

    variation: Variation
    leads: Leads


def drawn_skin(
    parts: SceneParts, seed: int, session: int, grid: tuple[int, int], modes: int
) -> DrawnSkin:
    """Random skin of a session.

    grid: rows and columns of the capacitance's cells, multiples of the pixels'. modes: number of
    modes of a sheet's conductance, of HALF_WAVES.
    """
    drawn, random = parts.plan.draws.session, stream(seed, session, SKIN)
    foam = parts.skin.foam
    common, top, bottom, c, loss, stray, lead = random.random(7)
    draws = random.random((2, len(HALF_WAVES) - 1))
    contacts = random.random(len(parts.skin.contacts))
    own_foam = _foam(parts.skin, parts.plan, random, grid)
    of_foam, of_sheets = _ambient(parts.skin, parts.plan, random)
    common_c = float(drawn.capacitance.at(c)) * of_foam
    variation = Variation(
        _conductance(parts.plan, common, top, draws[0], modes) / of_sheets,
        _conductance(parts.plan, common, bottom, draws[1], modes) / of_sheets,
        1 / drawn.contact_resistance.at(contacts),
        common_c * own_foam,
        foam.loss._replace(tangent=foam.loss_tangent + float(drawn.loss_tangent.at(loss))),
        common_c,
        *(_factor(each, random) for each in (drawn.body, drawn.rim)),
    )
    leads = Leads(
        resistance=parts.setup.leads.resistance + float(drawn.lead_resistance.at(lead)),
        inductance=parts.setup.leads.inductance,
        stray_capacitance=parts.setup.leads.unguarded + float(drawn.stray_capacitance.at(stray)),
    )
    return DrawnSkin(variation, leads)


def _ambient(skin: Skin, plan: Plan, random: np.random.Generator) -> tuple[float, float]:
    """Factors of the session's temperature and humidity on capacitance and on sheet resistance.

    Drawn last, and only if they are named, so that no other draw changes.
    """
    both = np.ones(2)
    for name in AMBIENT:
        drawn = getattr(plan.draws.session, name)
        if drawn is not None:
            table, state = getattr(skin.foam, name), float(drawn.at(random.random()))
            both *= ambient_factors(table, state, f"dataset.session.{name}")
    return float(both[0]), float(both[1])


def _factor(drawn: AnyDistribution | None, random: np.random.Generator) -> float:
    """A draw; 1, without a random number, if it is not drawn."""
    return 1.0 if drawn is None else float(drawn.at(random.random()))


def _conductance(plan: Plan, common: float, own: float, draws: Real, modes: int) -> Real:
    """Coefficients of a sheet's conductance over nominal, shape (mode,)."""
    drawn = plan.draws.session
    resistance = drawn.sheet_resistance.at(common) * drawn.sheet_mismatch.at(own)
    slow = drawn.unevenness * truncated_normal(draws, CUT)
    return np.concatenate([[1.0], slow])[:modes] / resistance


def _foam(skin: Skin, plan: Plan, random: np.random.Generator, grid: tuple[int, int]) -> NDArray:
    """Capacitance of the cells over that of the session's foam, shape `grid`."""
    drawn, (rows, columns) = plan.draws.session, grid
    pixels = skin.pixels.rows, skin.pixels.columns
    if drawn.foam_pattern == "smooth":
        slow = drawn.foam_spread * truncated_normal(random.random(len(HALF_WAVES) - 1), CUT)
        modes = mode_values(skin, cell_centres(skin, grid), len(HALF_WAVES))[1:]
        return 1 + np.einsum("k,kij", slow, modes)
    spread = drawn.foam_spread * truncated_normal(random.random(pixels), CUT)
    return np.kron(1 + spread, np.ones((rows // pixels[0], columns // pixels[1])))
