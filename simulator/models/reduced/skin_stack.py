"""Reduced skins of a batch in the arrays that are swept together."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from ...arrays import Complex, Integer
from ..small_system.lanczos import Skins
from ..small_system.system import DenseExcitation
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
        each = [np.broadcast_to(air.weights, (len(own), len(own[0].s))) for air, own in nodes]
        systems = Skins(*_joined(skin.alone for skin in skins))
        systems = systems._replace(rtol=precision * systems.rtol).rounded()
        by_excitation = zip(*(skin.excited_alone for skin in skins), strict=True)
        excitations = tuple(DenseExcitation(*_joined(own)) for own in by_excitation)
        return cls(systems, excitations, np.concatenate(each), starts)

    def entries(self, skins: Integer) -> tuple[Integer, Integer]:
        """Entries of some skins, and the first of each skin among them."""
        counts = np.diff(self.starts)[skins]
        first = np.cumsum(counts) - counts
        return np.repeat(self.starts[skins] - first, counts) + np.arange(counts.sum()), first


def _joined(each: Iterable[tuple]) -> Iterator[NDArray]:
    """Arrays of several tuples behind each other."""
    return map(np.concatenate, zip(*each, strict=True))
