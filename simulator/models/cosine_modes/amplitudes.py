"""Cosine modes over the skin: which are fitted, their amplitudes, and maps of them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Real
from ...scene.maps.factor_maps import Grid
from ...scene.parts import Skin
from ..parameters import FOAM_MODES, HALF_WAVES, SHEET_MODES, mode_values

MAX_AMPLITUDE = 0.3
"""Largest amplitude over the mean: three of that size leave the value above zero."""
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
