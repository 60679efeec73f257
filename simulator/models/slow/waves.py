"""Slow waves over the skin: of which parts, their sizes, and maps of them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...scene.scene import Scene
from ..parameters import FOAM_WAVES, SHEET_WAVES, WAVES, mode_values

LARGEST_WAVE = 0.3
"""Of an amplitude over the mean: three at most leave it above zero."""
NODES = 9
"""Of a map of the waves, along each side: between them it is off by 2 % of an amplitude."""


class Uneven(NamedTuple):
    """Whether slow waves of the foam, and of both sheets, are among a skin's parameters."""

    foam: bool = False
    sheets: bool = False

    @property
    def names(self) -> tuple[str, ...]:
        """Of the amplitudes."""
        return (*(FOAM_WAVES if self.foam else ()), *(SHEET_WAVES if self.sheets else ()))

    @property
    def modes(self) -> int:
        """Of each sheet's conductance, with its mean."""
        return len(WAVES) if self.sheets else 1


EVEN = Uneven()


def amplitudes(values: Mapping[str, float], names: Iterable[str]) -> NDArray[np.float64]:
    """Of the mean, 1, and of each wave over it, shape (wave,)."""
    return np.array([1.0, *(values.get(name, 0.0) for name in names)])


def at_nodes(scene: Scene, sizes: NDArray[np.float64]) -> NDArray[np.float64]:
    """The waves on a grid over both sides, shape (row, column). sizes: see `amplitudes`."""
    lines = (np.linspace(0.0, side, NODES) for side in scene.skin.sides)
    waves = mode_values(scene, np.stack(np.meshgrid(*lines)), len(WAVES))
    return np.asarray(np.tensordot(sizes, waves, axes=1), dtype=np.float64)


def rows_of(values: NDArray[np.float64]) -> tuple[tuple[float, ...], ...]:
    """As a map of the kind `Grid` has them."""
    return tuple(tuple(row) for row in values.tolist())
