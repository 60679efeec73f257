"""Source and analogue-to-digital converter of a reader of gains."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Self

import numpy as np
from pydantic import Field, model_validator

from ...arrays import Complex, Real
from ..validation import Number, Table, Whole, within

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..readings.contacts import Interface
    from .meter import Readout

NO_SUCH = "no source or converter has such a value"
Volts = Annotated[Number, within(1e-6, 1e4, "V", NO_SUCH)]


class Converter(Table):
    """Source and analogue-to-digital converter of a reader of gains.

    source_amplitude [V]: of V_s. noise [V rms]: of each sample of the node's voltage. bits,
    full_scale [V]: of the converter, from its lowest to its highest voltage; rounding is counted as
    noise of a step over root 12 in each sample, which holds from noise of half a step on. samples:
    number of samples of one reading; each component of V then has the noise of a sample times root
    2/samples. The deviations of ln |V / V_s| and of the phase are that noise over the amplitude of
    V.
    """

    source_amplitude: Volts
    noise: Annotated[Number, within(0.0, 1e3, "V", NO_SUCH)] = 0.0
    bits: Annotated[Whole, Field(ge=1, le=32)] | None = None
    full_scale: Volts | None = None
    samples: Annotated[Whole, Field(ge=2, le=10**9)] = 2

    @model_validator(mode="after")
    def _noise_by_volts_or_bits(self) -> Self:
        if (self.bits is None) != (self.full_scale is None):
            raise ValueError("takes bits and full_scale together, got one of them")
        if self.full_scale is not None and self.source_amplitude > self.full_scale / 2:
            raise ValueError(
                f"`source_amplitude` must be <= {self.full_scale / 2:g} V, half of full_scale, got "
                f"{self.source_amplitude:g}: the converter would clip the voltage of the source"
            )
        if not (self.noise or self.bits):
            raise ValueError("needs noise, in V rms, or bits with full_scale")
        return self

    @property
    def component_noise(self) -> float:
        """Noise of each component of a reading's amplitude, V."""
        step = 0.0 if self.full_scale is None else self.full_scale / 2 ** (self.bits or 0)
        return math.hypot(self.noise, step / math.sqrt(12)) * math.sqrt(2 / self.samples)

    @property
    def smallest_deviation(self) -> float:
        """Deviation of the largest gain of a passive skin, 1."""
        return self.component_noise / self.source_amplitude

    def deviation(self, gain: Complex) -> Real:
        """Deviation of ln |V / V_s|, and of the phase in rad; shape of the gain."""
        return self.smallest_deviation / np.abs(gain)


def check_readout(interfaces: Sequence[Interface], readout: Readout) -> None:
    """Raises ValueError for errors of a readout that its reader cannot have."""
    reader = interfaces[0].reader
    if readout.converter is not None and reader != "gain":
        raise ValueError(
            '`readout.converter` is of interfaces with reader = "gain", got '
            f'"{reader}" of {interfaces[0].name!r}'
        )
    for name in ("data_sheet", "spread"):
        if reader == "gain" and getattr(readout, name) is not None:
            raise ValueError(
                f"`readout.{name}` is of impedances, and the readings are gains; give "
                "`readout.converter` in its place"
            )
