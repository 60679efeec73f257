"""Reduced skins of a batch in the arrays that are swept together."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from ...arrays import Complex, Integer
from ..small_system.lanczos import Skins
from ..small_system.system import DenseExcitation, UnpressedMass
from .reduced_skin import ReducedSkin


class SkinStack(NamedTuple):
    """Skins of a batch, each with all its factors on air, see `ReducedSkin.with_air`.

    systems, excitations: of each entry. weights: of the answers of a skin's entries, shape (entry,
    frequency). starts: first entry of each skin, then the number of entries.
    """

    systems: Skins
    excitations: tuple[DenseExcitation, ...]
    weights: Complex
    starts: Integer

    @classmethod
    def of(cls, skins: Sequence[ReducedSkin]) -> Self:
        """Arrays of some skins of one family."""
        nodes = [skin.with_air(skin.reduced.frequency) for skin in skins]
        starts = np.cumsum([0, *(len(own) for _, own in nodes)])
        precision = np.repeat([air.precision for air, _ in nodes], np.diff(starts))
        skins = [skin for _, own in nodes for skin in own]
        mass = UnpressedMass(*_stacked(skin.aligned_mass for skin in skins))
        touched = skins[0].parts.touched
        unit = np.stack([skin.unpressed_factors[:touched] for skin in skins])
        s = np.stack([skin.s for skin in skins]).astype(np.complex128)
        each = [np.broadcast_to(air.weights, (len(own), s.shape[1])) for air, own in nodes]
        rtol = precision * [skin.lanczos_rtol for skin in skins]
        by_excitation = zip(*(skin.dense_excitations for skin in skins), strict=True)
        excitations = tuple(DenseExcitation(*_stacked(own)) for own in by_excitation)
        return cls(Skins(mass, unit, s, rtol), excitations, np.concatenate(each), starts)

    def entries(self, skins: Integer) -> tuple[Integer, Integer]:
        """Entries of some skins, and the row of each among them."""
        counts = np.diff(self.starts)[skins]
        rows = np.repeat(np.arange(len(skins)), counts)
        first = np.cumsum(counts) - counts
        return self.starts[skins][rows] + np.arange(len(rows)) - first[rows], rows


def _stacked(each: Iterable[tuple]) -> Iterator[NDArray]:
    """Arrays of several tuples, one tuple a row."""
    return map(np.stack, zip(*each, strict=True))
