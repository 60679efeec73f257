"""The family of a skin whose foam has slow waves: the same but for M."""

from __future__ import annotations

from copy import copy

import numpy as np
from numpy.typing import NDArray

from ..family import Family
from ..masses import Masses
from ..uneven import UnevenFamily


def family_with(family: Family, amplitudes: NDArray[np.float64]) -> Family:
    """With waves of these amplitudes over the mean, shape (wave,), in M of every part."""
    found = copy(family)
    vars(found)["masses"] = _raised(family, amplitudes)
    if isinstance(family, UnevenFamily):
        vars(found)["_finer"] = family_with(family._finer, amplitudes)
    return found


def _raised(family: Family, amplitudes: NDArray[np.float64]) -> Masses:
    waves = [family.masses_in(wave) for wave in range(1, len(amplitudes) + 1)]
    return family.masses.plus(amplitudes, waves)
