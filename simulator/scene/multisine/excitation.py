"""Phases of a multisine with a low peak, and its voltage at the source and at the amplifier.

Sources: M. R. Schroeder, IEEE Trans. Inf. Theory 16 (1970) 85 (phases); E. van der Ouderaa,
J. Schoukens, J. Renneboog, IEEE Trans. Instrum. Meas. 37 (1988) 145 (clipping).
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ...arrays import Complex, Integer, Real
from .reader import Multisine

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
