"""How skins and presses of a data set differ: distributions, and what is drawn from them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, BeforeValidator, Field, ValidationError, model_validator

from .foam_in_time import AMBIENT, ambient_factors
from .validation import Number, NumberRange, Table, Whole, one_line, within

if TYPE_CHECKING:
    from .skin import Foam

Finite = Annotated[Number, within(-1e15, 1e15, "", "no quantity that is drawn is larger")]

Cut = Annotated[Number, within(0.01, 8.0, "deviations", "beyond 8 nothing is ever drawn")]

Chances = NDArray[np.float64] | np.float64 | float


class _Drawn(Table):
    """What all distributions have.

    low, high: the least and the largest value that is drawn. at: the values below which a draw
    falls with these chances (quantiles).
    """


class Fixed(_Drawn):
    """One value, always; a plain number means this."""

    distribution: Literal["fixed"] = "fixed"
    value: Finite

    @property
    def low(self) -> float:
        return self.value

    @property
    def high(self) -> float:
        return self.value

    def at(self, chance: Chances) -> NDArray[np.float64]:
        return np.full(np.shape(chance), float(self.value))


class Uniform(_Drawn):
    """Any value between `low` and `high` alike; a table of these two alone means this."""

    distribution: Literal["uniform"] = "uniform"
    low: Finite
    high: Finite

    @model_validator(mode="after")
    def _low_to_high(self) -> Self:
        if not self.low <= self.high:
            raise ValueError(f"low must be <= high, got {self.low:g} and {self.high:g}")
        return self

    def at(self, chance: Chances) -> NDArray[np.float64]:
        return self.low + (self.high - self.low) * np.asarray(chance)


class Normal(_Drawn):
    """Normal about `mean` with standard `deviation`; nothing beyond `cut` deviations is drawn."""

    distribution: Literal["normal"] = "normal"
    mean: Finite
    deviation: Annotated[
        Number, within(0.0, 1e15, "(in the unit of mean)", "no quantity that is drawn is larger")
    ]
    cut: Cut = 3.0

    @property
    def low(self) -> float:
        return self.mean - self.cut * self.deviation

    @property
    def high(self) -> float:
        return self.mean + self.cut * self.deviation

    def at(self, chance: Chances) -> NDArray[np.float64]:
        return self.mean + self.deviation * truncated_normal(chance, self.cut)


class Lognormal(_Drawn):
    """A value whose logarithm is normal about that of `median`.

    spread: standard deviation of the logarithm, for small ones the relative standard deviation;
    nothing beyond `cut` of them is drawn.
    """

    distribution: Literal["lognormal"] = "lognormal"
    median: Annotated[
        Number, within(1e-15, 1e15, "(in its own unit)", "no quantity that is drawn is larger")
    ]
    spread: Annotated[Number, within(0.0, 10.0, "(relative)", "e to the 10th is 22,000")]
    cut: Cut = 3.0

    @property
    def low(self) -> float:
        return self.median * math.exp(-self.cut * self.spread)

    @property
    def high(self) -> float:
        return self.median * math.exp(self.cut * self.spread)

    def at(self, chance: Chances) -> NDArray[np.float64]:
        return self.median * np.exp(self.spread * truncated_normal(chance, self.cut))


def truncated_normal(chance: Chances, cut: float) -> NDArray[np.float64]:
    """Quantiles of the standard normal distribution of which only |x| <= cut is kept."""
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
        return _of_kind(Uniform, given)
    kind = KINDS.get(given.get("distribution"))
    if kind is None:
        named = given.get("distribution")
        raise ValueError(f"distribution must be one of {', '.join(KINDS)}, got {named!r}")
    return _of_kind(kind, given)


def _of_kind(kind: type[AnyDistribution], given: dict) -> AnyDistribution:
    try:
        return kind.model_validate(given)
    except ValidationError as error:
        raise ValueError(one_line(error, kind)) from error


Distribution = Annotated[AnyDistribution, BeforeValidator(_chosen)]


class EveryDrawWithin(NumberRange):
    """A validator of distributions by all that they may draw."""

    def __call__(self, drawn: AnyDistribution) -> AnyDistribution:
        self.check(drawn.low, drawn.high, of=" in every draw")
        return drawn


def drawn_within(low: float, high: float, unit: str, why: str) -> AfterValidator:
    """Accepts distributions of which every draw is from `low` to `high`."""
    return AfterValidator(EveryDrawWithin(low, high, unit, why))


CUT = 3.0
"""Standard deviations beyond which no coefficient of a slow variation or spread is drawn."""

SLOW_MODES = 3
MAX_UNEVENNESS = 0.1
"""Conductance and capacitance stay positive: CUT * SLOW_WAVES * MOST_UNEVEN < 1."""

Factor = Annotated[
    Distribution, drawn_within(1e-6, 1e6, "times that at rest", "foam cannot be pressed further")
]

Relative = Annotated[
    Distribution, drawn_within(1e-3, 1e3, "times the scene's own", "no batch differs more")
]

Length = Annotated[Distribution, drawn_within(1e-8, 1e3, "m", "no touch is larger, or as small")]

Finger = Annotated[
    Distribution, drawn_within(0.0, 1e-9, "F", "a whole hand has tens of picofarad to a sheet")
]

Spread = Annotated[Number, Field(ge=0, le=MAX_UNEVENNESS)]

Shape = Literal["rectangle", "disc"]


def _chances(values: tuple[float, ...]) -> tuple[float, ...]:
    if min(values) < 0 or not math.isclose(sum(values), 1, abs_tol=1e-9):
        raise ValueError(f"must be >= 0 and sum to 1, got {list(values)}")
    return values


class DrawnPress(Table):
    """A press: how many touches, where, how large and how strong.

    touches: chances of 0, 1, 2 touches. place: whole pixels, or anywhere on the skin. offset: how
    far the hand presses beside a pixel, along each side, a standard deviation over that side; the
    press is told as that of the pixel. factor: capacitance over that at rest; where the
    scene presses by depth, that under the applicator, unless depth [m] is drawn. shape and size [m]
    (sides of a rectangle, diameter of a disc) count only anywhere. cells_per_pixel: along each
    side, where touches are no whole pixels; each cell rises by the part of it that is covered, or
    by the mean of what a tension spreads. finger: capacitance of a touch to earth, spread evenly
    over it; else that of the scene's `press.finger`. without_press: share of touches that do not
    press, but only have a finger.
    """

    touches: Annotated[
        tuple[Number, ...], Field(min_length=1, max_length=3), AfterValidator(_chances)
    ] = (0.1, 0.7, 0.2)
    place: Literal["pixel", "anywhere"] = "pixel"
    offset: Annotated[Number, Field(ge=0, le=0.5)] = 0.0
    shape: Annotated[tuple[Shape, ...], Field(min_length=1)] = ("rectangle", "disc")
    size: Length = Uniform(low=0.01, high=0.02)
    cells_per_pixel: Annotated[Whole, Field(ge=1, le=20)] = 4
    factor: Factor = Uniform(low=1.3, high=3.0)
    depth: Length | None = None
    finger: Finger | None = None
    without_press: Annotated[Number, Field(ge=0, le=1)] | None = None

    @property
    def cells(self) -> int:
        """Cells along each side of a pixel."""
        return self.cells_per_pixel if self.rasterized else 1

    @property
    def rasterized(self) -> bool:
        """Whether touches are no whole pixels, and are laid on cells."""
        return self.place == "anywhere" or self.offset > 0

    @property
    def max_touches(self) -> int:
        """The largest number of touches that has a chance."""
        return max(count for count, chance in enumerate(self.touches) if chance > 0)


class Session(Table):
    """What is drawn once for every session.

    rest_every: as in a lab, a session begins with three sweeps at rest, and another follows every
    so many presses; 0 promises none beyond those that `touches` draws.
    sheet_resistance: factor on both sheets together (ageing, humidity). sheet_mismatch: further
    factor on each sheet of its own. unevenness: standard deviation of each slow wave of a sheet's
    conductance over its mean; the waves are half a cosine along x, along y, and along both.
    capacitance: factor on all of the foam. foam_spread: relative standard deviation of the
    capacitance over the foam: of each pixel on its own or, where foam_pattern is smooth, of each
    slow wave. loss_tangent: added to the foam's own. contact_resistance: factor on each contact's
    resistance; ideal foils have none. stray_capacitance [F] and lead_resistance [ohm]: added to
    those of the leads, beyond any guard. temperature [°C], humidity [%RH]: at which a session is
    measured, where the foam has their tables; those of `experiment` unless given. body, rim:
    factors on the capacitance of the scene's `surroundings.body` and of its rim; without them these
    are as the scene has them.

    The defaults are assumptions. Geometry of 3 % and contacts of 4 % a session are what simulations
    of electrical impedance tomography that were to be carried to real devices took; the sheets'
    5 % stands for carbon-filled rubber from one batch, the leads for 10 cm of cable after the
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
        Distribution, drawn_within(0.0, 1e3, "(tan d)", "a foam stores something")
    ] = Uniform(low=0.0, high=0.02)
    contact_resistance: Relative = Lognormal(median=1.0, spread=0.04)
    stray_capacitance: Annotated[
        Distribution, drawn_within(0.0, 10.0, "F", "leads have picofarad")
    ] = Uniform(low=0.0, high=2e-12)
    lead_resistance: Annotated[
        Distribution, drawn_within(0.0, 1e12, "ohm", "no meter reads more")
    ] = Uniform(low=0.0, high=2.0)
    body: Relative | None = None
    rim: Relative | None = None
    temperature: (
        Annotated[Distribution, drawn_within(-200.0, 1000.0, "°C", "no foam lasts beyond")] | None
    ) = None
    humidity: (
        Annotated[Distribution, drawn_within(0.0, 100.0, "%RH", "air holds no more water")] | None
    ) = None

    def check_ambient(self, foam: Foam) -> None:
        """Raises ValueError where a state is drawn that the foam has no table of, or is far off."""
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
    """How the sweeps of a data set differ: from press to press, and from session to session."""

    press: DrawnPress = DrawnPress()
    session: Session = Session()
