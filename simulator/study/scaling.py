"""The law of scale: of two scenes, whether one's impedance follows from the other's.

Where all resistances, those of the sheets and those of the contacts, are a times as large and the
capacitance per area is b times as large, Z'(f) = a Z(a b f): with V the same, div(grad V / (a R)) =
s b c V is div(grad V / R) = (a b s) c V. Losses, outline, foils and pixels must be the same; of a
constant-phase capacitance s goes with f to the power of its exponent p, and f with (a b)^(1/p).
Leads do not scale: behind them only equal skins are alike.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from simulator.circuit import Circuit, one_field, two_fields
from simulator.scene import Scene

SAME = 1e-12
NOT_OF_THE_SKIN = {"name", "description", "press", "sweep", "readout", "experiment", "dataset"}
COUNTED_BY_THE_LAW: dict[str, Any] = {
    "skin": {
        "top": {"sheet_resistance"},
        "bottom": {"sheet_resistance"},
        "foam": {"capacitance_per_area", "thickness", "relative_permittivity"},
    },
    "contacts": {"__all__": {"resistance"}},
}


@dataclass(frozen=True)
class Scaling:
    """Z'(f) = impedance * Z(frequency * f)."""

    impedance: float
    frequency: float


class Skin:
    """What the impedance of a scene depends on, apart from the press and the frequencies."""

    def __init__(self, scene: Scene) -> None:
        excluded: Any = {**COUNTED_BY_THE_LAW, **dict.fromkeys(NOT_OF_THE_SKIN, True)}
        self._shape = scene.model_dump(exclude=excluded)
        self._resistances = _resistances(one_field(scene) or two_fields(scene))
        self._capacitance = scene.skin.foam.rest_capacitance_per_area
        self._exponent = scene.skin.foam.phase_exponent
        self._leads_ideal = scene.leads.ideal

    def follows_from(self, other: Skin) -> Scaling | None:
        """How this one's impedance follows from the other's; None where it does not by the law."""
        ratio = _ratio(self._resistances, other._resistances)
        if ratio is None or self._shape != other._shape:
            return None
        slower = ratio * self._capacitance / other._capacitance
        if not self._leads_ideal and (ratio, slower) != (1.0, 1.0):
            return None
        return Scaling(ratio, slower ** (1 / self._exponent))


def law_between(scene: Scene, other: Scene) -> Scaling | None:
    """How the impedance of `scene` follows from that of `other` for any press; None if it does not.

    Sheets and contacts enter as the model sees them: where one field is enough, only their sums of
    top and bottom.
    """
    return Skin(scene).follows_from(Skin(other))


def _resistances(circuit: Circuit) -> tuple[float, ...]:
    """Of each field, then of each contact; how many there are tells the number of fields."""
    sheets = (1 / conductance for conductance in circuit.conductance)
    films = (contact.resistance for contact in circuit.contacts)
    return (*sheets, *films)


def _ratio(resistances: tuple[float, ...], others: tuple[float, ...]) -> float | None:
    """What all of these are times the others; None where there is no one number."""
    if len(resistances) != len(others):
        return None
    ratio = resistances[0] / others[0]
    alike = all(
        math.isclose(one, ratio * other, rel_tol=SAME)
        for one, other in zip(resistances, others, strict=True)
    )
    return ratio if alike else None
