"""Reduced models whose foam has cosine modes, and the family of them."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np

from ...arrays import Integer, Real
from .compressing import typical
from .families_by_system import HeterogeneousFamily
from .family import Family
from .reduced_model import Reduced


def family_with(family: Family, amplitudes: Real) -> Family:
    """Family with cosine modes of the foam in M of every part.

    amplitudes: over the mean, shape (mode,).
    """
    found = _with(family, amplitudes)
    if isinstance(family, HeterogeneousFamily):
        vars(found)["_finer"] = _with(family._finer, amplitudes)
    return found


def _with(family: Family, amplitudes: Real) -> Family:
    found = copy(family)
    vars(found).pop("_masses_inside", None)
    vars(found)["masses"] = family.masses.plus(amplitudes, family.foam_modes)
    return found


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
