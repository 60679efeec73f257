"""Goals and limits of `rcskin design`: the table [design] of a scene."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from .ranges import Frequency, Length, Seconds, SheetResistance, Thickness
from .validation import Number, Table, Whole

Target = Literal["pixel", "column", "row", "pair", "position"]
POSITION = "position"
Part = Annotated[Number, Field(ge=1e-3, le=1)]
"""Length of a foil over that of its edge, at least a thousandth."""


class Design(Table):
    """Goals and limits of `rcskin design`; everything else of the scene stays unchanged.

    target: what a sweep shall identify. want: fraction of sweeps that shall identify it. within:
    for positions, the largest median error [m]. wires: largest number of wired foils; by default
    that of the scene. readings: largest number of readings between sets of them. frequencies:
    largest number of frequencies of each reading; by default that of the scene. seconds: longest
    duration of a sweep on the meter. band: range of frequencies [Hz]; by default that of the scene.
    sheet_resistance: bounds for both sheets [ohm/sq]. sheet_ratio: largest ratio of their
    resistances. foam_thickness: bounds [m] for the foam; without them, or if the scene gives no
    thickness, the foam stays as it is. grading: largest ratio of a sheet's resistances at opposite
    edges. own_frequencies: true lets each reading have its own frequencies, with the same total
    number. foils: true lets positions and lengths of foils change. foil_length: bounds of a foil's
    length over that of its edge. against_rest: number of baseline sweeps that each sweep is
    compared with. casts: number of skins drawn by [dataset.session]; the value of a design is what
    nine of ten of them reach.
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
    def _goal_fits_target(self) -> Self:
        if self.want is not None and self.target == POSITION:
            raise ValueError("want is a fraction of sweeps; use `within`, in m, for positions")
        if self.within is not None and self.target != POSITION:
            raise ValueError(
                f"within belongs to the target {POSITION}; use `want` for a {self.target}"
            )
        return self

    @model_validator(mode="after")
    def _own_frequencies_need_baseline(self) -> Self:
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
