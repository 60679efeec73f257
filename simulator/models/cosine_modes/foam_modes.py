"""Cosine modes of the foam: slow variation of its capacitance over the skin."""

from __future__ import annotations

from collections.abc import Mapping

from ...scene.maps.factor_maps import Grid
from ...scene.parts import Skin
from ...scene.pixel_grid import Pressing
from ...scene.scene import Scene
from ...sweeps import InputError
from ..parameters import FOAM_MODES
from .amplitudes import fitted_map, modes_at


def with_foam_modes(scene: Scene, values: Mapping[str, float]) -> Scene:
    """Scene with the modes among the values as a map of its foam."""
    if not any(values.get(name) for name in FOAM_MODES):
        return scene
    foam = scene.skin.foam.model_copy(update={"map": map_of(scene.parts.skin, values)})
    return scene.model_copy(update={"skin": scene.skin.model_copy(update={"foam": foam})})


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
