"""Multisine reader: tones on the grid of a frame, excitation with a low peak, and its noise."""

import numpy as np
import pytest
from pydantic import ValidationError
from rcskin.simulator.scene.multisine import (
    BOLTZMANN,
    TEMPERATURE,
    Multisine,
    amplitudes,
    crest_factor,
    enough_points,
    multisine_deviation,
    output_density,
    output_peak,
    schroeder_phases,
    waveform,
)
from rcskin.simulator.scene.validation import one_line
from rcskin.simulator.sweeps import InputError

FREQUENCY = np.array([1e3, 4e3, 20e3, 50e3, 100e3])
SILENT = {"voltage_noise": 0.0, "current_noise": 0.0, "adc_noise": 0.0, "bits": 32}
REFUSALS = {
    "samples": ({"frame": 1.0005e-4, "sampling_rate": 1e4}, "`frame` must be a whole number of"),
    "memory": ({"frame": 1.0}, "`frame` must have at most 100000 samples, got 1000000"),
}
OFF_GRID = {
    "low": ([50.0, 1e3], "frequencies must be >= 125 Hz for a frame of 0.008 s, got 50"),
    "close": ([1e3, 1010.0], "must differ by about 125 Hz for a frame of 0.008 s, got 1000 and"),
    "high": ([1e3, 450e3], "must be <= 400000 Hz, 0.4 times"),
}


def reader(**changes):
    return Multisine(**{"feedback_resistance": 50e3, **changes})


def line(frequency, R=100e3, C=70e-12):
    """Uniform open RC line, R coth(q) / q with q = sqrt(s R C)."""
    q = np.sqrt(2j * np.pi * frequency * R * C)
    return R / np.tanh(q) / q


@pytest.mark.parametrize("changes, message", REFUSALS.values(), ids=REFUSALS)
def test_refused_readers(changes, message):
    with pytest.raises(ValidationError) as refused:
        reader(**changes)
    assert message in one_line(refused.value, Multisine)


@pytest.mark.parametrize("frequency, message", OFF_GRID.values(), ids=OFF_GRID)
def test_tones_that_a_frame_cannot_separate(frequency, message):
    with pytest.raises(ValueError, match="frequencies") as refused:
        reader().on_grid(np.array(frequency))
    assert message in str(refused.value)


def test_tones_move_to_the_nearest_multiple_of_the_frame_and_stay_there():
    tones = reader().on_grid(np.geomspace(1e3, 200e3, 20))
    assert tones[:3].tolist() == [1000.0, 1375.0, 1750.0]
    np.testing.assert_array_equal(reader().on_grid(tones), tones)


def test_a_tone_off_the_grid_would_leak_into_the_others():
    points, frame = 8000, 8e-3
    time = np.arange(points) * frame / points
    on, off = (np.abs(np.fft.rfft(np.cos(2 * np.pi * f * time)))[16] for f in (1e3, 1050.0))
    assert on < 1e-9 < 0.02 * points < off


def test_hum_of_the_mains_leaks_into_a_frame_that_is_no_whole_number_of_its_periods():
    """By sinc of the distance to the tone and to its mirror image, in periods of the frame."""
    largest = {}
    for frame in (8e-3, 20e-3):
        time = np.arange(round(1e6 * frame)) / 1e6
        tone = round(1e3 * frame)
        hum = (np.cos(2 * np.pi * 50 * time + phase) for phase in np.linspace(0, np.pi, 16))
        largest[frame] = max(np.abs(np.fft.rfft(each)[tone]) / (len(time) / 2) for each in hum)
    expected = sum(abs(np.sinc(8e-3 * (1e3 + f))) for f in (-50, 50))
    assert largest[8e-3] == pytest.approx(expected, rel=0.02) == pytest.approx(0.076, rel=0.02)
    assert largest[20e-3] < 1e-9


def test_the_excitation_peaks_at_the_stated_voltage_with_the_amplitudes_in_proportion():
    own = reader(amplitudes=(1.0, 1.0, 2.0, 3.0, 5.0), peak_voltage=0.7)
    voltage = amplitudes(own, FREQUENCY)
    bins = np.rint(FREQUENCY * own.frame).astype(int)
    wave = waveform(voltage, bins, 8 * enough_points(bins))
    assert np.abs(wave).max() == pytest.approx(0.7, rel=0.08)
    np.testing.assert_allclose(np.abs(voltage) / np.abs(voltage[0]), own.amplitudes, rtol=1e-12)
    np.testing.assert_array_equal(voltage, amplitudes(own.model_copy(), FREQUENCY))


def test_crest_factors_lie_between_one_tone_and_tones_in_phase():
    assert crest_factor(reader(), FREQUENCY[:1]) == pytest.approx(np.sqrt(2), rel=0.08)
    for count in (10, 20):
        crest = crest_factor(reader(), reader().on_grid(np.geomspace(1e3, 200e3, count)))
        assert np.sqrt(2) < crest < 0.9 * np.sqrt(2 * count)


def test_phases_of_consecutive_tones_are_those_of_schroeder():
    n = np.arange(1, 32)
    expected = -np.pi * n * (n - 1) / len(n)
    phase = schroeder_phases(np.ones(len(n)), n)
    np.testing.assert_allclose(np.exp(1j * phase), np.exp(1j * expected), atol=1e-9)
    wave = waveform(np.exp(1j * phase), n, 1024)
    assert np.abs(wave).max() < 1.9 * np.sqrt(len(n) / 2)


def test_some_of_the_tones_keep_the_amplitudes_that_they_have_together():
    own = reader(amplitudes=(1.0, 2.0, 3.0, 4.0, 5.0)).with_tones(FREQUENCY)
    some = [0, 3]
    np.testing.assert_array_equal(
        amplitudes(own, FREQUENCY[some]), amplitudes(own, FREQUENCY)[some]
    )
    deviation = multisine_deviation(own, line(FREQUENCY), FREQUENCY)
    one = multisine_deviation(own, line(FREQUENCY[[3]]), FREQUENCY[[3]])
    assert one[0] == deviation[3]


def test_tones_of_no_scene_have_the_mean_power_of_its_tones():
    own = reader(amplitudes=(1.0, 2.0, 3.0, 4.0, 5.0)).with_tones(FREQUENCY)
    every = np.abs(amplitudes(own, FREQUENCY))
    mixed = np.abs(amplitudes(own, np.array([900.0, 4e3, 5e3, 200e3])))
    mean = np.sqrt(np.mean(every**2))
    np.testing.assert_allclose(mixed, [mean, every[1], mean, mean], rtol=1e-12)


def test_amplitudes_are_of_the_tones_of_the_scene():
    with pytest.raises(ValueError, match="one item for each of the 5 frequencies, got 2"):
        reader(amplitudes=(1.0, 2.0)).with_tones(FREQUENCY)


def test_without_other_noise_the_density_is_that_of_the_resistors():
    own = reader(**SILENT, input_capacitance=0.0)
    Z = np.full(5, 100e3 + 0j)
    expected = 4 * BOLTZMANN * TEMPERATURE * 50e3**2 * (1 / 50e3 + 1 / 100e3)
    np.testing.assert_allclose(output_density(own, Z, FREQUENCY), expected, rtol=1e-6)


def test_the_amplifier_noise_is_amplified_by_one_plus_feedback_over_input():
    quiet, loud = reader(voltage_noise=0.0), reader(voltage_noise=1e-6)
    Z = np.full(5, 10e3 + 0j)
    added = output_density(loud, Z, FREQUENCY) - output_density(quiet, Z, FREQUENCY)
    omega = 2 * np.pi * FREQUENCY
    gain = np.abs(1 + 50e3 * (1 / 10e3 + 1j * omega * loud.input_capacitance))
    np.testing.assert_allclose(added, (1e-6 * gain) ** 2, rtol=1e-6)


def test_noise_falls_with_frames_time_and_voltage():
    Z, one = line(FREQUENCY), reader()
    base = multisine_deviation(one, Z, FREQUENCY)
    for changes, ratio in (({"frames": 4}, 0.5), ({"frame": 32e-3}, 0.5)):
        other = multisine_deviation(reader(**changes), Z, FREQUENCY)
        np.testing.assert_allclose(other, ratio * base, rtol=0.15)
    np.testing.assert_allclose(
        multisine_deviation(reader(peak_voltage=0.5), Z, FREQUENCY), 2 * base, rtol=1e-12
    )


def test_an_output_beyond_the_range_of_the_converter_is_refused():
    Z = np.stack([line(FREQUENCY), line(FREQUENCY, C=140e-12)])[:, None]
    peak = output_peak(reader(), Z, FREQUENCY)
    assert peak.shape == (2, 1)
    wide, narrow = (
        reader(full_scale=part * peak.max()).with_tones(FREQUENCY) for part in (1.01, 0.8)
    )
    multisine_deviation(wide, Z, FREQUENCY)
    with pytest.raises(InputError, match=r"by a factor of 1\.25"):
        multisine_deviation(narrow, Z, FREQUENCY)


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"bits": 8},
        {"voltage_noise": 2e-7, "feedback_capacitance": 20e-12},
    ],
    ids=["stated", "rounding", "amplifier"],
)
def test_the_formula_agrees_with_samples_in_the_time_domain(changes):
    own = reader(**changes)
    samples, frames = own.samples, 300
    bins = np.rint(FREQUENCY * own.frame).astype(int)
    every = np.arange(samples // 2 + 1) / own.frame
    Z, tones = line(np.maximum(every, 1.0)), amplitudes(own, FREQUENCY)
    feedback, random = own.feedback(every), np.random.default_rng(3)

    def noise(density):
        """Spectrum of white noise of a one-sided density, unit²/Hz, in samples."""
        deviation = np.sqrt(density * own.sampling_rate / 2)
        return np.fft.rfft(random.normal(0.0, deviation, (frames, samples)))

    gain = 1 + feedback * (1 / Z + 2j * np.pi * every * own.input_capacitance)
    thermal = 4 * BOLTZMANN * TEMPERATURE
    spectrum = noise(own.voltage_noise**2) * gain
    spectrum += noise(own.current_noise**2 + thermal / own.feedback_resistance) * feedback
    spectrum += noise(1.0) * np.sqrt(thermal * (1 / Z).real) * feedback
    spectrum[:, bins] += -tones * (feedback / Z)[bins] * samples / 2
    voltage = np.fft.irfft(spectrum, samples)
    voltage += own.step * own.adc_noise * random.standard_normal(voltage.shape)
    seen = np.fft.rfft(own.step * np.round(voltage / own.step))[:, bins] / (samples / 2)
    measured = -tones * feedback[bins] / seen
    expected = multisine_deviation(own, Z[bins], FREQUENCY)
    error = np.log(measured / Z[bins])
    for part in (error.real, error.imag):
        np.testing.assert_allclose(part.std(axis=0), expected, rtol=0.2)
        assert (np.abs(part.mean(axis=0)) < 5 * expected / np.sqrt(frames) + 1e-12).all()
