"""Spread of a skin's parameters over the sessions of a data set."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..arrays import Real
from ..scene.foam import AMBIENT
from ..scene.parts import Plan, SceneParts, Skin
from ..scene.randomisation import AnyDistribution
from .parameters import own_values


class SessionSpread(NamedTuple):
    """Mean and standard deviation over sessions of a parameter's difference from the scene."""

    shift: float
    deviation: float


QUANTILES = (np.arange(4001) + 0.5) / 4001


def session_spreads(parts: SceneParts) -> dict[str, SessionSpread]:
    """Spread of every parameter of a scene over sessions of [dataset.session]; 0 if not drawn.

    Temperature and humidity contribute independently to the sheets' resistance and to the foam's
    capacitance. The factors of both sheets are independent: half of each belongs to their common
    resistance. The factors of contacts with a resistance are independent: their mean counts.
    """
    drawn = parts.plan.draws.session
    weather = _of_ambient(parts.skin, parts.plan)
    both = _with(_of_logarithm(drawn.sheet_resistance), weather["sheet_resistance"])
    own = _of_logarithm(drawn.sheet_mismatch)
    film = _of_logarithm(drawn.contact_resistance)
    films = sum(not contact.ideal for contact in parts.skin.contacts)
    surrounding = {
        name: _of_logarithm(factor)
        for name, factor in (("body", drawn.body), ("rim", drawn.rim))
        if factor is not None
    }
    return dict.fromkeys(own_values(parts.skin, parts.setup), SessionSpread(0.0, 0.0)) | {
        "sheet_resistance": SessionSpread(
            both.shift + own.shift, math.hypot(both.deviation, own.deviation / math.sqrt(2))
        ),
        "sheet_mismatch": SessionSpread(0.0, math.sqrt(2) * own.deviation),
        "capacitance": _with(_of_logarithm(drawn.capacitance), weather["capacitance"]),
        "contact_resistance": SessionSpread(film.shift, film.deviation / math.sqrt(max(films, 1))),
        "loss_tangent": _of_value(drawn.loss_tangent),
        "lead_resistance": _of_value(drawn.lead_resistance),
        "stray_capacitance": _of_value(drawn.stray_capacitance),
        **surrounding,
    }


def _of_ambient(skin: Skin, plan: Plan) -> dict[str, list[SessionSpread]]:
    """Spreads of capacitance and sheet resistance by the drawn temperature and humidity."""
    drawn, foam = plan.draws.session, skin.foam
    states = [(getattr(foam, name), getattr(drawn, name)) for name in AMBIENT]
    return {
        key: [
            _spread(np.log1p(getattr(table, key) * (state.at(QUANTILES) - table.reference)))
            for table, state in states
            if state is not None
        ]
        for key in ("capacitance", "sheet_resistance")
    }


def _with(one: SessionSpread, others: list[SessionSpread]) -> SessionSpread:
    """Spread of a sum of independent draws."""
    every = [one, *others]
    return SessionSpread(
        sum(each.shift for each in every), math.hypot(*(e.deviation for e in every))
    )


def _of_value(drawn: AnyDistribution) -> SessionSpread:
    return _spread(drawn.at(QUANTILES))


def _of_logarithm(drawn: AnyDistribution) -> SessionSpread:
    return _spread(np.log(drawn.at(QUANTILES)))


def _spread(values: Real) -> SessionSpread:
    """Spread of these values; exactly 0 deviation if all are equal."""
    return SessionSpread(float(values.mean()), float(values.std()) if np.ptp(values) else 0.0)
