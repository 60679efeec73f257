"""Arrays of the reduced skins of a batch, as the kernel of a sensor takes them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Self

import numpy as np

from ..arrays import Complex, Real
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
    """Skins of a batch. s: rad/s, shape (skin, frequency)."""

    mass: StackedMass
    excitations: tuple[StackedExcitation, ...]
    s: Complex

    @classmethod
    def of(cls, skins: Sequence[ReducedSkin]) -> Self:
        """Arrays of some skins of one family."""
        masses = [skin.aligned_mass for skin in skins]
        rows, diagonal, factors = (np.stack(each) for each in zip(*masses, strict=True))
        touched = skins[0].parts.touched
        own = np.stack([skin.unpressed_factors[:touched] for skin in skins])
        rtol = np.array([skin.lanczos_rtol for skin in skins])
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
        return cls(StackedMass(rows, diagonal, factors, own, rtol), excitations, s)
