"""Reader that excites a skin at all frequencies at once, and its amplifier and converter."""

from __future__ import annotations

from typing import Annotated, Self

import numpy as np
from pydantic import Field, PrivateAttr, model_validator

from ...arrays import Complex, Real
from ..ranges import Capacitance
from ..validation import Number, Table, Whole, within

ELECTRONIC = "no amplifier or converter has such a value"
OF_NYQUIST = 0.4
"""Highest tone over the sampling rate; the rest is room for the filter against aliases."""
MAX_SAMPLES = 100_000
"""Largest number of samples of a frame: the search for phases of a longer one takes minutes."""
ON_GRID = 1e-6
"""Largest distance of a tone from the grid of a frame, in its steps, by rounding."""


class Multisine(Table):
    """A reader of all frequencies at once: multisine source, transimpedance amplifier and ADC.

    The source drives the high terminal by a sum of sines that repeats every `frame` [s] and peaks
    at `peak_voltage` [V]. The low terminal is the virtual earth of an amplifier with
    `feedback_resistance` [ohm] and `feedback_capacitance` [F]. An ADC of `bits` and of `full_scale`
    [V], on both sides of 0 V, takes samples at `sampling_rate` [Hz]. A sweep is the Fourier
    transform of a frame, or of the mean of `frames`.

    feedback_resistance, feedback_capacitance: of the amplifier, in parallel. peak_voltage: of the
    sum of all tones. full_scale: highest voltage of the ADC on either side of 0 V. frame: duration
    after which the tones repeat, also the spacing of their frequencies as 1/frame. frames: number
    that a reading averages. sampling_rate: of the ADC. bits: of the ADC. amplitudes: of the tones,
    ascending in frequency, relative to each other; equal by default. adc_noise: standard deviation
    of the ADC's own noise, in its steps; from 0.5 on it also makes the errors of rounding
    independent from frame to frame. voltage_noise [V/Hz^0.5], current_noise [A/Hz^0.5]: of the
    amplifier. input_capacitance [F]: of amplifier and cable to earth.
    """

    feedback_resistance: Annotated[Number, within(1.0, 1e12, "ohm", ELECTRONIC)]
    feedback_capacitance: Capacitance = 0.0
    peak_voltage: Annotated[Number, within(1e-6, 1e3, "V", ELECTRONIC)] = 1.0
    full_scale: Annotated[Number, within(1e-6, 1e3, "V", ELECTRONIC)] = 1.0
    amplitudes: Annotated[
        tuple[Annotated[Number, within(1e-6, 1e6, "", "tones are compared")], ...] | None,
        Field(min_length=1, max_length=100_000),
    ] = None
    frame: Annotated[Number, within(1e-5, 10.0, "s", "a longer frame is an average")] = 8e-3
    frames: Annotated[Whole, Field(ge=1, le=100_000)] = 1
    sampling_rate: Annotated[Number, within(1e2, 1e10, "Hz", ELECTRONIC)] = 1e6
    bits: Annotated[Whole, Field(ge=4, le=32)] = 14
    adc_noise: Annotated[Number, within(0.0, 1e3, "steps", ELECTRONIC)] = 0.5
    voltage_noise: Annotated[Number, within(0.0, 1e-3, "V/Hz^0.5", ELECTRONIC)] = 6.3e-9
    current_noise: Annotated[Number, within(0.0, 1e-3, "A/Hz^0.5", ELECTRONIC)] = 5e-15
    input_capacitance: Capacitance = 20e-12
    _tones: tuple[float, ...] = PrivateAttr(())

    @model_validator(mode="after")
    def _whole_samples(self) -> Self:
        samples = self.frame * self.sampling_rate
        if abs(samples - round(samples)) > ON_GRID * max(samples, 1) or round(samples) < 2:
            raise ValueError(
                f"`frame` must be a whole number of samples, at least 2, got {samples:g} at "
                f"`sampling_rate` {self.sampling_rate:g} Hz"
            )
        if samples > MAX_SAMPLES:
            raise ValueError(
                f"`frame` must have at most {MAX_SAMPLES} samples, got {samples:.0f} at "
                f"`sampling_rate` {self.sampling_rate:g} Hz"
            )
        return self

    @property
    def seconds(self) -> float:
        """Duration of a sweep, s."""
        return self.frame * self.frames

    @property
    def samples(self) -> int:
        """Number of samples in a frame."""
        return round(self.frame * self.sampling_rate)

    @property
    def step(self) -> float:
        """Step of the ADC, V."""
        return 2 * self.full_scale / 2**self.bits

    @property
    def grid(self) -> float:
        """Distance of neighbouring tones that a frame separates, Hz: 1 / frame."""
        return 1 / self.frame

    def feedback(self, frequency: Real) -> Complex:
        """Impedance of the feedback, R / (1 + j omega R C), ohm."""
        R, C = self.feedback_resistance, self.feedback_capacitance
        return (R / (1 + 2j * np.pi * frequency * R * C)).astype(np.complex128)

    def on_grid(self, frequency: Real) -> Real:
        """The nearest multiples of 1/frame to tones in Hz, ascending.

        Any other tone would leak into its neighbours. Raises ValueError for a tone below
        1/(2 frame), for two with the same multiple, and for one too high for the sampling rate.
        """
        numbers = np.rint(frequency * self.frame)
        if numbers[0] < 1:
            raise ValueError(
                f"frequencies must be >= {self.grid:g} Hz for a frame of {self.frame:g} s, got "
                f"{frequency[0]:g}: lengthen `readout.multisine.frame`"
            )
        same = np.flatnonzero(np.diff(numbers) == 0)
        if same.size:
            low, high = frequency[same[0]], frequency[same[0] + 1]
            raise ValueError(
                f"frequencies must differ by about {self.grid:g} Hz for a frame of {self.frame:g} "
                f"s, got {low:g} and {high:g}: lengthen `readout.multisine.frame`"
            )
        highest = OF_NYQUIST * self.sampling_rate
        if frequency[-1] > highest:
            raise ValueError(
                f"frequencies must be <= {highest:g} Hz, {OF_NYQUIST} times "
                f"`readout.multisine.sampling_rate`, got {frequency[-1]:g}"
            )
        return np.where(
            np.abs(frequency * self.frame - numbers) > ON_GRID, numbers / self.frame, frequency
        )

    def with_tones(self, frequency: Real) -> Self:
        """The reader of a scene with these tones, Hz, ascending.

        Raises ValueError where `amplitudes` is a list of another length.
        """
        if self.amplitudes is not None and len(self.amplitudes) != len(frequency):
            raise ValueError(
                f"`readout.multisine.amplitudes` must have one item for each of the "
                f"{len(frequency)} frequencies, got {len(self.amplitudes)}"
            )
        own = self.model_copy()
        own._tones = tuple(frequency.tolist())
        return own

    @property
    def tones(self) -> Real:
        """All tones of the scene, Hz, ascending; empty for a reader without a scene."""
        return np.array(self._tones)
