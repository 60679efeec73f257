"""A reader that excites a skin at all frequencies at once: its tones, peak and noise.

Phases of low peak: M. R. Schroeder, IEEE Trans. Inf. Theory 16 (1970) 85; clipping: E. van der
Ouderaa, J. Schoukens, J. Renneboog, IEEE Trans. Instrum. Meas. 37 (1988) 145.

The amplifier's output has the one-sided spectral density, in V²/Hz,

    S = e_n² |1 + Z_f / Z_in|² + (i_n² + 4 k T / R_f + 4 k T Re(1/Z)) |Z_f|² + S_adc,

with Z_in of the skin in parallel with the input capacitance, and S_adc = step² (1/12 + n²) over
half the sampling rate. Sources: J. Graeme, Photodiode Amplifiers (1996) ch. 5 (noise gain); H.
Nyquist, Phys. Rev. 32 (1928) 110; W. R. Bennett, Bell Syst. Tech. J. 27 (1948) 446 (rounding).
The Fourier transform of a frame of duration T has the standard deviation sqrt(S / T) in the real
and in the imaginary part of each tone's amplitude |V Z_f / Z|. The source is taken as exact, and a
filter as removing what the ADC would alias.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, Annotated, Self

import numpy as np
from pydantic import Field, PrivateAttr, model_validator

from ..arrays import Complex, Integer, Real
from ..sweeps import InputError
from .ranges import Capacitance
from .validation import Number, Table, Whole, within

if TYPE_CHECKING:
    from .contacts import Interface

OVERSAMPLED = 8
"""Points on a period of the highest tone; between them a peak is at most 8 % higher."""
CLIPPED = 0.75
"""Level at which a waveform is clipped, over its peak."""
CLIPPINGS = 200


def waveform(amplitude: Complex, bins: Integer, points: int) -> Real:
    """sum_k Re(A_k exp(2 pi j b_k t)) at that many instants of a period, shape (..., points).

    amplitude: complex A_k, shape (..., tone). bins: periods of each tone in a frame.
    """
    spectrum = np.zeros((*amplitude.shape[:-1], points // 2 + 1), dtype=np.complex128)
    for number, own in enumerate(bins):  # bins may repeat
        spectrum[..., own] += amplitude[..., number] / 2
    return np.fft.irfft(spectrum, points) * points


def enough_points(bins: Integer) -> int:
    """Number of points of a period that show the peak of a waveform."""
    return 2 ** int(np.ceil(np.log2(OVERSAMPLED * bins.max())))


def schroeder_phases(amplitude: Real, bins: Integer) -> Real:
    """Phases by which each tone takes a part of the period in proportion to its power.

    phi_k = -2 pi sum_{l<k} (b_{l+1} - b_l) P_l with the share P_l of the power up to tone l; for
    consecutive tones they are Schroeder's Eq 11.
    """
    power = np.cumsum(amplitude**2) / np.sum(amplitude**2)
    return -2 * np.pi * np.concatenate([[0.0], np.cumsum(np.diff(bins) * power[:-1])])


@lru_cache(maxsize=64)
def _phasors(shares: tuple[float, ...], bins: tuple[int, ...]) -> Complex:
    """Complex amplitudes of tones whose waveform peaks at 1: clipping lowers Schroeder's peak."""
    number, size = np.array(bins), np.array(shares)
    points = enough_points(number)
    phase, lowest = schroeder_phases(size, number), np.inf
    best = np.zeros(len(size), dtype=np.complex128)
    for _ in range(CLIPPINGS):
        amplitude = size * np.exp(1j * phase)
        wave = waveform(amplitude, number, points)
        peak = float(np.abs(wave).max())
        if peak < lowest:
            best, lowest = (amplitude / peak).astype(np.complex128), peak
        clipped = np.clip(wave, -CLIPPED * peak, CLIPPED * peak)
        phase = np.angle(np.fft.rfft(clipped)[number])
    return best


def bins_of(reader: Multisine, frequency: Real) -> Integer:
    """Periods of each tone in a frame, at least 1. frequency: Hz."""
    return np.maximum(np.rint(frequency * reader.frame), 1).astype(np.int64)


def amplitudes(reader: Multisine, frequency: Real) -> Complex:
    """Complex amplitudes of tones in V; all tones of the scene peak at `peak_voltage` together.

    frequency: Hz, ascending. Any that is no tone of the scene has the mean power of its tones, as
    if it stood in place of one of them.
    """
    tones = reader.tones if reader.tones.size else frequency
    shares = np.ones(len(tones)) if reader.amplitudes is None else np.array(reader.amplitudes)
    bins = bins_of(reader, tones)
    unit = _phasors(tuple(shares.tolist()), tuple(bins.tolist()))
    every = (reader.peak_voltage * unit).astype(np.complex128)
    number = np.minimum(np.searchsorted(tones, frequency), len(tones) - 1)
    mean = np.sqrt(np.mean(np.abs(every) ** 2))
    return np.where(tones[number] == frequency, every[number], mean)


def output(reader: Multisine, Z: Complex, frequency: Real) -> Complex:
    """Complex amplitudes at the amplifier's output, -V Z_f / Z, V, of the shape of Z."""
    return -amplitudes(reader, frequency) * reader.feedback(frequency) / Z


def output_peak(reader: Multisine, Z: Complex, frequency: Real) -> Real:
    """Peak of the amplifier's output, V, shape of Z without its last axis, frequency."""
    bins = bins_of(reader, frequency)
    wave = waveform(output(reader, Z, frequency), bins, enough_points(bins))
    return np.abs(wave).max(axis=-1)


def crest_factor(reader: Multisine, frequency: Real) -> float:
    """Peak of the excitation of these tones over its root mean square; sqrt(2) for one tone."""
    amplitude = np.abs(amplitudes(reader, frequency))
    return float(reader.peak_voltage / np.sqrt((amplitude**2).sum() / 2))


BOLTZMANN = 1.380649e-23
"""J/K."""
TEMPERATURE = 300.0
"""Temperature of resistor and skin, K."""


def output_density(reader: Multisine, Z: Complex, frequency: Real) -> Real:
    """One-sided spectral density S of the noise at the ADC, V²/Hz, of the shape of Z.

    Z: ohm, frequency [Hz] last.
    """
    feedback, thermal = reader.feedback(frequency), 4 * BOLTZMANN * TEMPERATURE
    into_input = 1 / Z + 2j * np.pi * frequency * reader.input_capacitance
    current = (
        reader.current_noise**2
        + thermal / reader.feedback_resistance
        + thermal * np.maximum((1 / Z).real, 0.0)
    )
    amplifier = reader.voltage_noise**2 * np.abs(1 + feedback * into_input) ** 2
    return amplifier + current * np.abs(feedback) ** 2 + _converter_density(reader)


def _converter_density(reader: Multisine) -> float:
    return reader.step**2 * (1 / 12 + reader.adc_noise**2) / (reader.sampling_rate / 2)


def smallest_deviation(reader: Multisine) -> float:
    """Smallest deviation that a reading can have: a tone that fills the range of the ADC."""
    return math.sqrt(_converter_density(reader) / reader.seconds) / reader.full_scale


def multisine_deviation(reader: Multisine, Z: Complex, frequency: Real) -> Real:
    """Standard deviation of ln |Z| and of the phase [rad] in a sweep, of the shape of Z.

    sigma = |Z / (V Z_f)| sqrt(S / (n T)) with n frames of duration T. Z: ohm, shape (...,
    frequency). Raises InputError where the output at all tones of the scene exceeds the ADC's
    range.
    """
    size = np.abs(output(reader, Z, frequency))
    if np.array_equal(frequency, reader.tones):
        check_range(reader, Z, frequency, size)
    return np.sqrt(output_density(reader, Z, frequency) / reader.seconds) / size


def check_range(reader: Multisine, Z: Complex, frequency: Real, size: Real) -> None:
    """Raises InputError if the sweep with the highest output power exceeds the ADC's range.

    size: of the output at each tone, V, shape of Z. No peak is above the sum of its tones.
    """
    every, sizes = Z.reshape(-1, len(frequency)), size.reshape(-1, len(frequency))
    if not every.size or sizes.sum(axis=-1).max() <= reader.full_scale:
        return
    power = (sizes**2).sum(axis=-1)
    peak = float(output_peak(reader, every[[int(np.argmax(power))]], frequency)[0])
    if peak > reader.full_scale:
        raise InputError(
            f"`readout.multisine.full_scale` must be >= {peak:.3g} V, the peak of the amplifier's "
            f"output, got {reader.full_scale:g}; lower `readout.multisine.feedback_resistance` or "
            f"`readout.multisine.peak_voltage` by a factor of {peak / reader.full_scale:.3g}"
        )


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


NAME = "multisine"


def scene_reader(
    interfaces: Sequence[Interface], reader: Multisine | None, frequencies: Sequence[float]
) -> Multisine | None:
    """The multisine reader of a scene with its tones, or None for another reader.

    frequencies: of the scene, Hz, ascending; the tones are the nearest multiples of 1/frame. Raises
    ValueError where interfaces, their frequencies and the reader do not fit together.
    """
    used = interfaces[0].reader == NAME
    if reader is None and used:
        raise ValueError(
            f'reader = "{NAME}" needs the table readout.multisine with feedback_resistance, in '
            "ohm, of its amplifier"
        )
    if reader is None or not used:
        if reader is not None:
            raise ValueError(
                f'`readout.multisine` is of interfaces with reader = "{NAME}", got '
                f'"{interfaces[0].reader}" of {interfaces[0].name!r}'
            )
        return None
    for each in interfaces:
        if each.frequencies is not None:
            raise ValueError(
                f"interface {each.name!r}: `frequencies` must be left out with reader = "
                f'"{NAME}", which reads all tones of the sweep at once'
            )
    return reader.with_tones(reader.on_grid(np.array(frequencies)))
