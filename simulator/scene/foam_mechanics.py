"""Mechanics of a compressed foam: stress-strain laws and permittivity."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Literal, Self

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field, PrivateAttr, model_validator

from ..arrays import Real
from .ranges import Permittivity, Stress, Tension
from .validation import Number, Table

DENSIFICATION = 2.3
"""D of Maiti, Gibson and Ashby for elastomeric foams."""

REACH = 0.999
"""Fraction of the densification strain up to which the law is used; linear beyond it."""
REACH_OF_APPLICATORS = 0.9
"""Largest strain under applicators over the largest one for which the law is used."""


@dataclass(frozen=True)
class Elastomer:
    """Three regimes in one smooth, strictly rising law of the compressive strain e:

        p = P (1 - exp(-E e / P)) + P / D r² / (1 - r),    r = e / densification_strain

    with modulus E and plateau stress P in Pa. Young's modulus at small strain, cell walls that
    buckle at P (L. J. Gibson and M. F. Ashby, Cellular Solids, 2nd ed. 1997, 5.2 and 5.3), and a
    stress that diverges as the cells close, P / D / (1 - r) with D = 2.3 (S. K. Maiti, L. J.
    Gibson and M. F. Ashby, Acta Metallurgica 32 (1984) 1963), less its value and slope at zero
    strain.
    """

    modulus: float
    plateau_stress: float
    densification_strain: float

    @property
    def greatest_strain(self) -> float:
        """Largest strain for which the law is used."""
        return REACH * self.densification_strain

    def stress(self, strain: Real) -> Real:
        """p in Pa."""
        known = np.clip(strain, 0.0, self.greatest_strain)
        r = known / self.densification_strain
        buckled = -np.expm1(-self.modulus * known / self.plateau_stress)
        within = self.plateau_stress * (buckled + r**2 / (1 - r) / DENSIFICATION)
        return within + self.stiffness(known) * (strain - known)

    def stiffness(self, strain: Real) -> Real:
        """dp/de in Pa."""
        known = np.clip(strain, 0.0, self.greatest_strain)
        r = known / self.densification_strain
        closing = r * (2 - r) / (1 - r) ** 2 * self.plateau_stress / self.densification_strain
        buckling = self.modulus * np.exp(-self.modulus * known / self.plateau_stress)
        return buckling + closing / DENSIFICATION

    def energy(self, strain: Real) -> Real:
        """Integral of p from zero strain, J per m³ of uncompressed foam."""
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
    """Hooke's law p = E e, for closed forms; same methods as Elastomer."""

    modulus: float
    greatest_strain: float

    def stress(self, strain: Real) -> Real:
        return self.modulus * strain

    def stiffness(self, strain: Real) -> Real:
        return np.full_like(strain, self.modulus)

    def energy(self, strain: Real) -> Real:
        return self.modulus * strain**2 / 2


Elastic = Elastomer | Hookean


def strains_under(elastic: Elastic, pressure: Real) -> Real:
    """Strains of a foam under pressures in Pa, by bisection; at most the largest one."""
    low, high = np.zeros(np.shape(pressure)), np.full(np.shape(pressure), elastic.greatest_strain)
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        beyond = elastic.stress(middle) > pressure
        low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
    return high


Law = Callable[[Real, float], Real]


def looyenga(porosity: Real, solid: float) -> Real:
    """Looyenga's law, eps^(1/3) averaged by volume: H. Looyenga, Physica 31 (1965) 401."""
    return ((1 - porosity) * np.cbrt(solid) + porosity) ** 3


def bruggeman(porosity: Real, solid: float) -> Real:
    """Bruggeman's law, (1-p)(s-e)/(s+2e) + p(1-e)/(1+2e) = 0, for spheres of both in the mixture.

    Source: D. A. G. Bruggeman, Annalen der Physik 416 (1935) 636.
    """
    half = (2 - 3 * porosity) * solid + 3 * porosity - 1
    return (half + np.sqrt(half**2 + 8 * solid)) / 4


def lichtenecker(porosity: Real, solid: float) -> Real:
    """Lichtenecker's law, ln eps averaged by volume: Physikalische Zeitschrift 27 (1926) 115."""
    return solid ** (1 - porosity)


def maxwell_garnett(porosity: Real, solid: float) -> Real:
    """Maxwell Garnett's law: round closed cells of air in the solid.

    It is the upper bound of Hashin and Shtrikman. Source: J. C. Maxwell Garnett, Philosophical
    Transactions A 203 (1904) 385.
    """
    rise = 2 * solid + 1
    return solid * (rise + 2 * porosity * (1 - solid)) / (rise - porosity * (1 - solid))


LAWS: dict[str, Law] = {
    "looyenga": looyenga,
    "bruggeman": bruggeman,
    "lichtenecker": lichtenecker,
    "maxwell-garnett": maxwell_garnett,
}

BUCKLING_STRAIN = 0.05
"""Plateau stress over Young's modulus of elastomeric foams: Gibson and Ashby, eq. 5.18 over 5.6."""

ASSUMED_SOLID_PERMITTIVITY = 3.0
"""Relative permittivity of the solid where only that of the foam is known: silicone rubber has 2.7
to 3.2, polyurethane and natural rubber 2.5 to 3.5."""
CONSTANT = 'effective_medium = "constant"'
POROSITIES = (1e-3, 0.999)
"""Limits of porosity and strain: foam with less air is solid; strain ends when the air is gone."""

STEP = 1e-6
HALVINGS = 53


def strain_of(factor: ArrayLike) -> Real:
    """Compressive strain of foam with constant permittivity at a capacitance factor.

    It is 1 - 1 / factor, and 0 for factors below 1.
    """
    return np.maximum(1 - 1 / np.asarray(factor, dtype=np.float64), 0.0)


Strain = Annotated[Number, Field(ge=POROSITIES[0], le=POROSITIES[1])]


class Mechanics(Table):
    """A foam whose Poisson's ratio is 0: it does not expand sideways under compression.

    Pores close as its volume falls: at strain e the porosity is (porosity - e)/(1 - e), from which
    the law `effective_medium` gives the permittivity; "constant" leaves it unchanged. porosity:
    fraction of air in the volume of the unpressed foam; by default the one at which the law gives
    the permittivity of the foam, or for "constant" the densification_strain. solid_permittivity:
    relative permittivity of the solid; 3 where both it and the porosity are left out.
    effective_medium: law of the permittivity of the mixture. solid_modulus: Young's modulus of the
    solid. stress_strain: "elastomer", with a plateau and densification; "linear", stress in
    proportion to strain. modulus [Pa]: Young's, or `solid_modulus` (1 - porosity)², that of open
    cells (Gibson and Ashby, eq. 5.6). plateau_stress [Pa]: default 0.05 of the modulus.
    densification_strain: default the porosity. tension [N/m]: of both electrode skins together,
    equal in all directions.
    """

    porosity: Strain | None = None
    solid_permittivity: Permittivity | None = None
    effective_medium: Literal[
        "looyenga", "bruggeman", "lichtenecker", "maxwell-garnett", "constant"
    ] = "looyenga"
    modulus: Stress | None = None
    solid_modulus: Stress | None = None
    stress_strain: Literal["elastomer", "linear"] = "elastomer"
    plateau_stress: Stress | None = None
    densification_strain: Strain | None = None
    tension: Tension = 0.0
    _derived: float = PrivateAttr(0.0)

    @property
    def air(self) -> float:
        """Porosity, given or derived."""
        return self._derived if self.porosity is None else self.porosity

    def with_permittivity(self, foam: float | None) -> Self:
        """The mechanics with its porosity. foam: relative permittivity of the unpressed foam.

        Raises ValueError if the porosity is not given and does not follow.
        """
        found = self.model_copy()
        if self.porosity is None:
            found._derived = self._derived_porosity(foam)
        found._check_densification()
        return found

    def _derived_porosity(self, foam: float | None) -> float:
        if self.effective_medium == "constant":
            if self.densification_strain is None:
                raise ValueError(
                    f"mechanics needs porosity or densification_strain with {CONSTANT}"
                )
            return self.densification_strain
        if foam is None:
            raise ValueError(
                "mechanics needs porosity, unless relative_permittivity or capacitance_per_area of "
                "the foam is given"
            )
        highest, lowest = (float(self._mixed(np.array(each))) for each in POROSITIES)
        if not lowest <= foam <= highest:
            raise ValueError(
                f"mechanics needs porosity or another solid_permittivity: that of the solid, "
                f"{self._solid:g}, gives foams of {lowest:.4g} to {highest:.4g}, got {foam:.4g}"
            )
        low, high = POROSITIES
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            above = float(self._mixed(np.array(middle))) > foam
            low, high = (middle, high) if above else (low, middle)
        return high

    @property
    def derivation(self) -> str:
        """Text on how the porosity was derived; empty if it was given."""
        if self.porosity is not None:
            return ""
        if self.effective_medium == "constant":
            return " (the densification_strain)"
        assumed = " assumed" if self.solid_permittivity is None else ""
        return (
            f" (from the permittivity, by {self.effective_medium}; solid {self._solid:g}{assumed})"
        )

    @property
    def young(self) -> float:
        """Young's modulus of the foam at small strain, Pa."""
        if self.modulus is not None:
            return self.modulus
        assert self.solid_modulus is not None
        return self.solid_modulus * (1 - self.air) ** 2

    @property
    def elastic(self) -> Elastic:
        """The stress-strain law of the foam."""
        densified = self.densification_strain or self.air
        if self.stress_strain == "linear":
            return Hookean(self.young, densified)
        return Elastomer(self.young, self.plateau_stress or BUCKLING_STRAIN * self.young, densified)

    @property
    def unpressed_permittivity(self) -> float | None:
        """Relative permittivity of the unpressed foam; None if the law does not give it."""
        if self.effective_medium == "constant" or self.porosity is None:
            return None
        return float(self._permittivity(np.array(0.0)))

    def factor(self, strain: Real) -> Real:
        """Capacitance under compressive strain over the unpressed one, eps(e)/eps(0)/(1 - e)."""
        return self._permittivity(strain) / self._permittivity(np.array(0.0)) / (1 - strain)

    def strain_at(self, factor: Real) -> Real:
        """Strain at a capacitance factor, by bisection; 0 for factors < 1, at most the porosity."""
        low, high = np.zeros(np.shape(factor)), np.full(np.shape(factor), self.air)
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            beyond = self.factor(middle) > factor
            low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
        return np.where(np.asarray(factor) > 1, high, 0.0)

    def spread(self, thickness: float) -> float:
        """Length over which a deflection falls off next to an applicator, m.

        thickness: of the foam, m.
        """
        return math.sqrt(self.tension * thickness / self.young)

    def gain(self, strain: Real) -> Real:
        """d ln factor / d strain, by central difference."""
        inside = np.clip(strain, 0.0, self.air)
        low, high = np.maximum(inside - STEP, 0.0), np.minimum(inside + STEP, self.air)
        return np.log(self.factor(high) / self.factor(low)) / (high - low)

    def _permittivity(self, strain: Real) -> Real:
        if self.effective_medium == "constant":
            return np.ones_like(strain)
        return self._mixed((self.air - strain) / (1 - strain))

    def _mixed(self, porosity: Real) -> Real:
        return LAWS[self.effective_medium](porosity, self._solid)

    @property
    def _solid(self) -> float:
        """Relative permittivity of the solid, given or assumed."""
        return self.solid_permittivity or ASSUMED_SOLID_PERMITTIVITY

    @model_validator(mode="after")
    def _complete(self) -> Self:
        if (self.modulus is None) == (self.solid_modulus is None):
            raise ValueError("needs either modulus or solid_modulus")
        constant = self.effective_medium == "constant"
        if constant and self.solid_permittivity is not None:
            raise ValueError(f"takes no solid_permittivity with {CONSTANT}")
        if not constant and self.solid_permittivity is None and self.porosity is not None:
            raise ValueError(f"needs solid_permittivity with porosity, unless {CONSTANT}")
        if self.porosity is not None:
            self._check_densification()
        if self.stress_strain == "linear" and self.plateau_stress is not None:
            raise ValueError('plateau_stress does not apply to stress_strain = "linear"')
        return self

    def _check_densification(self) -> None:
        if (self.densification_strain or 0.0) > self.air:
            raise ValueError(
                f"densification_strain must be <= porosity {self.air:g}, "
                f"got {self.densification_strain:g}"
            )
