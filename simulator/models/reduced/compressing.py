"""Lowest rank of the factors of M that the tolerance allows; it determines the cost of a sweep."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ...arrays import Complex, Real
from ...fem.error_estimate import relative_difference
from ...press.parts import parts_of
from .cases import Case
from .family import compressed_factors
from .reduced_model import Reduced
from .reduced_skin import ReducedSkin

COMPRESSED_SHARE = 0.01
"""Factors of lower rank may change Rs and Cp by this share of the tolerance."""


def compressed(reduced: Reduced, cases: list[Case]) -> Reduced:
    """Model with factors of lower rank, as far as that leaves these cases unchanged."""
    exact = _impedances(reduced, cases)
    share = COMPRESSED_SHARE * reduced.rtol
    while True:
        factors = compressed_factors(
            reduced.factors, typical(reduced), share, parts_of(reduced.parts.skin)
        )
        candidate = replace(reduced, factors=factors)
        change = relative_difference(_impedances(candidate, cases), exact)
        if change.max() <= COMPRESSED_SHARE * reduced.rtol:
            return candidate
        share *= 0.1


def _skins(reduced: Reduced, cases: list[Case]) -> Iterator[ReducedSkin]:
    """Skin of each case; the scene's own skin is built once."""
    own = reduced.at(None)
    return (own if c.variation is None else reduced.at(c.variation) for c in cases)


def _impedances(reduced: Reduced, cases: list[Case]) -> Complex:
    """Z in ohm of each case, shape (case, interface, frequency)."""
    found = []
    for skin, case in zip(_skins(reduced, cases), cases, strict=True):
        own = case.cells, case.rises
        Q = [Q for _, Q in skin.under(*own).solved(*own, skin.s)]
        found.append(skin.combination.impedance(np.stack(Q)))
    return np.array(found)


def typical(reduced: Reduced) -> Real:
    """Typical size of potentials in the model's coordinates, V, shape (N + n,).

    It is 1 at terminals, and in the basis the largest norm of the unpressed skin's coefficients.
    """
    skin = reduced.at(None)
    none = np.zeros(0, dtype=np.int64)
    unpressed = np.hstack([u for u, _ in skin.solved(none, np.zeros(0), skin.s)])
    terminals = len(reduced.conductance)
    most = float(np.linalg.norm(unpressed[terminals:], axis=0).max())
    return sizes(terminals, reduced.size, most)


def sizes(terminals: int, basis: int, most: float) -> Real:
    """Sizes of potentials, V: 1 at terminals and `most` in the basis."""
    return np.concatenate([np.ones(terminals), np.full(basis, most)])
