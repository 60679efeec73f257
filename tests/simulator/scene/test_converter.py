"""Noise of readers of gains, in volts and in bits, against samples of a converter."""

import numpy as np
import pytest
from rcskin.simulator.measure.readout import MeterSession
from rcskin.simulator.scene.meter import Readout
from rcskin.simulator.scene.meter_tables import Converter
from rcskin.simulator.scene.scene_files import load_scene, parse_scene, scene_text
from rcskin.tests.refusals import refusal_of

GAIN = {"interface.1.reader": "gain", "interface.1.series_resistance": 1e6}
STRIP = load_scene("strip-1x5")
VOLTS = {"source_amplitude": 1.0, "noise": 2e-3, "samples": 64}
BITS = {"source_amplitude": 1.0, "bits": 8, "full_scale": 2.5, "samples": 64}


@pytest.mark.parametrize("given", [VOLTS, {**BITS, "noise": 5e-3}])
def test_the_noise_is_that_of_sampled_voltages(given):
    """Samples of a period, with noise and rounded to steps; phase and offset are random."""
    random, count = np.random.default_rng(1), 4000
    gain = 0.4 * np.exp(2j * np.pi * random.random((count, 1)))
    converter = Converter(**given)
    turn = 2 * np.pi * np.arange(converter.samples) / converter.samples
    V = converter.source_amplitude * np.abs(gain) * np.cos(turn + np.angle(gain))
    V = V + random.uniform(0, 0.5, (count, 1))
    V = V + converter.noise * random.standard_normal(V.shape)
    if converter.bits is not None:
        step = converter.full_scale / 2**converter.bits
        V = step * np.round(V / step)
    found = 2 / converter.samples * (V @ np.exp(-1j * turn)) / converter.source_amplitude
    ratio = np.log(found / gain[:, 0])
    expected = float(converter.deviation(gain[0])[0])
    assert np.std(ratio.real) == pytest.approx(expected, rel=0.1)
    assert np.std(ratio.imag) == pytest.approx(expected, rel=0.1)


def test_readings_have_the_noise_of_the_converter():
    readout = Readout(converter=Converter(**VOLTS))
    gain = np.full((4000, 1, 2), [0.9, 0.1j])
    measured = MeterSession(readout, 1, np.random.default_rng(1)).measure(
        gain, np.array([1e3, 2e3])
    )
    found = np.std(np.log(np.abs(measured)), axis=0)[0]
    np.testing.assert_allclose(found, readout.converter.deviation(gain[0, 0]), rtol=0.1)
    assert not readout.uniform and readout.noisy and not readout.exact
    assert readout.smallest_noise == pytest.approx(readout.converter.smallest_deviation)


def test_a_scene_keeps_its_converter():
    scene = STRIP.with_({**GAIN, "readout": {"converter": BITS}})
    assert parse_scene(scene_text(scene), "again") == scene
    assert "converter" not in scene_text(STRIP)
    assert "converter" not in STRIP.readout.model_dump_json()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"readout": {"converter": VOLTS}},
            '`readout.converter` is of interfaces with reader = "gain", got "impedance" of',
        ),
        (
            {**GAIN, "readout": {"converter": {"source_amplitude": 1.0}}},
            "`readout.converter` needs noise, in V rms, or bits with full_scale",
        ),
        (
            {**GAIN, "readout": {"converter": {"source_amplitude": 1.0, "bits": 8}}},
            "takes bits and full_scale together, got one of them",
        ),
        (
            {**GAIN, "readout": {"converter": {**BITS, "full_scale": 1.0}}},
            "`source_amplitude` must be <= 0.5 V, half of full_scale, got 1: the converter would",
        ),
    ],
)
def test_what_does_not_fit_is_refused(changes, message):
    assert message in refusal_of(STRIP.with_, changes)
