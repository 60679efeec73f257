"""Mask of a skin that is not a rectangle: the places that an answer may have."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from ...simulator.arrays import Mask, Real
from ..parts.plain import Plain, Sizes, require


@dataclass(frozen=True, eq=False)
class SkinMask(Plain):
    """Uniform cells over a rectangle from (0, 0), and a mask of those that are skin.

    inside: shape (y, x). sides: lengths of the rectangle along x and y, mm.
    """

    inside: Annotated[Mask, "rows columns bool"]
    sides: Annotated[Real, "2 >0"]

    def _check(self, sizes: Sizes) -> None:
        require(self.inside.any(), "inside", "must have skin")

    def contains(self, x: Real, y: Real) -> Mask:
        """True for places in mm that are on the skin, x and y of the same shape."""
        column, row = (
            np.clip((at / side * count).astype(np.int64), 0, count - 1)
            for at, side, count in zip((x, y), self.sides, self.inside.shape[::-1], strict=True)
        )
        return self.inside[row, column]

    def nearest(self, place: Real) -> Real:
        """The place itself if it is on the skin, else the nearest cell centre; mm, shape (2,)."""
        if self.contains(*place[:, None])[0]:
            return place
        row, column = np.nonzero(self.inside)
        counts = np.array(self.inside.shape[::-1])
        middles = (np.stack([column, row], axis=1) + 0.5) * self.sides / counts
        return middles[((middles - place) ** 2).sum(axis=1).argmin()]


def skin_mask_of(tables: Mapping[str, NDArray]) -> SkinMask | None:
    """Mask from the tables of `simulator.inversion` for positions; None for a rectangle."""
    if "on_skin" not in tables:
        return None
    return SkinMask(np.asarray(tables["on_skin"], dtype=bool), 1e3 * tables["sides"])
