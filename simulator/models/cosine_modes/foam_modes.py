"""Slow unevenness of the foam: half waves over the skin that its capacitance goes with."""

from __future__ import annotations

from collections.abc import Mapping

from ...scene.maps import Grid
from ...scene.scene import Scene
from ...sweeps import InputError
from ..parameters import FOAM_MODES
from .amplitudes import modes_at, nearest_map


def with_foam_modes(scene: Scene, values: Mapping[str, float]) -> Scene:
    """The scene with the waves among the values as a map of its foam."""
    if not any(values.get(name) for name in FOAM_MODES):
        return scene
    foam = scene.skin.foam.model_copy(update={"map": map_of(scene, values)})
    return scene.model_copy(update={"skin": scene.skin.model_copy(update={"foam": foam})})


def map_of(scene: Scene, values: Mapping[str, float]) -> Grid:
    """The waves as a map, whose mean over the sides is 1."""
    return nearest_map(scene, lambda x: modes_at(scene, values, FOAM_MODES, x))


def check_uniform_foam(scene: Scene) -> None:
    """Raises InputError where waves of the foam cannot be told apart from what the scene has, or
    change more than its capacitance."""
    if scene.skin.foam.map is not None:
        raise InputError(
            f"{scene.name}: slow waves of the foam are fitted to foam without `skin.foam.map` alone"
        )
    if scene.surroundings is not None and scene.surroundings.thickness:
        raise InputError(
            f"{scene.name}: slow waves of the foam are fitted without `surroundings.thickness`, as "
            "they would change the field across the foam, too; leave it out"
        )
    if not scene.press.by_factor:
        raise InputError(
            f"{scene.name}: slow waves of the foam are fitted to presses by "
            "`press.capacitance_factor` alone, got `press.depth`"
        )
