"""The foam's law as numbers and tables for kernels."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...scene.foam.foam import Foam
from ...scene.foam.foam_mechanics import HALVINGS, Elastic, Elastomer

STRAINS = 8192
PRESSURES = 8192
SMALL = 0.02
"""Pressure below which the table of pressures is linear and above which it is logarithmic, over the
plateau stress."""


class FoamTables(NamedTuple):
    """Law of one foam.

    law: 1 for an elastomer and 0 for Hooke's law; modulus, plateau stress in Pa; densification
    strain; largest strain; thickness in m; pressure at the largest strain, Pa; scale of the
    pressures in `strain`, Pa. relative: c times the thickness over its unpressed value, at
    equidistant strains from 0 to the largest. strain: at pressures equidistant in log(1 + p /
    scale).
    """

    law: NDArray[np.float64]
    relative: NDArray[np.float64]
    strain: NDArray[np.float64]

    def strains_under(self, pressure: NDArray[np.float64]) -> NDArray[np.float64]:
        """Strains under pressures in Pa, shape (...); at most the largest strain."""
        at = np.log1p(pressure / self.law[7]) / np.log1p(self.law[6] / self.law[7])
        return np.interp(at, np.linspace(0.0, 1.0, len(self.strain)), self.strain)


def foam_tables(foam: Foam, highest: float = np.inf) -> FoamTables:
    """Law of a foam up to a factor on c. Without mechanics it is for depths alone.

    Without a thickness as well, its thickness is 0.
    """
    greatest, thickness = foam.greatest_strain, foam.thickness or 0.0
    if np.isfinite(highest):
        greatest = min(greatest, float(foam.strain_at(np.array(highest))))
    strains = np.linspace(0.0, greatest, STRAINS)
    relative = foam.factor_at(strains) * (1 - strains)
    if foam.mechanics is None:
        law = np.array([0.0, 0.0, 1.0, 1.0, greatest, thickness, 0.0, 1.0])
        return FoamTables(law, relative, np.zeros(2))
    elastic = foam.mechanics.elastic
    if isinstance(elastic, Elastomer):
        own = 1.0, elastic.modulus, elastic.plateau_stress, elastic.densification_strain
    else:
        own = 0.0, elastic.modulus, elastic.modulus * greatest, 1.0
    closed, scale = float(elastic.stress(np.array(greatest))), SMALL * own[2]
    pressure = scale * np.expm1(np.linspace(0.0, np.log1p(closed / scale), PRESSURES))
    law = np.array([*own, greatest, thickness, closed, scale])
    return FoamTables(law, relative, strains_at(elastic, pressure))


def strains_at(elastic: Elastic, pressure: NDArray[np.float64]) -> NDArray[np.float64]:
    """Strains of a foam under pressures in Pa, by bisection; at most the largest one."""
    low, high = np.zeros(pressure.shape), np.full(pressure.shape, elastic.greatest_strain)
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        beyond = elastic.stress(middle) > pressure
        low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
    return high
