"""Allowed ranges of the numbers of a scene, with a reason for each limit.

The ranges are far wider than those of real skins, so that a number in another unit is still read;
the warning then suggests the number that was likely intended (`requests.plausibility`). Outside
these ranges a skin is not thin, quasi-static and linear, or double precision cannot represent the
largest and smallest quantities of one skin.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import AfterValidator, BeforeValidator, Field

from .validation import Number, NumberRange, Whole, within

MIN_FILM_RESISTANCE = 1e-12
"""Smallest contact resistance that is not 0, ohm m: a thousandth of that of soldered metal, with a
finite conductance."""


def ideal_or_resolved(resistance: float) -> float:
    """Returns a contact resistance in ohm m. Raises ValueError for one that is nearly 0."""
    if 0 < resistance < MIN_FILM_RESISTANCE:
        raise ValueError(
            f"must be 0, or at least {MIN_FILM_RESISTANCE:g} ohm m, got {resistance:g}"
        )
    return resistance


Length = Annotated[
    Number, within(1e-5, 1e3, "m", "no skin is smaller than a cell of foam or larger than 1 km")
]
Thickness = Annotated[
    Number,
    within(1e-8, 10.0, "m", "thinner films leak by tunnelling, thicker foam is no sheet"),
]
Distance = Annotated[
    Number,
    within(
        1e-8, 1e3, "m", "measured from the sheet away from the foam; no body is inside the foam"
    ),
]
Air = Annotated[Number, within(0.0, 10.0, "m", "a finger farther away has no effect")]
PerLength = Annotated[
    Number, within(0.0, 1e-6, "F/m", "vacuum has 8.85e-12 F/m, and a rim has about as much")
]
SheetResistance = Annotated[
    Number, within(1e-6, 1e12, "ohm/sq", "from copper 1 cm thick to insulators")
]
Overlap = Annotated[
    Number, within(0.0, 1e3, "m", "measured from the edge inwards; no sheet is larger")
]
PerArea = Annotated[
    Number,
    within(1e-15, 1e3, "F/m²", "a gap of 10 m has more, an ionic double layer has less"),
]
Permittivity = Annotated[
    Number, within(1.0, 1e6, "(relative)", "vacuum has 1, the strongest dielectrics have 1e6")
]
LossTangent = Annotated[
    Number, within(0.0, 1e3, "(tan d)", "a foam with larger losses conducts and stores nothing")
]
Leak = Annotated[Number, within(0.0, 1e12, "1/s", "a foam that leaks faster stores nothing")]
Piezoresistance = Annotated[
    Number,
    within(-0.999, 1e4, "(relative)", "at -1 a sheet would lose all resistance"),
]
Angle = Annotated[Number, within(-360.0, 360.0, "rad", "a turn is 6.283 rad")]
Frequency = Annotated[
    Number,
    within(1e-6, 1e12, "Hz", "1e-6 Hz is a period of days, 1e12 Hz is infrared light"),
]
Share = Annotated[Number, within(0.0, 1.0, "of |Z|", "1 is an error as large as |Z| itself")]
Phase = Annotated[
    Number, within(0.0, 1.5708, "rad", "an error of pi/2 turns a capacitance into a resistance")
]
Resistance = Annotated[Number, within(0.0, 1e12, "ohm", "no meter reads more")]
FilmResistance = Annotated[
    Number,
    within(0.0, 1e10, "ohm m", "beyond it no measurable current enters a sheet"),
    AfterValidator(ideal_or_resolved),
]
MAX_INDUCTANCE = 10.0
Inductance = Annotated[
    Number, within(0.0, MAX_INDUCTANCE, "H", "leads have microhenries, large coils have 1 H")
]
Capacitance = Annotated[Number, within(0.0, 10.0, "F", "leads have picofarads")]
MAX_FACTOR = 1e6
CapacitanceFactor = Annotated[
    Number,
    within(
        1e-6,
        MAX_FACTOR,
        "times the unpressed value",
        "foam cannot be compressed or expanded further",
    ),
]
TouchCapacitance = Annotated[
    Number, within(0.0, 1e-6, "F", "a finger has picofarads, a hand on a film has nanofarads")
]
Force = Annotated[Number, within(1e-9, 1e6, "N", "from a mote of dust to a locomotive's weight")]
Stress = Annotated[Number, within(1e-3, 1e13, "Pa", "diamond has 1e12 Pa")]
Tension = Annotated[Number, within(0.0, 1e8, "N/m", "a metre of steel, 10 cm thick, tears")]
MapFactor = Annotated[
    Number, within(1e-6, 1e6, "times the nominal value", "a larger ratio means two materials")
]
Slope = Annotated[Number, within(-2e6, 2e6, "(relative)", "the factor must stay positive")]
Seconds = Annotated[Number, within(1e-6, 1e7, "s", "from the time of a reading to months")]

FINGERS = ("earthed", "floating")


class FingerOrWithin(NumberRange):
    """A validator of fingers: one of FINGERS, or a capacitance to earth."""

    def __call__(self, given: object) -> object:
        if isinstance(given, str | bool) or not isinstance(given, int | float):
            if given not in FINGERS:
                named = " or ".join(map(repr, FINGERS))
                raise ValueError(f"must be {named} or a capacitance in F, got {given!r}")
            return given
        self.check(given)
        return float(given)


Finger = Literal["earthed", "floating"] | float
AnyFinger = Annotated[
    Finger,
    BeforeValidator(
        FingerOrWithin(0.0, 1e-6, "F", "a finger has picofarads, a hand on a film has nanofarads")
    ),
]

MAX_SEED = 2**32 - 1
"""Largest seed of scikit-learn; all seeds have this range."""

Seed = Annotated[Whole, Field(ge=0, le=MAX_SEED)]
