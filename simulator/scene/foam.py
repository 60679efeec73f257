"""The foam: capacitance, losses, strain under a press, changes with time and weather."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Self

from pydantic import Field, model_validator

from ..arrays import Real
from .factor_maps import Map
from .foam_mechanics import Mechanics, strain_of
from .frequency import Loss
from .ranges import Leak, LossTangent, PerArea, Permittivity, Seconds, Thickness
from .validation import Number, Table, short, within

if TYPE_CHECKING:
    from .meter import Experiment
    from .skin import SkinTable

Creep = Annotated[
    Number, within(1e-6, 10.0, "of the strain at once", "a material that creeps more is a liquid")
]

Hysteresis = Annotated[
    Number,
    within(
        0.0,
        1 / 3,
        "of the work of loading",
        "with more than 1/3 the foam would sink during release",
    ),
]

Celsius = Annotated[Number, within(-200.0, 1000.0, "°C", "no foam withstands more")]
Humid = Annotated[Number, within(0.0, 100.0, "%RH", "air holds no more water")]
PerKelvin = Annotated[Number, within(-0.1, 0.1, "1/K", "thermistors have 0.1")]
PerPercent = Annotated[Number, within(-0.1, 0.1, "1/%RH", "hygrometers have 0.1")]

MIN_CHANGE, MAX_CHANGE = 0.1, 10.0
"""Limits of the factor for which a linear law in temperature or humidity is accepted."""


class Relaxation(Table):
    """One standard linear solid: strain that creeps and recovers with a time constant.

    share: final creep strain over the instantaneous strain of a load. time_constant [s]: of creep
    and of recovery after the load.
    """

    share: Creep
    time_constant: Seconds


class Temperature(Table):
    """Relative changes of capacitance and sheet resistance per kelvin away from a reference.

    The scene's numbers hold at the reference. The temperature is that of `experiment`, or drawn by
    `dataset.session`. reference: temperature at which the scene's numbers hold. capacitance:
    relative rise per kelvin. sheet_resistance: relative rise per kelvin, of both sheets.
    """

    reference: Celsius = 23.0
    capacitance: PerKelvin = 0.0
    sheet_resistance: PerKelvin = 0.0


class Humidity(Table):
    """Relative changes of capacitance and sheet resistance per percent of relative humidity.

    reference: humidity at which the scene's numbers hold. capacitance: relative rise per percent.
    sheet_resistance: relative rise per percent, of both sheets.
    """

    reference: Humid = 50.0
    capacitance: PerPercent = 0.0
    sheet_resistance: PerPercent = 0.0


Relaxations = Annotated[tuple[Relaxation, ...], Field(min_length=1, max_length=2)]

AMBIENT = ("temperature", "humidity")
"""Tables of the foam; `experiment` and `dataset.session` have keys of the same names."""

IN_TIME = ("relaxation", "hysteresis", *AMBIENT)
"""Keys of the foam that describe its changes."""


def ambient_factors(table: Temperature | Humidity, state: float, key: str) -> tuple[float, float]:
    """Factors on capacitance and on sheet resistance away from the reference.

    Raises ValueError naming the key if a factor is outside MIN_CHANGE to MAX_CHANGE.
    """
    away = state - table.reference
    factors = 1 + table.capacitance * away, 1 + table.sheet_resistance * away
    for name, factor in zip(("capacitance", "sheet_resistance"), factors, strict=True):
        if not MIN_CHANGE <= factor <= MAX_CHANGE:
            raise ValueError(
                f"`{key}` must leave {name} from {MIN_CHANGE:g} to {MAX_CHANGE:g} times that at "
                f"the reference {table.reference:g}, got {state:g}, which leaves {factor:.3g}"
            )
    return factors


def in_ambient(skin: SkinTable, experiment: Experiment) -> SkinTable:
    """The skin at the temperature and humidity of an experiment, which become its references.

    Capacitance, sheet resistances and coefficients are converted, so that the linear law in
    temperature or humidity is unchanged. Raises ValueError if `experiment` names a state for which
    the foam has no table, as `ambient_factors`, and for a permittivity < 1.
    """
    for name in AMBIENT:
        state, table = getattr(experiment, name), getattr(skin.foam, name)
        if state is None:
            continue
        key = f"experiment.{name}"
        if table is None:
            raise ValueError(f"`{key}` needs the table skin.foam.{name}, got {state:g} alone")
        if state != table.reference:
            skin = _referred(skin, name, table, state, ambient_factors(table, state, key))
    return skin


def _referred(
    skin: SkinTable, name: str, table: Temperature | Humidity, state: float, by: tuple[float, float]
) -> SkinTable:
    of_foam, of_sheets = by
    there = table.model_copy(
        update={
            "reference": state,
            "capacitance": table.capacitance / of_foam,
            "sheet_resistance": table.sheet_resistance / of_sheets,
        }
    )
    foam = with_capacitance(skin.foam, of_foam, f"experiment.{name}")
    sheets = {
        side: sheet.model_copy(update={"sheet_resistance": sheet.sheet_resistance * of_sheets})
        for side, sheet in (("top", skin.top), ("bottom", skin.bottom))
    }
    return skin.model_copy(update={**sheets, "foam": foam.model_copy(update={name: there})})


def with_capacitance(foam: Foam, factor: float, key: str) -> Foam:
    """A foam with a multiple of the capacitance and the same thickness.

    Raises ValueError naming the key that requires it if the permittivity would be below 1.
    """
    if foam.relative_permittivity is None:
        c = foam.unpressed_capacitance_per_area * factor
        return foam.model_copy(update={"capacitance_per_area": c})
    permittivity = foam.relative_permittivity * factor
    if permittivity < 1:
        raise ValueError(
            f"`{key}` must leave skin.foam.relative_permittivity >= 1, got {short(permittivity)}"
        )
    return foam.model_copy(update={"relative_permittivity": permittivity})


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
