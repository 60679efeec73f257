"""The few numbers that a skin and its leads differ in from a scene's, and what each stands for."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from simulator.frequency import Loss
from simulator.leads import Leads
from simulator.scene import Foam, Scene
from simulator.sweeps import InputError
from simulator.variation import Variation

FACTORS = {
    "sheet_resistance": "both sheets' resistance",
    "sheet_mismatch": "the top sheet's resistance over the bottom's",
    "capacitance": "capacitance of all the foam",
    "contact_resistance": "resistance of all contacts",
}
"""Parameters counted by the logarithm of a factor on the scene's own value."""
VALUES = {
    "loss_tangent": "(tan d)",
    "phase_exponent": "(1: ideal)",
    "lead_resistance": "ohm",
    "lead_inductance": "H",
    "stray_capacitance": "F",
}
"""Parameters counted as they are, and their units."""
PARAMETERS = (*FACTORS, *VALUES)


def own_values(scene: Scene) -> dict[str, float]:
    """The scene's own parameters."""
    foam, leads = scene.skin.foam, scene.leads
    values = (
        foam.loss_tangent,
        foam.phase_exponent,
        leads.resistance,
        leads.inductance,
        leads.unguarded,
    )
    return dict.fromkeys(FACTORS, 0.0) | dict(zip(VALUES, values, strict=True))


def all_values(scene: Scene, given: Mapping[str, float] | None) -> dict[str, float]:
    """Those given, and the scene's own for the others. Raises InputError for an unknown name."""
    for name in given or {}:
        if name not in PARAMETERS:
            raise InputError(f"`parameter` must be one of {', '.join(PARAMETERS)}, got {name!r}")
    return own_values(scene) | dict(given or {})


def loss_of(values: Mapping[str, float]) -> Loss:
    """The foam's losses."""
    return Loss(values["loss_tangent"], values["phase_exponent"])


def leads_of(values: Mapping[str, float]) -> Leads:
    """The leads."""
    return Leads(
        resistance=values["lead_resistance"],
        inductance=values["lead_inductance"],
        stray_capacitance=values["stray_capacitance"],
    )


def variation_of(scene: Scene, values: Mapping[str, float]) -> Variation:
    """The skin, as factors on the scene's: half of a mismatch of sheets up, half of it down."""
    common, half = math.exp(-values["sheet_resistance"]), values["sheet_mismatch"] / 2
    return Variation(
        top=np.array([common * math.exp(-half)]),
        bottom=np.array([common * math.exp(half)]),
        films=np.full(len(scene.contacts), math.exp(-values["contact_resistance"])),
        capacitance=np.full(
            (scene.pixels.rows, scene.pixels.columns), math.exp(values["capacitance"])
        ),
        loss=loss_of(values),
    )


def scene_with(scene: Scene, given: Mapping[str, float]) -> Scene:
    """The scene with these parameters. Raises InputError for an unknown name."""
    values = all_values(scene, given)
    skin, half = scene.skin, values["sheet_mismatch"] / 2
    sheets = {
        name: sheet.model_copy(
            update={
                "sheet_resistance": sheet.sheet_resistance
                * math.exp(values["sheet_resistance"] + turn)
            }
        )
        for name, sheet, turn in (("top", skin.top, half), ("bottom", skin.bottom, -half))
    }
    foam = Foam(
        capacitance_per_area=skin.foam.rest_capacitance_per_area * math.exp(values["capacitance"]),
        loss_tangent=values["loss_tangent"],
        phase_exponent=values["phase_exponent"],
    )
    film = math.exp(values["contact_resistance"])
    contacts = tuple(
        contact.model_copy(update={"resistance": contact.resistance * film})
        for contact in scene.contacts
    )
    changed = skin.model_copy(update={**sheets, "foam": foam})
    return scene.model_copy(
        update={"skin": changed, "contacts": contacts, "leads": leads_of(values)}
    )
