"""What a designer of a skin must keep, what may change, and what is wanted."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from .ranges import Frequency, Length, Seconds, SheetResistance, Thickness
from .validation import Number, Table, Whole

Target = Literal["pixel", "column", "row", "pair", "position"]
POSITION = "position"
Part = Annotated[Number, Field(ge=1e-3, le=1)]
"""A foil shorter than a thousandth of its edge is none."""


class Design(Table):
    """What `rcskin design` keeps to, and what it looks for; everything else stays as it is.

    target, want: what is to be told, and for what share of sweeps; within: of positions, to how
    many m half of the time. wires, readings, frequencies: at
    most so many foils are wired, so many pairs of sets of them read, at so many frequencies each;
    as many as the scene has unless given. seconds: that a sweep may take on the meter, at most.
    band: of the frequencies [Hz], else the scene's own. sheet_resistance: bounds of both sheets
    [ohm/sq]; sheet_ratio: one over the other at most. foam_thickness: bounds [m] of a foam whose
    thickness is given. grading: sheet resistance at one edge over that at the opposite one, at
    most. own_frequencies: whether each reading may have frequencies of its own, as many in all.
    foils: whether places and lengths of foils may change; foil_length: bounds of their
    lengths over that of their edge. against_rest: sweeps at rest that each sweep is compared with.
    casts: skins drawn as [dataset.session] says; the tenth that is worst off counts.
    """

    target: Target = "pixel"
    want: Annotated[Number, Field(gt=0, lt=1)] | None = None
    within: Length | None = None
    wires: Annotated[Whole, Field(ge=2, le=8)] | None = None
    readings: Annotated[Whole, Field(ge=1, le=40)] = 5
    frequencies: Annotated[Whole, Field(ge=1, le=100)] | None = None
    own_frequencies: bool = False
    seconds: Seconds | None = None
    band: tuple[Frequency, Frequency] | None = None
    sheet_resistance: tuple[SheetResistance, SheetResistance] = (10e3, 400e3)
    sheet_ratio: Annotated[Number, Field(ge=1, le=10)] = 2.0
    foam_thickness: tuple[Thickness, Thickness] | None = None
    grading: Annotated[Number, Field(ge=1, le=10)] = 1.0
    foils: bool = False
    foil_length: tuple[Part, Part] = (0.2, 0.99)
    against_rest: Annotated[Whole, Field(ge=0, le=10**6)] = 6
    casts: Annotated[Whole, Field(ge=1, le=100)] = 10

    @model_validator(mode="after")
    def _wish_suits(self) -> Self:
        if self.want is not None and self.target == POSITION:
            raise ValueError("want is a share of sweeps; positions have `within`, in m")
        if self.within is not None and self.target != POSITION:
            raise ValueError(f"within is of the target {POSITION}; a {self.target} has `want`")
        return self

    @model_validator(mode="after")
    def _own_frequencies_add_up(self) -> Self:
        if self.own_frequencies and not self.against_rest:
            raise ValueError("own_frequencies needs against_rest >= 1, got 0")
        return self

    @model_validator(mode="after")
    def _bounds_ascend(self) -> Self:
        for name in ("band", "sheet_resistance", "foam_thickness", "foil_length"):
            bounds = getattr(self, name)
            if bounds is not None and not bounds[0] <= bounds[1]:
                raise ValueError(
                    f"{name} must be a low and a high end, got {bounds[0]:g} and {bounds[1]:g}"
                )
        return self
