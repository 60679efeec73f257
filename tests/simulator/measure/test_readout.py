"""The meter's error model: on |Z| and phase, fixed for a session or new with each reading."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.measure.readout import MeterSession, displayed, read_out
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.meter import Readout
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import impedance

READINGS = 20_000


@pytest.fixture(scope="module")
def at_rest():
    return simulate(Solver(load_scene("strip-1x3").parts), [Press()] * 4)


def error_of(readout, seed=1, sweeps=READINGS):
    Z = np.full((sweeps, 1, 1), 3e4 - 4e4j)
    return MeterSession(readout, 1, np.random.default_rng(seed)).measure(Z, np.array([1e3]))[
        :, 0, 0
    ] / (3e4 - 4e4j)


def test_noise_has_the_stated_spread_of_magnitude_and_of_phase():
    error = error_of(Readout(magnitude_noise=0.003, phase_noise=2e-3))
    assert np.std(np.abs(error)) == pytest.approx(0.003, rel=0.03)
    assert np.std(np.angle(error)) == pytest.approx(2e-3, rel=0.03)
    assert abs(np.mean(np.abs(error)) - 1) < 5 * 0.003 / np.sqrt(READINGS)


def test_accuracy_is_one_draw_for_the_whole_session():
    readout = Readout(magnitude_accuracy=0.01, phase_accuracy=0.02)
    error = error_of(readout, sweeps=10)
    assert np.ptp(np.abs(error)) < 1e-12
    draws = np.array([error_of(readout, seed, sweeps=1).item() for seed in range(2000)])
    assert np.std(np.abs(draws)) == pytest.approx(0.01, rel=0.1)
    assert np.std(np.angle(draws)) == pytest.approx(0.02, rel=0.1)


def test_a_perfect_meter_of_many_digits_shows_the_truth(at_rest):
    shown = read_out(at_rest, Readout(display_digits=17), np.random.default_rng(0))
    np.testing.assert_allclose(impedance(shown), impedance(at_rest), rtol=1e-15)


def test_the_same_seed_gives_the_same_bits(at_rest):
    readout = load_scene("strip-1x3").readout
    first, again = (read_out(at_rest, readout, np.random.default_rng(3)) for _ in range(2))
    assert first.identical(again)


def test_numerical_errors_are_not_handed_on(at_rest):
    shown = read_out(at_rest, Readout(), np.random.default_rng(0), session=7)
    assert "Rs_error" not in shown
    assert set(shown["session"].values) == {7}


@given(st.floats(1e-15, 1e15), st.integers(2, 12), st.booleans())
def test_display_rounds_to_its_digits(value, digits, negative):
    signed = -value if negative else value
    shown = displayed(np.array([signed]), digits).item()
    assert float(f"{shown:.{digits - 1}e}") == pytest.approx(shown, rel=1e-14)
    assert abs(shown - signed) <= 0.5000001 * 10 ** (np.floor(np.log10(value)) + 1 - digits)


def test_zero_is_displayed_as_zero():
    assert displayed(np.zeros(2), 6).tolist() == [0.0, 0.0]
