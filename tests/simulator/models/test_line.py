"""The paper's analytic model, Eqs 1-6, and the finite open line."""

import numpy as np
import pytest
from rcskin.simulator.models.line import (
    HALF_POWER,
    attenuation,
    interrogation_frequency,
    open_line_amplitude,
    propagation_constant,
)

R, C, LENGTH = 50e6, 108e-12, 0.1


def test_attenuation_and_phase_constant_are_equal():
    gamma = propagation_constant([10.0, 1e3, 1e5], R, C)
    np.testing.assert_allclose(gamma.real, gamma.imag, rtol=1e-15)
    np.testing.assert_allclose(gamma**2, 2j * np.pi * np.array([10.0, 1e3, 1e5]) * R * C)


@pytest.mark.parametrize(
    ("n", "expected"),
    [
        (3, [6367, 1592, 707]),
        (4, [11319, 2830, 1258, 707]),
        (5, [17685, 4421, 1965, 1105, 707]),
    ],
)
def test_interrogation_frequencies_of_the_strip(n, expected):
    ends = LENGTH * np.arange(1, n + 1) / n
    np.testing.assert_array_equal(np.round(interrogation_frequency(ends, R, C)), expected)


def test_the_wave_is_at_half_power_at_the_unrounded_interrogation_frequency():
    exact = np.log(HALF_POWER) ** 2 / np.pi
    f = interrogation_frequency(0.04, R, C, exact)
    assert attenuation(f, 0.04, R, C) == pytest.approx(HALF_POWER, rel=1e-14)


def test_the_open_line_is_the_quotient_of_hyperbolic_cosines():
    f, x = np.geomspace(10, 1e5, 9), 0.03
    gamma = propagation_constant(f, R, C)
    expected = np.abs(np.cosh(gamma * (LENGTH - x)) / np.cosh(gamma * LENGTH))
    np.testing.assert_allclose(open_line_amplitude(f, x, LENGTH, R, C), expected, rtol=1e-13)


def test_far_above_cut_off_the_open_line_is_the_infinite_one():
    near, f = 0.01, 1e7
    finite = open_line_amplitude(f, near, LENGTH, R, C)
    assert finite == pytest.approx(attenuation(f, near, R, C), rel=1e-12)


def test_the_open_line_neither_overflows_nor_moves_at_the_limits():
    amplitude = open_line_amplitude([1e-6, 1e12], 0.05, LENGTH, R, C)
    assert amplitude[0] == pytest.approx(1)
    assert amplitude[1] == 0
