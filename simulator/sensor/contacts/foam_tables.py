"""The foam's law as numbers and tables for kernels."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...arrays import Real
from ...scene.foam.foam import Foam
from ...scene.foam.foam_mechanics import HALVINGS, Elastic, Elastomer

STRAINS = 8192
PRESSURES = 8192
SMALL = 0.02
"""Pressure below which the table of pressures is linear and above which it is logarithmic, over the
plateau stress."""


class FoamTables(NamedTuple):
    """Law of one foam, as kernels take it.

    elastomer: False for Hooke's law. modulus, plateau: Pa. densified: densification strain.
    greatest: largest strain. thickness: m. closed: pressure at the largest strain, Pa. relative: c
    times the thickness over its unpressed value, at equidistant strains from 0 to the largest.
    strains: at pressures equidistant in log(1 + p / scale); scale: Pa.
    """

    elastomer: bool
    modulus: float
    plateau: float
    densified: float
    greatest: float
    thickness: float
    closed: float
    scale: float
    relative: Real
    strains: Real

    @property
    def deepest(self) -> float:
        """Largest indentation, m."""
        return self.greatest * self.thickness

    def strains_under(self, pressure: Real) -> Real:
        """Strains under pressures in Pa, shape (...); at most the largest strain."""
        at = np.log1p(pressure / self.scale) / np.log1p(self.closed / self.scale)
        return np.interp(at, np.linspace(0.0, 1.0, len(self.strains)), self.strains)


def foam_tables(foam: Foam, highest: float = np.inf) -> FoamTables:
    """Law of a foam up to a factor on c. Without mechanics it is for depths alone.

    Without a thickness as well, its thickness is 0.
    """
    greatest, thickness = float(foam.greatest_strain), float(foam.thickness or 0.0)
    if np.isfinite(highest):
        greatest = min(greatest, float(foam.strain_at(np.array(highest))))
    at = np.linspace(0.0, greatest, STRAINS)
    relative = foam.factor_at(at) * (1 - at)
    if foam.mechanics is None:
        none = np.zeros(2)
        return FoamTables(False, 0.0, 1.0, 1.0, greatest, thickness, 0.0, 1.0, relative, none)
    elastic = foam.mechanics.elastic
    own = (False, elastic.modulus, elastic.modulus * greatest, 1.0)
    if isinstance(elastic, Elastomer):
        own = True, elastic.modulus, elastic.plateau_stress, elastic.densification_strain
    closed, scale = float(elastic.stress(np.array(greatest))), SMALL * own[2]
    pressure = scale * np.expm1(np.linspace(0.0, np.log1p(closed / scale), PRESSURES))
    strains = strains_at(elastic, pressure)
    return FoamTables(*own, greatest, thickness, closed, scale, relative, strains)


def strains_at(elastic: Elastic, pressure: Real) -> Real:
    """Strains of a foam under pressures in Pa, by bisection; at most the largest one."""
    low, high = np.zeros(pressure.shape), np.full(pressure.shape, elastic.greatest_strain)
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        beyond = elastic.stress(middle) > pressure
        low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
    return high
