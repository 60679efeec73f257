"""Errors that depend on the reading, and the same numbers as ever where they do not."""

from dataclasses import dataclass

import numpy as np
import pytest
from rcskin.simulator.bounds.likelihood import LinearLikelihood, over_noise
from rcskin.simulator.measure.readout import ErrorModel, MeterSession, observed, reading_from
from rcskin.simulator.scene.meter import Readout

FLAT = Readout(
    magnitude_accuracy=0.002, phase_accuracy=1e-3, magnitude_noise=0.003, phase_noise=2.6e-3
)
FREQUENCY = np.array([1e3, 1e4, 1e5])
Z = np.exp(np.random.default_rng(1).standard_normal((2, 3))) * (3e4 - 4e4j)
READ = np.ones(Z.shape, dtype=bool)


@dataclass(frozen=True)
class Growing:
    """Errors that grow with |Z| and fall with frequency."""

    uniform: bool = False
    noisy: bool = True
    smallest_noise: float = 1e-4

    def noise(self, reading, frequency):
        own = 1e-7 * np.abs(reading) * (frequency / 1e3) ** -0.2
        return np.stack([own, 2 * own])

    def accuracy(self, reading, frequency):
        magnitude, phase = self.noise(reading, frequency)
        return np.stack([1.5 * magnitude**1.1, 0.5 * phase])


def model(readout, **given):
    return ErrorModel(readout, READ, reading=Z, frequency=FREQUENCY, **given)


def test_a_meter_with_one_figure_gives_the_bits_of_the_formula():
    many = np.broadcast_to(Z, (50, 2, 3))
    meter, random = MeterSession(FLAT, 2, np.random.default_rng(5)), np.random.default_rng(5)
    gain, turn = random.standard_normal((2, 2, 1))
    magnitude, phase = random.standard_normal((2, 50, 2, 3))
    gain = (1 + FLAT.magnitude_accuracy * gain) * (1 + FLAT.magnitude_noise * magnitude)
    turn = FLAT.phase_accuracy * turn + FLAT.phase_noise * phase
    expected = many * gain * np.exp(1j * turn)
    np.testing.assert_array_equal(meter.measure(many, FREQUENCY), expected)


def test_statistics_of_one_figure_have_the_bits_of_the_formula():
    own = ErrorModel(FLAT, READ, averaged=4)
    noise = np.array([FLAT.magnitude_noise, FLAT.phase_noise]) * np.sqrt(1 / 4 + 0.0)
    np.testing.assert_array_equal(own.deviation, np.repeat(noise, 6))
    same = np.kron(np.eye(2), np.ones((3, 3)))
    accuracy = np.diag(np.square([FLAT.magnitude_accuracy, FLAT.phase_accuracy]))
    expected = np.diag(np.repeat(noise, 6) ** 2) + np.kron(accuracy, same)
    np.testing.assert_array_equal(own.covariance, expected)
    numbers, noise = np.random.default_rng(2).standard_normal((7, 2, 2, 3)), own.noise
    shared = np.array([FLAT.magnitude_accuracy, FLAT.phase_accuracy])[:, None, None]
    shrinkage = 1 - 1 / np.sqrt(1 + 3 * (shared / noise[..., :1]) ** 2)
    expected = (numbers - shrinkage * numbers.mean(axis=-1, keepdims=True)) / noise
    found = own.whitened(numbers.reshape(7, -1))
    np.testing.assert_allclose(found, expected.reshape(7, -1), rtol=1e-12, atol=1e-12)


def test_every_reading_has_the_spread_of_its_own_impedance():
    many = np.broadcast_to(Z, (20_000, 2, 3))
    meter = MeterSession(Growing(), 2, np.random.default_rng(1))
    ratio = meter.measure(many, FREQUENCY) / many
    for values, noise in zip(
        (np.log(np.abs(ratio)), np.angle(ratio)), model(Growing()).noise, strict=True
    ):
        np.testing.assert_allclose(values.std(axis=0), noise, rtol=0.03)


def test_errors_of_sessions_have_the_covariance_of_the_model():
    draws = [
        MeterSession(Growing(), 2, np.random.default_rng(k)).measure(Z[None], FREQUENCY)[0]
        for k in range(4000)
    ]
    found = np.cov(observed(np.array(draws) / Z).T)
    expected = model(Growing()).covariance
    scale = np.sqrt(np.outer(expected.diagonal(), expected.diagonal()))
    np.testing.assert_allclose(found / scale, expected / scale, atol=0.07)


@pytest.mark.parametrize("against_rest", [0, 3])
def test_all_forms_of_the_errors_are_one_covariance(against_rest):
    own = model(Growing(), against_rest=against_rest)
    x = np.random.default_rng(3).standard_normal((4, 2, 2, 3))
    flat = x.reshape(4, -1)
    expected = np.linalg.inv(own.covariance)
    whitened = own.whitened(flat)
    np.testing.assert_allclose(whitened @ whitened.T, flat @ expected @ flat.T)
    by = np.moveaxis(over_noise(flat, own), 0, -1)[None]
    linear = LinearLikelihood.of_cases(by, own, np.zeros(4))
    np.testing.assert_allclose(linear.information[0], flat @ expected @ flat.T)
    whole = linear.by_frequency().at(np.ones(3))
    np.testing.assert_allclose(whole[0], flat @ expected @ flat.T)


def test_readings_not_taken_do_not_enter():
    read = np.array([[True, False, True], [False, True, True]])
    own = ErrorModel(Growing(), read, reading=Z, frequency=FREQUENCY)
    kept = np.tile(read.ravel(), 2)
    np.testing.assert_array_equal(own.covariance, model(Growing()).covariance[np.ix_(kept, kept)])
    np.testing.assert_allclose(reading_from(observed(Z, read), read)[read], Z[read])


def test_errors_that_depend_on_the_reading_need_one():
    with pytest.raises(ValueError, match="`reading` must be given"):
        ErrorModel(Growing(), READ)
