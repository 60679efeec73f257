"""Cosine modes over a skin: slow variation of its foam and of its sheets, and maps of them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Complex, Real
from ..scene.factor_maps import Grid
from ..scene.parts import Skin
from ..scene.skin import Electrode
from .parameters import (
    BOTTOM_MODES,
    FOAM_MODES,
    HALF_WAVES,
    MAX_AMPLITUDE,
    SHEET_MODES,
    TOP_MODES,
    Variation,
    mode_values,
)

NODES, POINTS = 9, 257
"""Nodes of a map of the modes along each side (error at most 1 % of an amplitude, none in the
mean), and points along each side at which it is fitted."""


class FittedModes(NamedTuple):
    """Flags: modes of the foam, and of both sheets, are among a skin's parameters."""

    foam: bool = False
    sheets: bool = False

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the amplitudes."""
        return (*(FOAM_MODES if self.foam else ()), *(SHEET_MODES if self.sheets else ()))

    @property
    def modes(self) -> int:
        """Number of modes of each sheet's conductance, with its mean."""
        return len(HALF_WAVES) if self.sheets else 1


NO_MODES = FittedModes()


def amplitudes(values: Mapping[str, float], names: Iterable[str]) -> Real:
    """Amplitude of the mean, 1, and of each mode over it, shape (mode,)."""
    return np.array([1.0, *(values.get(name, 0.0) for name in names)])


def fitted_map(skin: Skin, of_place: Callable[[NDArray], NDArray]) -> Grid:
    """Bilinear map that approximates a smooth function over both sides by least squares.

    of_place: maps positions in m, shape (2, ...), to values of that shape without its first axis.
    """
    axes = [np.linspace(0.0, side, POINTS) for side in skin.sides]
    along, across = (_onto_nodes(axis / side) for axis, side in zip(axes, skin.sides, strict=True))
    rows = across @ of_place(np.stack(np.meshgrid(*axes))) @ along.T
    return Grid(values=tuple(tuple(row) for row in rows.tolist()))


def modes_at(skin: Skin, values: Mapping[str, float], names: Iterable[str], x: Real) -> Real:
    """1 plus the modes among the values at positions x in m, shape (2, ...), over the mean."""
    modes = mode_values(skin, x, len(HALF_WAVES))
    return np.asarray(np.tensordot(amplitudes(values, names), modes, axes=1), dtype=np.float64)


def _onto_nodes(at: Real) -> Real:
    """Matrix from values at positions within 0 to 1 to nodes of the nearest polygon."""
    nodes = np.linspace(0.0, 1.0, NODES)
    hats = np.stack([np.interp(at, nodes, hat) for hat in np.eye(NODES)], axis=1)
    return np.asarray(np.linalg.pinv(hats), dtype=np.float64)


def with_foam_modes(skin: Skin, values: Mapping[str, float]) -> Skin:
    """Skin with the modes among the values as a map of its foam."""
    if not any(values.get(name) for name in FOAM_MODES):
        return skin
    return replace(skin, foam=skin.foam.model_copy(update={"map": map_of(skin, values)}))


def map_of(skin: Skin, values: Mapping[str, float]) -> Grid:
    """Modes as a map whose mean over the sides is 1."""
    return fitted_map(skin, lambda x: modes_at(skin, values, FOAM_MODES, x))


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
