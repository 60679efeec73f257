"""Odds of faults in the sessions of a data set."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from ..validation import Number, Table, Whole
from .draw_distributions import Distribution, Uniform, drawn_within

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
