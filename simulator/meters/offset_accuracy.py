"""Accuracy of a meter as a basic accuracy with a short and an open offset, by frequency."""

from __future__ import annotations

from typing import Annotated, Self

import numpy as np
from pydantic import Field, model_validator

from ..arrays import Real
from .accuracy_table import AccuracyModel, Error, Positive


class OffsetBand(AccuracyModel):
    """One band of frequencies.

    start [Hz]: its lowest frequency. basic: part of the bound that does not depend on |Z|, %.
    short_offset [ohm]: part that grows as |Z| falls. open_offset [S]: part that grows with |Z|.
    short_corner, open_corner [Hz]: the offset is multiplied by 1 + sqrt(corner / frequency).
    """

    start: Positive
    basic: Positive
    short_offset: Error
    open_offset: Error
    short_corner: Error = 0.0
    open_corner: Error = 0.0


class OffsetAccuracy(AccuracyModel):
    """Bounds basic + short_offset/|Z| + open_offset |Z| on |Z| (a fraction) and on phase (rad).

    name: of the meter. stop: end of the last band, Hz; beyond the bands, the nearest one holds.
    """

    name: str
    stop: Positive
    band: Annotated[tuple[OffsetBand, ...], Field(min_length=1)]

    @model_validator(mode="after")
    def _ascending(self) -> Self:
        edges = [*(each.start for each in self.band), self.stop]
        if edges != sorted(set(edges)):
            raise ValueError(f"`band`: starts must ascend and end below `stop`, got {edges} Hz")
        return self

    @property
    def smallest_bound(self) -> float:
        """Smallest bound of all bands."""
        return min(each.basic for each in self.band) / 100

    def bounds(self, size: Real, frequency: Real) -> Real:
        """Bounds on |Z| and phase, shape (2, ...); size: |Z| in ohm, frequency: Hz, last."""
        starts = [each.start for each in self.band]
        number = np.maximum(np.searchsorted(starts, frequency, side="right") - 1, 0)

        def of(name: str) -> Real:
            return np.array([getattr(each, name) for each in self.band])[number]

        short, opened = (
            of(f"{kind}_offset") * (1 + np.sqrt(of(f"{kind}_corner") / frequency))
            for kind in ("short", "open")
        )
        bound = of("basic") / 100 + short / size + opened * size
        return np.stack([bound, bound])
