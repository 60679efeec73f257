"""Stress of a foam under uniaxial compression, and its energy: linear, plateau, densification."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

DENSIFICATION = 2.3
"""D of Maiti, Gibson and Ashby for elastomeric foams."""
REACH = 0.999
"""Of the densification strain, up to where the law is used; straight on from there."""


@dataclass(frozen=True)
class Elastomer:
    """Three regimes in one smooth, strictly rising law of the compressive strain e:

        p = P (1 - exp(-E e / P)) + P / D r² / (1 - r),    r = e / densification_strain

    with modulus E and plateau stress P in Pa. Young's modulus at small strain, cell walls that
    buckle at P (L. J. Gibson and M. F. Ashby, Cellular Solids, 2nd ed. 1997, 5.2 and 5.3), and a
    stress that diverges as the cells close, P / D / (1 - r) with D = 2.3 (S. K. Maiti, L. J.
    Gibson and M. F. Ashby, Acta Metallurgica 32 (1984) 1963), less its value and slope at rest.
    """

    modulus: float
    plateau_stress: float
    densification_strain: float

    @property
    def greatest_strain(self) -> float:
        """Up to which the law is meant."""
        return REACH * self.densification_strain

    def stress(self, strain: NDArray[np.float64]) -> NDArray[np.float64]:
        """p in Pa."""
        known = np.clip(strain, 0.0, self.greatest_strain)
        r = known / self.densification_strain
        buckled = -np.expm1(-self.modulus * known / self.plateau_stress)
        within = self.plateau_stress * (buckled + r**2 / (1 - r) / DENSIFICATION)
        return within + self.stiffness(known) * (strain - known)

    def stiffness(self, strain: NDArray[np.float64]) -> NDArray[np.float64]:
        """dp/de in Pa."""
        known = np.clip(strain, 0.0, self.greatest_strain)
        r = known / self.densification_strain
        closing = r * (2 - r) / (1 - r) ** 2 * self.plateau_stress / self.densification_strain
        buckling = self.modulus * np.exp(-self.modulus * known / self.plateau_stress)
        return buckling + closing / DENSIFICATION

    def energy(self, strain: NDArray[np.float64]) -> NDArray[np.float64]:
        """Integral of p from rest, J per m³ of foam at rest."""
        known, beyond = np.clip(strain, 0.0, self.greatest_strain), 0.0
        r = known / self.densification_strain
        buckled = known + np.expm1(-self.modulus * known / self.plateau_stress) * (
            self.plateau_stress / self.modulus
        )
        closed = self.densification_strain * (-r - r**2 / 2 - np.log1p(-r)) / DENSIFICATION
        beyond = strain - known
        straight = beyond * (self.stress(known) + self.stiffness(known) * beyond / 2)
        return self.plateau_stress * (buckled + closed) + straight


@dataclass(frozen=True)
class Hookean:
    """p = E e, the law of closed forms."""

    modulus: float
    greatest_strain: float

    def stress(self, strain: NDArray[np.float64]) -> NDArray[np.float64]:
        """p in Pa."""
        return self.modulus * strain

    def stiffness(self, strain: NDArray[np.float64]) -> NDArray[np.float64]:
        """dp/de in Pa."""
        return np.full_like(strain, self.modulus)

    def energy(self, strain: NDArray[np.float64]) -> NDArray[np.float64]:
        """Integral of p from rest, J per m³ of foam at rest."""
        return self.modulus * strain**2 / 2


Elastic = Elastomer | Hookean
