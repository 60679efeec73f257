"""Arrays of the reduced skins of a batch, as the kernel of a sensor takes them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Self

import numpy as np

from ..arrays import Complex, Integer, Real
from ..models.reduced.reduced_skin import ReducedSkin


class StackedMass(NamedTuple):
    """Unpressed M of each skin, see `UnpressedMass`.

    own: unit of the rises of each part, shape (skin, part). rtol: tolerance of Lanczos' method,
    shape (skin,).
    """

    rows: Real
    diagonal: Real
    factors: Real
    own: Real
    rtol: Real


class StackedExcitation(NamedTuple):
    """One excitation of each skin, see `DenseExcitation`; `driven` is the same for all."""

    conductance: Real
    driven: Real
    tied: Real
    tied_inverse: Real
    common: Real


class SkinStack(NamedTuple):
    """Skins of a batch, each with all its factors on air, see `ReducedSkin.with_air`.

    s: rad/s, shape (entry, frequency). weights: of the answers of a skin's entries, shape (entry,
    frequency). starts: first entry of each skin, then the number of entries.
    """

    mass: StackedMass
    excitations: tuple[StackedExcitation, ...]
    s: Complex
    weights: Complex
    starts: Integer

    @classmethod
    def of(cls, skins: Sequence[ReducedSkin]) -> Self:
        """Arrays of some skins of one family."""
        nodes = [skin.with_air(skin.reduced.frequency) for skin in skins]
        starts = np.cumsum([0, *(len(own) for _, own in nodes)])
        precision = np.repeat([air.precision for air, _ in nodes], np.diff(starts))
        skins = [skin for _, own in nodes for skin in own]
        masses = [skin.aligned_mass for skin in skins]
        rows, diagonal, factors = (np.stack(each) for each in zip(*masses, strict=True))
        touched = skins[0].parts.touched
        own = np.stack([skin.unpressed_factors[:touched] for skin in skins])
        rtol = precision * [skin.lanczos_rtol for skin in skins]
        excitations = tuple(
            StackedExcitation(
                np.array([one.conductance for one in each]),
                each[0].driven,
                np.stack([one.tied for one in each]),
                np.stack([one.tied_inverse for one in each]),
                np.stack([one.common for one in each]),
            )
            for each in zip(*(skin.dense_excitations for skin in skins), strict=True)
        )
        s = np.stack([skin.s for skin in skins]).astype(np.complex128)
        each = [np.broadcast_to(air.weights, (len(own), s.shape[1])) for air, own in nodes]
        mass = StackedMass(rows, diagonal, factors, own, rtol)
        return cls(mass, excitations, s, np.concatenate(each), starts)

    def entries(self, skins: Integer) -> tuple[Integer, Integer]:
        """Entries of some skins, and the row of each among them."""
        counts = np.diff(self.starts)[skins]
        rows = np.repeat(np.arange(len(skins)), counts)
        first = np.cumsum(counts) - counts
        return self.starts[skins][rows] + np.arange(len(rows)) - first[rows], rows
