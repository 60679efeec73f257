"""A press is told from the noise of the meter: neither missed nor made up."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.hardware.meter.meter_reading import MeterReading
from rcskin.hardware.record.measured_sweep import (
    InterfaceTrace,
    MeasuredSweep,
    percent_change,
    undetected_press,
)

FREQUENCY = np.geomspace(1e3, 2e5, 20)
Q = np.sqrt(2j * np.pi * FREQUENCY * 1e-5)
LINE = 1e5 / (Q * np.tanh(Q))
BESIDE_CUT_OFF = 1 / (1 + (FREQUENCY / 1e4) ** 2)
NOISE = 3e-3
seeds = st.integers(0, 2**32 - 1)


def sweep_of(Z, random, noise=NOISE):
    real, imaginary = random.standard_normal((2, Z.size))
    Z = Z * (1 + noise * (real + 1j * imaginary))
    readings = tuple(map(MeterReading, Z.tolist()))
    return MeasuredSweep((InterfaceTrace(tuple(FREQUENCY[: Z.size].tolist()), readings),))


@given(seeds, st.integers(2, 4))
def test_repeated_rest_is_no_press(seed, rests):
    random = np.random.default_rng(seed)
    *before, now = (sweep_of(LINE, random) for _ in range(rests + 1))
    (told,) = undetected_press(now, before)
    assert told.startswith("no press detected: the readings differ from the unpressed skin by 0.")


def test_a_single_baseline_shows_nearly_all_that_is_no_press():
    random = np.random.default_rng(1)
    told = [
        undetected_press(sweep_of(LINE, random), [sweep_of(LINE, random)]) != [] for _ in range(500)
    ]
    assert np.mean(told) > 0.98


@given(seeds, st.integers(1, 4))
def test_a_press_that_only_low_frequencies_reach_is_seen(seed, rests):
    random = np.random.default_rng(seed)
    before = [sweep_of(LINE, random) for _ in range(rests)]
    pressed = sweep_of(LINE * (1 - 0.05 * BESIDE_CUT_OFF), random)
    assert undetected_press(pressed, before) == []


@given(seeds)
def test_slow_drift_of_the_rest_is_not_the_noise_of_the_meter(seed):
    random = np.random.default_rng(seed)
    before = [sweep_of(LINE * (1 + 0.02 * k), random) for k in range(3)]
    pressed = sweep_of(LINE * 1.04 * (1 - 0.05 * BESIDE_CUT_OFF), random)
    assert undetected_press(pressed, before) == []


@pytest.mark.parametrize("rests", [1, 2])
def test_few_readings_without_noise_are_distinguished(rests):
    random, few = np.random.default_rng(1), LINE[:3]
    before = [sweep_of(few, random, 0)] * rests
    assert undetected_press(sweep_of(few, random, 0), before) != []
    assert undetected_press(sweep_of(1.002 * few, random, 0), before) == []


@pytest.mark.parametrize("at", [0, 1])
def test_a_press_that_one_interface_sees_is_seen(at):
    random = np.random.default_rng(1)

    def at_both(*Z):
        return MeasuredSweep(tuple(sweep_of(each, random).traces[0] for each in Z))

    before = [at_both(LINE, 2 * LINE) for _ in range(3)]
    pressed = [LINE, 2 * LINE]
    assert undetected_press(at_both(*pressed), before) != []
    pressed[at] = pressed[at] * (1 - 0.05 * BESIDE_CUT_OFF)
    assert undetected_press(at_both(*pressed), before) == []


def test_without_a_rest_nothing_is_said():
    assert undetected_press(sweep_of(LINE, np.random.default_rng(1)), []) == []


def test_changes_are_in_percent_of_what_was_at_rest_also_of_nothing():
    now, before = np.array([1.1, 2.0]), np.array([1.0, 0.0, 5.0])
    assert percent_change(now, before) == pytest.approx([10, np.nan], nan_ok=True)
