"""What differs between the sweeps of a data set: presses, and what changes from skin to skin.

A session is one skin in one mounting on one day: its parameters are drawn once and hold for
`sweeps_per_session` sweeps. Every distribution is relative to the scene's own value unless its
docstring gives a unit. The defaults are assumptions, not measurements: see `Session`.
"""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import AfterValidator, Field

from simulator.distribution import Distribution, Lognormal, Normal, Uniform, bounded
from simulator.table import Table
from simulator.validation import Number, Whole

CUT = 3.0
"""Standard deviations beyond which no coefficient of a slow variation or spread is drawn."""
SLOW_WAVES = 3
MOST_UNEVEN = 0.1
"""Conductance and capacitance stay positive: CUT * SLOW_WAVES * MOST_UNEVEN < 1."""

Factor = Annotated[Distribution, bounded(0, "times that at rest", strictly=True)]
Relative = Annotated[Distribution, bounded(0, "times the scene's own", strictly=True)]
Length = Annotated[Distribution, bounded(0, "m", strictly=True)]
Spread = Annotated[Number, Field(ge=0, le=MOST_UNEVEN)]
Shape = Literal["rectangle", "disc"]


def _chances(values: tuple[float, ...]) -> tuple[float, ...]:
    if min(values) < 0 or not math.isclose(sum(values), 1, abs_tol=1e-9):
        raise ValueError(f"must be >= 0 and sum to 1, got {list(values)}")
    return values


class DrawnPress(Table):
    """A press: how many touches, where, how large and how strong.

    touches: chances of 0, 1, 2 touches. place: whole pixels, or anywhere on the skin. offset: how
    far the hand presses beside a pixel, along each side, a standard deviation over that side; the
    press is told as that of the pixel. factor: capacitance over that at rest. shape and size [m]
    (sides of a rectangle, diameter of a disc) count only anywhere. cells_per_pixel: along each
    side, where touches are no whole pixels; each cell rises by the part of it that is covered.
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

    @property
    def cells(self) -> int:
        """Cells along each side of a pixel."""
        return self.cells_per_pixel if self.place == "anywhere" or self.offset > 0 else 1

    @property
    def most_touches(self) -> int:
        """The largest number of touches that has a chance."""
        return max(count for count, chance in enumerate(self.touches) if chance > 0)


class Session(Table):
    """What is drawn once for every session.

    sheet_resistance: factor on both sheets together (ageing, humidity). sheet_mismatch: further
    factor on each sheet of its own. unevenness: standard deviation of each slow wave of a sheet's
    conductance over its mean; the waves are half a cosine along x, along y, and along both.
    capacitance: factor on all of the foam. foam_spread: relative standard deviation of the
    capacitance over the foam: of each pixel on its own or, where foam_pattern is smooth, of each
    slow wave. loss_tangent: added to the foam's own. contact_resistance: factor on each contact's
    resistance; ideal foils have none. stray_capacitance [F] and lead_resistance [ohm]: added to
    those of the leads, beyond any guard.

    The defaults are assumptions. Geometry of 3 % and contacts of 4 % a session are what simulations
    of electrical impedance tomography that were to be carried to real devices took; the sheets'
    5 % stands for carbon-filled rubber from one batch, the leads for 10 cm of cable after the
    meter's own open and short correction.
    """

    sweeps_per_session: Annotated[Whole, Field(ge=1, le=100_000)] = 500
    sheet_resistance: Relative = Lognormal(median=1.0, spread=0.05)
    sheet_mismatch: Relative = Lognormal(median=1.0, spread=0.03)
    unevenness: Spread = 0.02
    capacitance: Relative = Normal(mean=1.0, deviation=0.03)
    foam_spread: Spread = 0.02
    foam_pattern: Literal["pixel", "smooth"] = "pixel"
    loss_tangent: Annotated[Distribution, bounded(0, "(tan d)")] = Uniform(low=0.0, high=0.02)
    contact_resistance: Relative = Lognormal(median=1.0, spread=0.04)
    stray_capacitance: Annotated[Distribution, bounded(0, "F")] = Uniform(low=0.0, high=2e-12)
    lead_resistance: Annotated[Distribution, bounded(0, "ohm")] = Uniform(low=0.0, high=2.0)

    @property
    def sheet_range(self) -> tuple[float, float]:
        """Least and largest mean resistance of a sheet over the scene's own."""
        common, own = self.sheet_resistance, self.sheet_mismatch
        return common.low * own.low, common.high * own.high

    @property
    def unevenness_range(self) -> tuple[float, float]:
        """Least and largest coefficient of a slow wave of a sheet's conductance over its mean."""
        return -CUT * self.unevenness, CUT * self.unevenness

    @property
    def foam_range(self) -> tuple[float, float]:
        """Least and largest capacitance of a cell over the scene's own."""
        away = CUT * self.foam_spread * (SLOW_WAVES if self.foam_pattern == "smooth" else 1)
        return self.capacitance.low * (1 - away), self.capacitance.high * (1 + away)


class Randomisation(Table):
    """How the sweeps of a data set differ: from press to press, and from session to session."""

    press: DrawnPress = DrawnPress()
    session: Session = Session()
