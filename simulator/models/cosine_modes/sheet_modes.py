"""Cosine modes of the sheets: slow variation of each sheet's conductance over the skin."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...arrays import Complex, Real
from ...scene.maps.factor_maps import Grid
from ...scene.parts import Skin
from ...scene.skin import Electrode
from ...sweeps import InputError
from ..parameters import BOTTOM_MODES, SHEET_MODES, TOP_MODES, Variation
from .amplitudes import MAX_AMPLITUDE, amplitudes, fitted_map, modes_at

OF_SHEETS: dict[Electrode, tuple[str, ...]] = {"top": TOP_MODES, "bottom": BOTTOM_MODES}


def variation_with_modes(uniform: Variation, values: Mapping[str, float], modes: int) -> Variation:
    """Variation with the modes among the values on its sheets, up to `modes` of each."""
    sizes = {name: amplitudes(values, names)[:modes] for name, names in OF_SHEETS.items()}
    top, bottom = uniform.top[0] * sizes["top"], uniform.bottom[0] * sizes["bottom"]
    return replace(uniform, top=top, bottom=bottom)


def random_amplitudes(random: np.random.Generator) -> dict[str, float]:
    """Random amplitudes of all modes, up to the largest that is allowed."""
    drawn = random.uniform(-MAX_AMPLITUDE, MAX_AMPLITUDE, len(SHEET_MODES))
    return dict(zip(SHEET_MODES, drawn.tolist(), strict=True))


@dataclass(frozen=True)
class StiffnessTerms:
    """Order of the terms of K: by field, by mode, by part of the foam that changes a sheet (one for
    all if none does); then those of the films."""

    fields: int
    modes: int
    parts: int

    def split(self, of_terms: NDArray) -> tuple[NDArray, NDArray]:
        """Values of the sheets, shape (..., field, mode, part), and of the films, (..., film)."""
        shape = self.fields, self.modes, self.parts
        sheets, films = np.split(of_terms, [self.fields * self.modes * self.parts], axis=-1)
        return sheets.reshape(*of_terms.shape[:-1], *shape), films

    def by_amplitudes(
        self, by_weight: Complex, weights: Real, values: Mapping[str, float]
    ) -> dict[str, Complex]:
        """Slopes by the amplitudes among the values, from those by the weight of each term.

        by_weight: shape (..., term). weights: of the terms, shape (term,).
        """
        if self.modes == 1:
            return {}
        sheets, means = self.split(by_weight)[0], self.split(weights)[0][:, 0]
        slopes = (sheets[..., 1:, :] * means[:, None]).sum(axis=-1)
        flat = slopes.reshape(*slopes.shape[:-2], -1)
        return {name: flat[..., k] for k, name in enumerate(SHEET_MODES) if name in values}


def with_sheet_modes(skin: Skin, values: Mapping[str, float]) -> Skin:
    """Skin with the modes among the values as maps of its sheets."""
    if not any(values.get(name) for name in SHEET_MODES):
        return skin
    sheets = {
        name: skin.sheet(name).model_copy(update={"map": map_of_sheet(skin, values, names)})
        for name, names in OF_SHEETS.items()
    }
    return skin.with_parts(**sheets)


def map_of_sheet(skin: Skin, values: Mapping[str, float], names: tuple[str, ...]) -> Grid:
    """Modes of a sheet's conductance as a map of its resistance."""
    return fitted_map(skin, lambda x: 1 / modes_at(skin, values, names, x))


def check_uniform_sheets(skin: Skin) -> None:
    """Raise InputError if modes of a sheet cannot be identified because the sheet has a map."""
    for name in OF_SHEETS:
        if skin.sheet(name).map is not None:
            raise InputError(
                f"{skin.name}: cosine modes of the sheets are fitted only to sheets without maps, "
                f"got `skin.{name}.map`"
            )
