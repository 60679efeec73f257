"""Random variation of skins and presses of a data set: distributions, odds of faults."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Literal, Self

import numpy as np
from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    SerializerFunctionWrapHandler,
    model_serializer,
    model_validator,
)

from ..arrays import Real
from .foam import AMBIENT, ambient_factors
from .foam_mechanics import REACH_OF_APPLICATORS
from .validation import Number, NumberRange, Table, Whole, validated, within

if TYPE_CHECKING:
    from .foam import Foam

Finite = Annotated[Number, within(-1e15, 1e15, "", "no drawn quantity is larger")]

Cut = Annotated[
    Number, within(0.01, 8.0, "deviations", "beyond 8 deviations no value is ever drawn")
]

Chances = Real | np.float64 | float


class _Drawn(Table):
    """Base of all distributions.

    low, high: the smallest and the largest value that can be drawn. at: quantiles, the values below
    which a draw falls with the given probabilities.
    """


class Fixed(_Drawn):
    """A constant value; a number in place of a table is short for this.

    value: of every draw.
    """

    distribution: Literal["fixed"] = "fixed"
    value: Number

    @property
    def low(self) -> float:
        return self.value

    @property
    def high(self) -> float:
        return self.value

    def at(self, chance: Chances) -> Real:
        return np.full(np.shape(chance), float(self.value))


class Uniform(_Drawn):
    """Uniform between `low` and `high`; a table of these two keys alone is short for this.

    low: smallest value. high: largest value.
    """

    distribution: Literal["uniform"] = "uniform"
    low: Finite
    high: Finite

    @model_validator(mode="after")
    def _low_to_high(self) -> Self:
        if not self.low <= self.high:
            raise ValueError(f"low must be <= high, got {self.low:g} and {self.high:g}")
        return self

    def at(self, chance: Chances) -> Real:
        return self.low + (self.high - self.low) * np.asarray(chance)


class Normal(_Drawn):
    """Normal with `mean` and standard `deviation`, truncated at `cut` deviations.

    mean: of the distribution. deviation: before truncation. cut: number of deviations from the mean
    that draws do not exceed.
    """

    distribution: Literal["normal"] = "normal"
    mean: Finite
    deviation: Annotated[
        Number, within(0.0, 1e15, "(in the unit of mean)", "no drawn quantity is larger")
    ]
    cut: Cut = 3.0

    @property
    def low(self) -> float:
        return self.mean - self.cut * self.deviation

    @property
    def high(self) -> float:
        return self.mean + self.cut * self.deviation

    def at(self, chance: Chances) -> Real:
        return self.mean + self.deviation * truncated_normal(chance, self.cut)


class Lognormal(_Drawn):
    """A value whose logarithm is normally distributed around that of `median`.

    median: of the value. spread: standard deviation of the logarithm; a small one is the relative
    standard deviation of the value. cut: number of these deviations from the median that draws do
    not exceed.
    """

    distribution: Literal["lognormal"] = "lognormal"
    median: Annotated[
        Number, within(1e-15, 1e15, "(in its own unit)", "no drawn quantity is larger")
    ]
    spread: Annotated[Number, within(0.0, 10.0, "(relative)", "e to the 10th is 22,000")]
    cut: Cut = 3.0

    @property
    def low(self) -> float:
        return self.median * math.exp(-self.cut * self.spread)

    @property
    def high(self) -> float:
        return self.median * math.exp(self.cut * self.spread)

    def at(self, chance: Chances) -> Real:
        return self.median * np.exp(self.spread * truncated_normal(chance, self.cut))


def truncated_normal(chance: Chances, cut: float) -> Real:
    """Quantiles of the standard normal distribution truncated to |x| <= cut."""
    from scipy.special import ndtr, ndtri

    outside = ndtr(-cut)
    return np.clip(ndtri(outside + (1 - 2 * outside) * np.asarray(chance)), -cut, cut)


AnyDistribution = Fixed | Uniform | Normal | Lognormal


KINDS = {
    kind.model_fields["distribution"].default: kind for kind in (Fixed, Uniform, Normal, Lognormal)
}


def _chosen(given: object) -> object:
    if isinstance(given, AnyDistribution):
        return given
    if isinstance(given, bool) or not isinstance(given, dict | float | int):
        raise ValueError(f"must be a number or a table with a distribution, got {given!r}")
    if not isinstance(given, dict):
        return Fixed(value=given)
    if given.keys() == {"low", "high"}:
        return validated(Uniform, given)
    kind = KINDS.get(given.get("distribution"))
    if kind is None:
        named = given.get("distribution")
        raise ValueError(f"distribution must be one of {', '.join(KINDS)}, got {named!r}")
    return validated(kind, given)


Distribution = Annotated[AnyDistribution, BeforeValidator(_chosen)]


class EveryDrawWithin(NumberRange):
    """A validator that checks all values that a distribution can draw."""

    def __call__(self, drawn: AnyDistribution) -> AnyDistribution:
        self.check(drawn.low, drawn.high, of=" in every draw")
        return drawn


def drawn_within(low: float, high: float, unit: str, why: str) -> AfterValidator:
    """Accepts distributions whose draws are all from `low` to `high`."""
    return AfterValidator(EveryDrawWithin(low, high, unit, why))


Odds = Annotated[Number, Field(ge=0, le=1)]

FAULTS = ("dead_foil", "half_foil", "tear", "stuck_spot", "aged_gain")
"""Keys with the odds of each kind of fault."""


class FaultOdds(Table):
    """Odds that the skin or the reader of a session has a fault; a session has one at most.

    dead_foil: a foil without contact to its sheet. half_foil: a foil of which half the length has
    no contact. tear: a straight cut of a sheet from an edge inwards, without conductance. tears:
    number of different tears in a data set; each takes the training of a model. tear_length: over
    the skin's side. torn_sheets: one of the two sheets, or both at the same place. stuck_spot: a
    pixel whose foam stays pressed. stuck_factor: its capacitance over the unpressed one; a touch
    there multiplies what is left. aged_gain: a reader whose gain has changed. gain_factor: the
    factor on its readings at the lowest and at the highest frequency, drawn for each, and between
    them linear in the logarithm of frequency.
    """

    dead_foil: Odds = 0.0
    half_foil: Odds = 0.0
    tear: Odds = 0.0
    stuck_spot: Odds = 0.0
    aged_gain: Odds = 0.0
    tears: Annotated[Whole, Field(ge=1, le=100)] = 4
    tear_length: Annotated[
        Distribution,
        drawn_within(0.01, 0.95, "of the skin's side", "the rest of the sheet stays connected"),
    ] = Uniform(low=0.3, high=0.9)
    torn_sheets: Literal["one", "both"] = "one"
    stuck_factor: Annotated[
        Distribution,
        drawn_within(1.0, 100.0, "times the unpressed value", "foam closes before that"),
    ] = Uniform(low=1.2, high=2.5)
    gain_factor: Annotated[
        Distribution, drawn_within(0.1, 10.0, "(relative)", "such a reader is broken")
    ] = Uniform(low=0.9, high=1.1)

    @property
    def odds(self) -> dict[str, float]:
        """Odds of each kind of fault."""
        return {name: getattr(self, name) for name in FAULTS}

    @model_validator(mode="after")
    def _at_most_one_fault(self) -> Self:
        total = sum(self.odds.values())
        if total > 1 + 1e-9:
            raise ValueError(f"{', '.join(FAULTS)} must sum to at most 1, got {total:g}")
        return self


CUT = 3.0
"""Truncation, in standard deviations, of the coefficients of cosine modes and of the spread of
pixels."""

SLOW_MODES = 3
MAX_UNEVENNESS = 0.1
"""Conductance and capacitance stay positive: CUT * SLOW_MODES * MAX_UNEVENNESS < 1."""

Factor = Annotated[
    Distribution,
    drawn_within(
        1e-6, 1e6, "times the unpressed value", "foam cannot be compressed or expanded further"
    ),
]

Relative = Annotated[
    Distribution, drawn_within(1e-3, 1e3, "times the scene's own", "no batch differs more")
]

Length = Annotated[Distribution, drawn_within(1e-8, 1e3, "m", "no touch is larger or smaller")]

Finger = Annotated[
    Distribution, drawn_within(0.0, 1e-9, "F", "a whole hand has tens of picofarads to a sheet")
]

Spread = Annotated[Number, Field(ge=0, le=MAX_UNEVENNESS)]

Shape = Literal["rectangle", "disc"]


def _chances(values: tuple[float, ...]) -> tuple[float, ...]:
    if min(values) < 0 or not math.isclose(sum(values), 1, abs_tol=1e-9):
        raise ValueError(f"must be >= 0 and sum to 1, got {list(values)}")
    return values


WEAK_TO_STRONG = Uniform(low=1.3, high=4.5)
"""Default factors of drawn presses.

Localizers refuse presses much stronger than those that they learned, and weak ones are not found
worse for it: 5x5, columns on other skins, the paper's SVM and `gaussian`.
"""


class DrawnPress(Table):
    """A random press: number, places, sizes and strengths of its touches.

    touches: probabilities of 0, 1 and 2 touches. place: whole pixels, or anywhere on the skin.
    offset: standard deviation of a touch's displacement from its pixel along each side, over that
    side; the label of the press is the pixel without displacement. factor: capacitance over the
    unpressed one; in a scene that presses by depth, the factor under the applicator, unless depth
    is drawn; default uniform from 1.3 to 4.5, or as far as the foam can be compressed. depth: into
    the foam, in place of factor. shape: of a touch at the place "anywhere".
    size: sides of a rectangle or diameter of a disc, at the place "anywhere". cells_per_pixel:
    cells along each side of a pixel if touches are not whole pixels; the capacitance of a cell
    rises in proportion to its covered part, or by the mean over the cell where a tension spreads
    the press. finger: capacitance of a touch to earth, uniform over the touch; default that of the
    scene's `press.finger`. without_press: fraction of touches by a finger without pressure.
    capacitance: that to earth which a touch adds in a scene with `press.adds`, in place of factor;
    default `press.capacitance`.
    """

    touches: Annotated[
        tuple[Number, ...], Field(min_length=1, max_length=3), AfterValidator(_chances)
    ] = (0.1, 0.7, 0.2)
    place: Literal["pixel", "anywhere"] = "pixel"
    offset: Annotated[Number, Field(ge=0, le=0.5)] = 0.0
    shape: Annotated[tuple[Shape, ...], Field(min_length=1)] = ("rectangle", "disc")
    size: Length = Uniform(low=0.01, high=0.02)
    cells_per_pixel: Annotated[Whole, Field(ge=1, le=20)] = 4
    factor: Factor | None = None
    depth: Length | None = None
    finger: Finger | None = None
    without_press: Annotated[Number, Field(ge=0, le=1)] | None = None
    capacitance: Finger | None = None

    @model_serializer(mode="wrap")
    def _without_unused(self, everything: SerializerFunctionWrapHandler) -> dict[str, object]:
        unused = "capacitance" if self.capacitance is None else "factor"
        return {key: value for key, value in everything(self).items() if key != unused}

    @property
    def cells(self) -> int:
        """Cells along each side of a pixel."""
        return self.cells_per_pixel if self.rasterized else 1

    def factor_within(self, foam: Foam) -> AnyDistribution:
        """Distribution of the factor; the default reaches no further than a foam can be pressed.

        Foam is pressed no further than models of applicators cover, creep and places where two
        touches meet included.
        """
        if self.factor is not None or (foam.mechanics is None and not foam.in_time):
            return self.factor or WEAK_TO_STRONG
        creep = 1 + sum(each.share for each in foam.relaxation or ())
        strain = REACH_OF_APPLICATORS * foam.greatest_strain / creep
        meeting = 2 if self.rasterized and self.max_touches > 1 else 1
        most = float(foam.factor_at(np.array(strain))) ** (1 / meeting)
        high = min(WEAK_TO_STRONG.high, math.floor(1000 * most) / 1000)
        return Uniform(low=min(WEAK_TO_STRONG.low, (1 + high) / 2), high=high)

    @property
    def rasterized(self) -> bool:
        """True if touches are not whole pixels, so that they are rasterized on cells."""
        return self.place == "anywhere" or self.offset > 0

    @property
    def max_touches(self) -> int:
        """The largest number of touches with a probability above 0."""
        return max(count for count, chance in enumerate(self.touches) if chance > 0)


class Session(Table):
    """Quantities that are drawn once for every session.

    sweeps_per_session: number of sweeps between two draws. rest_every: number of presses between
    baseline sweeps; a session begins with three of them, as in a lab. 0: the only unpressed sweeps
    are those that `touches` draws. sheet_resistance: common factor on both sheets (ageing,
    humidity). sheet_mismatch: further factor, drawn for each sheet. unevenness: standard deviation
    of each cosine mode of a sheet's conductance over its mean; the modes are half a cosine along x,
    along y, and along both. capacitance: factor on the whole foam. foam_spread: relative standard
    deviation of the capacitance over the foam. foam_pattern: that deviation is drawn for each pixel
    independently, or, if "smooth", for each cosine mode. loss_tangent: added to that of the foam.
    contact_resistance: factor, drawn for each contact; ideal foils have no resistance.
    stray_capacitance, lead_resistance: added to that of the leads; a guard does not reduce it.
    temperature [°C], humidity [%RH]: ambient of a session, if the foam has tables for them; default
    those of `experiment`. body, rim: factors on the capacitance of the scene's `surroundings.body`
    and of its rim; default 1. faults: odds of faults; default none.

    The defaults are assumptions. Simulations of electrical impedance tomography for transfer to
    real devices used 3 % for geometry and 4 % for contacts in each session. 5 % for the sheets
    represents carbon-filled rubber from one batch. The leads represent 10 cm of cable after the
    meter's own open and short correction.
    """

    sweeps_per_session: Annotated[Whole, Field(ge=1, le=100_000)] = 500
    rest_every: Annotated[Whole, Field(ge=0, le=100_000)] = 0
    sheet_resistance: Relative = Lognormal(median=1.0, spread=0.05)
    sheet_mismatch: Relative = Lognormal(median=1.0, spread=0.03)
    unevenness: Spread = 0.02
    capacitance: Relative = Normal(mean=1.0, deviation=0.03)
    foam_spread: Spread = 0.02
    foam_pattern: Literal["pixel", "smooth"] = "pixel"
    loss_tangent: Annotated[
        Distribution, drawn_within(0.0, 1e3, "(tan d)", "a foam with larger losses stores nothing")
    ] = Uniform(low=0.0, high=0.02)
    contact_resistance: Relative = Lognormal(median=1.0, spread=0.04)
    stray_capacitance: Annotated[
        Distribution, drawn_within(0.0, 10.0, "F", "leads have picofarads")
    ] = Uniform(low=0.0, high=2e-12)
    lead_resistance: Annotated[
        Distribution, drawn_within(0.0, 1e12, "ohm", "no meter reads more")
    ] = Uniform(low=0.0, high=2.0)
    body: Relative | None = None
    rim: Relative | None = None
    temperature: (
        Annotated[Distribution, drawn_within(-200.0, 1000.0, "°C", "no foam withstands more")]
        | None
    ) = None
    humidity: (
        Annotated[Distribution, drawn_within(0.0, 100.0, "%RH", "air holds no more water")] | None
    ) = None
    faults: FaultOdds | None = None

    def check_ambient(self, foam: Foam) -> None:
        """Raises ValueError if a drawn temperature or humidity does not suit the foam.

        The foam needs a table for it, and the factors must be allowed by `ambient_factors`.
        """
        for name in AMBIENT:
            drawn, table = getattr(self, name), getattr(foam, name)
            if drawn is None:
                continue
            key = f"dataset.session.{name}"
            if table is None:
                raise ValueError(f"`{key}` needs the table skin.foam.{name}")
            for state in (drawn.low, drawn.high):
                ambient_factors(table, state, key)


class Randomisation(Table):
    """Random variation of a data set's sweeps between presses and between sessions."""

    press: DrawnPress = DrawnPress()
    session: Session = Session()
