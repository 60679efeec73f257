"""What a foam is made of, and what follows: its stress and its permittivity when compressed."""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from simulator.effective_medium import LAWS
from simulator.elastic_foam import Elastic, Elastomer, Hookean
from simulator.table import Table
from simulator.validation import Number, above_zero, at_least_zero

BUCKLING_STRAIN = 0.05
"""Plateau stress over Young's modulus of elastomeric foams: Gibson and Ashby, eq. 5.18 over 5.6."""
STEP = 1e-6
HALVINGS = 53


class Mechanics(Table):
    """A foam of porosity `porosity` that narrows nowhere as it is compressed (Poisson's ratio 0).

    Pores close as its volume falls: strain e leaves the porosity (porosity - e)/(1 - e), of which
    the law `effective_medium` makes the permittivity; "constant" leaves that as it is. modulus
    [Pa]: Young's, or `solid_modulus` (1 - porosity)², that of open cells (Gibson and Ashby, eq.
    5.6). plateau_stress [Pa]: 0.05 of the modulus unless given. densification_strain: the porosity
    unless given. tension [N/m]: of both electrode skins together, the same in every direction.
    """

    porosity: Annotated[Number, Field(gt=0, lt=1)]
    solid_permittivity: Annotated[Number, Field(ge=1, allow_inf_nan=False)] | None = None
    effective_medium: Literal[
        "looyenga", "bruggeman", "lichtenecker", "maxwell-garnett", "constant"
    ] = "looyenga"
    modulus: Annotated[Number, above_zero("Pa")] | None = None
    solid_modulus: Annotated[Number, above_zero("Pa")] | None = None
    stress_strain: Literal["elastomer", "linear"] = "elastomer"
    plateau_stress: Annotated[Number, above_zero("Pa")] | None = None
    densification_strain: Annotated[Number, Field(gt=0, lt=1)] | None = None
    tension: Annotated[Number, at_least_zero("N/m")] = 0.0

    @property
    def young(self) -> float:
        """Young's modulus of the foam at small strain, Pa."""
        if self.modulus is not None:
            return self.modulus
        assert self.solid_modulus is not None
        return self.solid_modulus * (1 - self.porosity) ** 2

    @property
    def elastic(self) -> Elastic:
        """Its stress-strain law."""
        densified = self.densification_strain or self.porosity
        if self.stress_strain == "linear":
            return Hookean(self.young, densified)
        return Elastomer(self.young, self.plateau_stress or BUCKLING_STRAIN * self.young, densified)

    @property
    def rest_permittivity(self) -> float | None:
        """Relative permittivity at rest by the law; None where that is "constant"."""
        if self.effective_medium == "constant":
            return None
        return float(self._permittivity(np.array(0.0)))

    def factor(self, strain: NDArray[np.float64]) -> NDArray[np.float64]:
        """Capacitance over that at rest under compressive strain, eps(e)/eps(0)/(1 - e)."""
        return self._permittivity(strain) / self._permittivity(np.array(0.0)) / (1 - strain)

    def strain_at(self, factor: NDArray[np.float64]) -> NDArray[np.float64]:
        """The strain that brings a factor about, by bisection; 0 below 1, at most the porosity."""
        low, high = np.zeros(np.shape(factor)), np.full(np.shape(factor), self.porosity)
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            beyond = self.factor(middle) > factor
            low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
        return np.where(np.asarray(factor) > 1, high, 0.0)

    def gain(self, strain: NDArray[np.float64]) -> NDArray[np.float64]:
        """d ln factor / d strain, by central difference."""
        inside = np.clip(strain, 0.0, self.porosity)
        low, high = np.maximum(inside - STEP, 0.0), np.minimum(inside + STEP, self.porosity)
        return np.log(self.factor(high) / self.factor(low)) / (high - low)

    def _permittivity(self, strain: NDArray[np.float64]) -> NDArray[np.float64]:
        if self.effective_medium == "constant":
            return np.ones_like(strain)
        assert self.solid_permittivity is not None
        left = (self.porosity - strain) / (1 - strain)
        return LAWS[self.effective_medium](left, self.solid_permittivity)

    @model_validator(mode="after")
    def _complete(self) -> Self:
        if (self.modulus is None) == (self.solid_modulus is None):
            raise ValueError("needs either modulus or solid_modulus")
        if (self.solid_permittivity is None) != (self.effective_medium == "constant"):
            raise ValueError(
                'needs solid_permittivity, unless effective_medium = "constant", which takes none'
            )
        if (self.densification_strain or 0.0) > self.porosity:
            raise ValueError(
                f"densification_strain must be <= porosity {self.porosity:g}, "
                f"got {self.densification_strain:g}"
            )
        if self.stress_strain == "linear" and self.plateau_stress is not None:
            raise ValueError('plateau_stress has no place in stress_strain = "linear"')
        return self
