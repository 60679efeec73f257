"""The foam: capacitance, losses, and its strain under a press."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import Field, model_validator

from ...arrays import Real
from ..frequency import Loss
from ..maps.factor_maps import Map
from ..ranges import Leak, LossTangent, PerArea, Permittivity, Thickness
from ..validation import Number, Table, short
from .foam_in_time import Humidity, Hysteresis, Relaxations, Temperature
from .foam_mechanics import Mechanics, strain_of

GREATEST_STRAIN = 0.99
"""Largest strain of a foam without mechanics: a hundredth of its thickness is left."""
VACUUM_PERMITTIVITY = 8.8541878128e-12


ASSUMED_PERMITTIVITY = 2.0
"""Relative permittivity of a foam of which only c is known.

Open-cell rubber has 1.4 to 2.3: by Looyenga's law a porosity of 0.67 gives 1.46 for a solid of 2.8;
4 mm of the paper's foam with 70 pF need 2.2."""
ROUNDING = 1e-9
"""Relative rounding error allowed in a capacitance that equals that of vacuum."""


class Foam(Table):
    """The dielectric: its capacitance per area [F/m²], given or computed, and its losses.

    The capacitance is computed from thickness and relative_permittivity. If thickness and
    capacitance_per_area are both given, such as from measurements, they determine the permittivity.
    capacitance_per_area: of the unpressed foam. thickness: of the unpressed foam.
    relative_permittivity: of foam and air together, unpressed. loss_tangent: tan d in jwC (1 - j
    tan d). phase_exponent: a of a constant-phase capacitance (jw)^a, which has its nominal value at
    1 kHz; 1 is an ideal capacitor. leak: conductance of the foam over its capacitance, which is its
    conductivity over its permittivity [1/s]. map: factor on the capacitance by position. mechanics:
    response to depth or force of a press; it needs the thickness, and gives the permittivity unless
    that or capacitance_per_area is given. relaxation: one or two standard linear solids, by which
    the foam creeps under a press and recovers after it. hysteresis: fraction of the work of loading
    that unloading does not return; at the same load, a foam is more compressed in unloading than in
    loading.
    """

    capacitance_per_area: PerArea | None = None
    thickness: Thickness | None = None
    relative_permittivity: Permittivity | None = None
    loss_tangent: LossTangent = 0.0
    phase_exponent: Annotated[Number, Field(gt=0.5, le=1)] = 1.0
    leak: Leak | None = None
    map: Map | None = None
    mechanics: Mechanics | None = None
    relaxation: Relaxations | None = None
    hysteresis: Hysteresis | None = None
    temperature: Temperature | None = None
    humidity: Humidity | None = None

    @property
    def in_time(self) -> list[str]:
        """Keys that make the foam depend on time and duration of earlier presses."""
        keys = {"relaxation": self.relaxation, "hysteresis": self.hysteresis}
        return [f"skin.foam.{name}" for name, value in keys.items() if value]

    def strain_at(self, factor: Real) -> Real:
        """Compressive strain at a capacitance factor; 0 for factors below 1.

        The permittivity is constant without mechanics.
        """
        return strain_of(factor) if self.mechanics is None else self.mechanics.strain_at(factor)

    def factor_at(self, strain: Real) -> Real:
        """Capacitance factor at a compressive strain, the inverse of `strain_at`."""
        return 1 / (1 - strain) if self.mechanics is None else self.mechanics.factor(strain)

    @property
    def greatest_strain(self) -> float:
        """Largest compressive strain that is accepted for creep and hysteresis."""
        if self.mechanics is None:
            return GREATEST_STRAIN
        return self.mechanics.elastic.greatest_strain

    @property
    def loss(self) -> Loss:
        """Losses of the foam for the model's equations."""
        return Loss(self.loss_tangent, self.phase_exponent, self.leak or 0.0)

    @property
    def thickness_or_assumed(self) -> float:
        """Thickness in m; if it is not given, that of a foam of ASSUMED_PERMITTIVITY."""
        if self.thickness is not None:
            return self.thickness
        return VACUUM_PERMITTIVITY * ASSUMED_PERMITTIVITY / self.unpressed_capacitance_per_area

    @property
    def unpressed_capacitance_per_area(self) -> float:
        """Capacitance per area of the unpressed foam, F/m²."""
        if self.capacitance_per_area is not None:
            return self.capacitance_per_area
        permittivity = self.relative_permittivity
        if permittivity is None and self.mechanics is not None:
            permittivity = self.mechanics.unpressed_permittivity
        assert self.thickness is not None and permittivity is not None
        return VACUUM_PERMITTIVITY * permittivity / self.thickness

    @model_validator(mode="after")
    def _one_way_to_the_capacitance(self) -> Self:
        if self.mechanics is not None:
            self._one_way_of_a_foam_with(self.mechanics)
            return self
        direct, permittivity = self.capacitance_per_area, self.relative_permittivity
        if (direct is None) == (permittivity is None) or (permittivity and not self.thickness):
            raise ValueError(
                "needs either capacitance_per_area, or thickness with relative_permittivity"
            )
        return self

    @model_validator(mode="after")
    def _permittivity_of_a_dielectric(self) -> Self:
        """Raises ValueError if capacitance and thickness give less permittivity than vacuum has."""
        if self.capacitance_per_area is not None and self.thickness is not None:
            lowest = VACUUM_PERMITTIVITY / self.thickness
            if self.capacitance_per_area < lowest * (1 - ROUNDING):
                raise ValueError(
                    f"capacitance_per_area must be >= {short(lowest)} F/m², that of vacuum of the "
                    f"thickness {short(self.thickness)} m, got {short(self.capacitance_per_area)}"
                )
        return self

    def _one_way_of_a_foam_with(self, mechanics: Mechanics) -> None:
        given = (self.capacitance_per_area, self.relative_permittivity)
        if self.thickness is None:
            raise ValueError("needs thickness where mechanics is given")
        if None not in given:
            raise ValueError("takes capacitance_per_area or relative_permittivity, not both")
        constant = mechanics.effective_medium == "constant"
        if given == (None, None) and constant:
            raise ValueError(
                "needs capacitance_per_area or relative_permittivity where "
                'mechanics.effective_medium = "constant"'
            )
        object.__setattr__(self, "mechanics", mechanics.with_permittivity(self._permittivity))

    @property
    def _permittivity(self) -> float | None:
        """Relative permittivity that the keys of the foam give, None if they give none."""
        if self.capacitance_per_area is None or self.thickness is None:
            return self.relative_permittivity
        return self.capacitance_per_area * self.thickness / VACUUM_PERMITTIVITY
