"""Cosine modes of the foam: slow variation of its capacitance over the skin."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from ...scene.maps.factor_maps import Grid
from ...scene.parts import Pressing, Skin
from ...sweeps import InputError
from ..parameters import FOAM_MODES
from .amplitudes import fitted_map, modes_at


def with_foam_modes(skin: Skin, values: Mapping[str, float]) -> Skin:
    """Skin with the modes among the values as a map of its foam."""
    if not any(values.get(name) for name in FOAM_MODES):
        return skin
    return replace(skin, foam=skin.foam.model_copy(update={"map": map_of(skin, values)}))


def map_of(skin: Skin, values: Mapping[str, float]) -> Grid:
    """Modes as a map whose mean over the sides is 1."""
    return fitted_map(skin, lambda x: modes_at(skin, values, FOAM_MODES, x))


def check_uniform_foam(skin: Skin, pressing: Pressing) -> None:
    """Raise InputError if modes of the foam cannot be identified, or change more than its
    capacitance."""
    if skin.foam.map is not None:
        raise InputError(
            f"{skin.name}: cosine modes of the foam are fitted only to foam without `skin.foam.map`"
        )
    if skin.around is not None and skin.around.thickness:
        raise InputError(
            f"{skin.name}: cosine modes of the foam are fitted without `surroundings.thickness`, "
            "as they would change the field across the foam, too; leave it out"
        )
    if not pressing.by_factor:
        raise InputError(
            f"{skin.name}: cosine modes of the foam are fitted only to presses "
            "by `press.capacitance_factor`, got `press.depth`"
        )
