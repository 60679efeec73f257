"""Changes of a foam: creep and recovery under presses, dependence on temperature and humidity."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from pydantic import Field

from ..ranges import Seconds
from ..validation import Number, Table, short, within

if TYPE_CHECKING:
    from ..readout.meter import Experiment
    from ..skin import SkinTable
    from .foam import Foam

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
