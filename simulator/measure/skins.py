"""Random skin of a session: sheets, foam, contacts and leads."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays import Real
from ..models.parameters import HALF_WAVES, Variation, mode_values
from ..press.pixels import cell_centres
from ..scene.draws.draw_distributions import AnyDistribution, truncated_normal
from ..scene.draws.randomisation import CUT
from ..scene.foam.foam_in_time import AMBIENT, ambient_factors
from ..scene.readout.meter import Leads
from ..scene.scene import Scene
from .streams import SKIN, stream


@dataclass(frozen=True)
class DrawnSkin:
    """A session's skin and leads, as factors on the scene's (see `Variation`)."""

    variation: Variation
    leads: Leads


def drawn_skin(
    scene: Scene, seed: int, session: int, grid: tuple[int, int], modes: int
) -> DrawnSkin:
    """Random skin of a session.

    grid: rows and columns of the capacitance's cells, multiples of the pixels'. modes: number of
    modes of a sheet's conductance, of HALF_WAVES.
    """
    drawn, random = scene.dataset.session, stream(seed, session, SKIN)
    foam = scene.skin.foam
    common, top, bottom, c, loss, stray, lead = random.random(7)
    draws = random.random((2, len(HALF_WAVES) - 1))
    contacts = random.random(len(scene.contacts))
    own_foam = _foam(scene, random, grid)
    of_foam, of_sheets = _ambient(scene, random)
    common_c = float(drawn.capacitance.at(c)) * of_foam
    variation = Variation(
        _conductance(scene, common, top, draws[0], modes) / of_sheets,
        _conductance(scene, common, bottom, draws[1], modes) / of_sheets,
        1 / drawn.contact_resistance.at(contacts),
        common_c * own_foam,
        foam.loss._replace(tangent=foam.loss_tangent + float(drawn.loss_tangent.at(loss))),
        common_c,
        *(_factor(each, random) for each in (drawn.body, drawn.rim)),
    )
    leads = Leads(
        resistance=scene.leads.resistance + float(drawn.lead_resistance.at(lead)),
        inductance=scene.leads.inductance,
        stray_capacitance=scene.leads.unguarded + float(drawn.stray_capacitance.at(stray)),
    )
    return DrawnSkin(variation, leads)


def _ambient(scene: Scene, random: np.random.Generator) -> tuple[float, float]:
    """Factors of the session's temperature and humidity on capacitance and on sheet resistance.

    Drawn last, and only if they are named, so that no other draw changes.
    """
    both = np.ones(2)
    for name in AMBIENT:
        drawn = getattr(scene.dataset.session, name)
        if drawn is not None:
            table, state = getattr(scene.skin.foam, name), float(drawn.at(random.random()))
            both *= ambient_factors(table, state, f"dataset.session.{name}")
    return float(both[0]), float(both[1])


def _factor(drawn: AnyDistribution | None, random: np.random.Generator) -> float:
    """A draw; 1, without a random number, if it is not drawn."""
    return 1.0 if drawn is None else float(drawn.at(random.random()))


def _conductance(scene: Scene, common: float, own: float, draws: Real, modes: int) -> Real:
    """Coefficients of a sheet's conductance over nominal, shape (mode,)."""
    drawn = scene.dataset.session
    resistance = drawn.sheet_resistance.at(common) * drawn.sheet_mismatch.at(own)
    slow = drawn.unevenness * truncated_normal(draws, CUT)
    return np.concatenate([[1.0], slow])[:modes] / resistance


def _foam(scene: Scene, random: np.random.Generator, grid: tuple[int, int]) -> NDArray:
    """Capacitance of the cells over that of the session's foam, shape `grid`."""
    drawn, (rows, columns) = scene.dataset.session, grid
    pixels = scene.pixels.rows, scene.pixels.columns
    if drawn.foam_pattern == "smooth":
        slow = drawn.foam_spread * truncated_normal(random.random(len(HALF_WAVES) - 1), CUT)
        modes = mode_values(scene, cell_centres(scene.parts.skin, grid), len(HALF_WAVES))[1:]
        return 1 + np.einsum("k,kij", slow, modes)
    spread = drawn.foam_spread * truncated_normal(random.random(pixels), CUT)
    return np.kron(1 + spread, np.ones((rows // pixels[0], columns // pixels[1])))
