"""Family of a skin whose foam has cosine modes: only M differs."""

from __future__ import annotations

from copy import copy

from ....arrays import Real
from ..families.family import Family
from ..families.heterogeneous_family import HeterogeneousFamily


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
