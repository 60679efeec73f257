"""A reduced model of a skin whose foam has slow waves, which vary within pixels too.

M of a part is F'F where the foam is even. A wave of which no place has more than 1 adds no more
than that in any direction: in the part's own few coordinates it is F'SF, S of size 1 at most. Of
amplitudes a, M of the part is then F'(1 + sum of a S)F, which has factors again.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..compressing import typical
from ..families.family import Family
from ..model import Reduced
from .family import family_with


@dataclass(frozen=True)
class Amid(Reduced):
    """Of foam with waves of given amplitudes. even: the same without them."""

    even: Reduced | None = None
    amplitudes: NDArray[np.float64] | None = None

    @cached_property
    def family(self) -> Family:
        """As of `Reduced`."""
        assert self.even is not None and self.amplitudes is not None
        return family_with(self.even.family, self.amplitudes)


class Waved:
    """A reduced model, and what waves add to it.

    terms: S of every wave but the mean, in each part, shape (wave, part, rank, rank).
    """

    def __init__(self, even: Reduced) -> None:
        """Raises as `Reduced.family` where that is not at hand."""
        self.even = even
        self.terms = _terms(even)

    def under(self, amplitudes: NDArray[np.float64]) -> Amid:
        """With waves of these amplitudes over the mean, shape (wave,)."""
        factors, own = (
            self.even.factors,
            {f.name: getattr(self.even, f.name) for f in fields(Reduced)},
        )
        C = np.eye(factors.shape[1]) + np.tensordot(amplitudes, self.terms, axes=1)
        turned = np.linalg.cholesky(C).transpose(0, 2, 1) @ factors
        own |= {"factors": turned, "built": None}
        return Amid(**own, even=self.even, amplitudes=amplitudes)

    def masses(
        self, rest: float, cells: NDArray[np.int64], rises: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """What the amplitude of each wave adds to M under a press, F, shape (wave, N + n, N + n).

        rest: c of the even foam over that of the scene. cells, rises: as of `ReducedSkin.sweeps`.
        """
        found = self._at_rest.copy()
        for cell, rise in zip(cells.tolist(), rises.tolist(), strict=True):
            F = self.even.factors[cell]
            found += rise * (F.T @ (self.terms[:, cell] @ F))
        return rest * found

    @cached_property
    def _at_rest(self) -> NDArray[np.float64]:
        F = self.even.factors
        rows = F.reshape(-1, F.shape[2])
        return np.stack([rows.T @ (S @ F).reshape(rows.shape) for S in self.terms])


def _terms(even: Reduced) -> NDArray[np.float64]:
    """S of each wave in each part: W'MW = F'SF in the directions that F has."""
    size, W = typical(even), even.coordinates
    back = size[:, None] * np.linalg.pinv(even.factors * size)
    parts = [each.energies(W) for each in even.family.foam_waves]
    return np.stack(
        [
            np.stack([G.T @ each @ G for each, G in zip(of_wave, back, strict=True)])
            for of_wave in parts
        ]
    )
