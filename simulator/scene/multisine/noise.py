"""Noise of a multisine reader, from its amplifier and its converter.

The amplifier's output has the one-sided spectral density, in V²/Hz,

    S = e_n² |1 + Z_f / Z_in|² + (i_n² + 4 k T / R_f + 4 k T Re(1/Z)) |Z_f|² + S_adc,

with Z_in of the skin in parallel with the input capacitance, and S_adc = step² (1/12 + n²) over
half the sampling rate. Sources: J. Graeme, Photodiode Amplifiers (1996) ch. 5 (noise gain); H.
Nyquist, Phys. Rev. 32 (1928) 110; W. R. Bennett, Bell Syst. Tech. J. 27 (1948) 446 (rounding).
The Fourier transform of a frame of duration T has the standard deviation sqrt(S / T) in the real
and in the imaginary part of each tone's amplitude |V Z_f / Z|.

The source is taken as exact, and a filter as removing what the ADC would alias.
"""

from __future__ import annotations

import math

import numpy as np

from ...arrays import Complex, Real
from ...sweeps import InputError
from .excitation import output, output_peak
from .reader import Multisine

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
