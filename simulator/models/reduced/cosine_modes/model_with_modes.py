"""Reduced model of a skin whose foam has cosine modes, which vary within pixels too.

M of a part of uniform foam is F'F. A mode that is nowhere larger than 1 adds no more than that in
any direction: in the part's own few coordinates it is F'SF, with S of size 1 at most. With
amplitudes a, M of the part is F'(1 + sum of a S)F, which has factors again.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np

from ....arrays import Integer, Real
from ..compressing import typical
from ..families.family import Family
from ..reduced_model import Reduced
from .family_with_modes import family_with


@dataclass(frozen=True)
class ModelWithModes(Reduced):
    """Reduced model of foam with cosine modes of given amplitudes.

    uniform: model without these modes. amplitudes: over the mean, shape (mode,).
    """

    uniform: Reduced | None = None
    amplitudes: Real | None = None

    @cached_property
    def family(self) -> Family:
        """Full model with these modes."""
        assert self.uniform is not None and self.amplitudes is not None
        return family_with(self.uniform.family, self.amplitudes)


class FoamModeTerms:
    """Reduced model, and the terms that cosine modes of the foam add to it.

    terms: S of every mode but the mean, in each part, shape (mode, part, rank, rank).
    """

    def __init__(self, uniform: Reduced) -> None:
        """Raises what `Reduced.family` raises if the full model must be built again."""
        self.uniform = uniform
        self.terms = _terms(uniform)

    def under(self, amplitudes: Real) -> ModelWithModes:
        """Model with modes of these amplitudes over the mean, shape (mode,)."""
        factors, own = (
            self.uniform.factors,
            {f.name: getattr(self.uniform, f.name) for f in fields(Reduced)},
        )
        C = np.eye(factors.shape[1]) + np.tensordot(amplitudes, self.terms, axes=1)
        turned = np.linalg.cholesky(C).transpose(0, 2, 1) @ factors
        own |= {"factors": turned, "built": None}
        return ModelWithModes(**own, uniform=self.uniform, amplitudes=amplitudes)

    def masses(self, rest: float, cells: Integer, rises: Real) -> Real:
        """Derivatives of M under a press by the modes' amplitudes, F, shape (mode, N + n, N + n).

        rest: c of the uniform foam over that of the scene. cells, rises: see `ReducedSkin.sweeps`.
        """
        found = self._unpressed.copy()
        for cell, rise in zip(cells.tolist(), rises.tolist(), strict=True):
            F = self.uniform.factors[cell]
            found += rise * (F.T @ (self.terms[:, cell] @ F))
        return rest * found

    @cached_property
    def _unpressed(self) -> Real:
        F = self.uniform.factors
        rows = F.reshape(-1, F.shape[2])
        return np.stack([rows.T @ (S @ F).reshape(rows.shape) for S in self.terms])


def _terms(uniform: Reduced) -> Real:
    """S of each mode in each part: W'MW = F'SF in the directions that F has.

    Parts that no press changes (bodies, the rim) have no F; modes of the foam do not change them.
    """
    size, W = typical(uniform), uniform.coordinates
    back = size[:, None] * np.linalg.pinv(uniform.factors * size)
    touched = slice(len(uniform.factors))
    parts = [each.energies(W, touched) for each in uniform.family.foam_modes]
    return np.stack(
        [
            np.stack([G.T @ each @ G for each, G in zip(of_mode, back, strict=True)])
            for of_mode in parts
        ]
    )
