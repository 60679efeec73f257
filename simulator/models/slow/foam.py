"""Slow unevenness of the foam: half waves over the skin that its capacitance goes with."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...mesh.held import held
from ...scene.maps import Grid
from ...scene.scene import Scene
from ...sweeps import InputError
from ..parameters import FOAM_WAVES, WAVES, Variation, mode_values
from .waves import amplitudes, nearest_map, waves_at


def of_pixels(scene: Scene) -> NDArray[np.float64]:
    """Each wave at the middle of the skin of each pixel, shape (wave, row, column)."""
    middles = held(scene).middle
    return mode_values(scene, middles, len(WAVES)).reshape(-1, *scene.pixels.shape)


def uneven(even: Variation, values: Mapping[str, float], waves: NDArray[np.float64]) -> Variation:
    """The skin with the waves among the values on its foam. waves: as of `of_pixels`."""
    if not any(values.get(name) for name in FOAM_WAVES):
        return even
    factors = np.tensordot(amplitudes(values, FOAM_WAVES), waves, axes=1)
    return replace(even, capacitance=even.capacitance * factors)


def by_waves(
    by_cell: NDArray[np.complex128],
    pressed: NDArray[np.float64],
    values: Mapping[str, float],
    waves: NDArray[np.float64],
) -> dict[str, NDArray[np.complex128]]:
    """Slopes by the amplitudes among the values, from those by c of each cell over the scene's.

    by_cell: shape (..., cell). pressed: that c where no wave is, shape (..., part). waves: as of
    `of_pixels`.
    """
    flat = waves.reshape(len(waves), -1)[1:]
    named = [(name, wave) for name, wave in zip(FOAM_WAVES, flat, strict=True) if name in values]
    if not named:
        return {}
    slopes = by_cell[..., : flat.shape[1]] * pressed[..., : flat.shape[1]]
    return {name: slopes @ wave for name, wave in named}


def with_foam_waves(scene: Scene, values: Mapping[str, float]) -> Scene:
    """The scene with the waves among the values as a map of its foam."""
    if not any(values.get(name) for name in FOAM_WAVES):
        return scene
    foam = scene.skin.foam.model_copy(update={"map": map_of(scene, values)})
    return scene.model_copy(update={"skin": scene.skin.model_copy(update={"foam": foam})})


def map_of(scene: Scene, values: Mapping[str, float]) -> Grid:
    """The waves as a map, whose mean over the sides is 1."""
    return nearest_map(scene, lambda x: waves_at(scene, values, FOAM_WAVES, x))


def check_even_foam(scene: Scene) -> None:
    """Raises InputError where waves of the foam cannot be told apart from what the scene has."""
    if scene.skin.foam.map is not None:
        raise InputError(
            f"{scene.name}: slow waves of the foam are fitted to foam without `skin.foam.map` alone"
        )
    if not scene.press.plain:
        raise InputError(
            f"{scene.name}: slow waves of the foam are fitted to presses by "
            "`press.capacitance_factor` alone, got `press.depth`"
        )
