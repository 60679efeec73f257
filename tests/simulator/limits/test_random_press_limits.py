"""Limits for presses off the centre of their pixel, and the median of a posterior."""

import numpy as np
import pytest
from rcskin.simulator.bounds.touch_readings import hypotheses
from rcskin.simulator.limits import bayes_accuracy, off_centre_accuracy, posterior_distance
from rcskin.simulator.limits.random_press_limits import CELLS, RandomPresses, _geometric_medians
from rcskin.simulator.measure.readout import observed
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press
from rcskin.simulator.press.touch import Rectangle
from rcskin.simulator.scene.randomisation import Fixed, Normal
from rcskin.simulator.sweeps import InputError, impedance
from scipy.special import ndtr

STRIP = {"length": 0.1, "width": 0.02, "frequencies": (1e3, 1e4)}


@pytest.fixture(scope="module")
def strip(noisy):
    noise = {"magnitude_noise": 0.015, "phase_noise": 0.015}
    return noisy(readout=noise, spread=0.2, columns=4, **STRIP)


def test_without_offset_the_accuracy_is_that_of_whole_pixels(strip):
    share, error = bayes_accuracy(strip.parts, "column", draws=3000)
    found = off_centre_accuracy(strip.parts, "column", offset=0.0, draws=3000, samples=600)
    assert 0.5 < share < 0.98
    both = 4 * np.hypot(error, found.error)
    assert found.lower == pytest.approx(share, abs=both)
    assert found.upper == pytest.approx(share, abs=both)


def test_the_accuracy_falls_with_the_offset_and_samples_narrow_its_interval(strip):
    near, far = (
        off_centre_accuracy(strip.parts, "column", offset=offset, draws=2000, samples=1000)
        for offset in (0.05, 0.4)
    )
    assert far.upper < near.lower - 2 * near.error
    few = off_centre_accuracy(strip.parts, "column", offset=0.4, draws=2000, samples=10)
    assert few.upper - few.lower > far.upper - far.lower
    assert few.lower < far.upper and few.upper > far.lower


def test_two_presses_without_spread_are_two_points_in_normal_noise(noisy):
    noise = {"magnitude_noise": 0.03, "phase_noise": 0.03}
    scene = noisy(readout=noise, spread=0.0, columns=2, **STRIP)
    hand = RandomPresses(scene.parts, Fixed(value=2.0), size=(0.05, 0.02))
    random = np.random.default_rng(0)
    one, other = (
        hand.pressed(each, random, 1)
        for each in hypotheses(scene.parts.skin, scene.parts.plan, "column")
    )
    exact = ndtr(np.linalg.norm(one - other) / 2)
    found = off_centre_accuracy(scene.parts, "column", offset=0.0, draws=4000, samples=1)
    assert found.lower == pytest.approx(exact, abs=4 * found.error)


def test_mirrored_rows_are_guessed(noisy):
    noise = {"magnitude_noise": 1e-2, "phase_noise": 1e-2}
    scene = noisy(readout=noise, spread=0.0, rows=2, columns=1, frequencies=(1e3, 1e4))
    found = off_centre_accuracy(scene.parts, "row", offset=0.0, draws=300, samples=2)
    assert found.upper == pytest.approx(0.5, abs=0.05)


def test_readings_of_a_touch_on_cells_are_those_of_the_solver(strip):
    side = 0.1 / 4 / CELLS
    hand = RandomPresses(strip.parts, Fixed(value=2.0), size=(2 * side, 0.02))
    middles = np.array([[[5 * side, 0.01]]])
    read = hand.read(middles, np.random.default_rng(0))
    press = Press((Rectangle(5 * side, 0.01, 2 * side, 0.02, 2.0),))
    exact = hand.errors.whitened(observed(impedance(simulate(Solver(strip.parts, 1e-6), [press]))))
    np.testing.assert_allclose(read, exact, atol=0.1)


def test_the_distance_falls_with_the_noise_to_that_of_a_guess(noisy):
    def median(size):
        scene = noisy(readout={"magnitude_noise": size, "phase_noise": size}, **STRIP)
        spread = Normal(mean=2.0, deviation=0.1)
        return posterior_distance(scene.parts, spread, size=0.02, draws=200, samples=4000)

    (told, error), (lost, _) = median(0.01), median(1.0)
    assert error < told < 0.5 * lost
    assert lost == pytest.approx(0.02, rel=0.2)


def test_the_geometric_median_has_the_smallest_mean_distance():
    places = np.random.default_rng(0).normal(size=(50, 2))
    found = _geometric_medians(np.full((1, 50), 1 / 50), places)

    def mean(point):
        return np.hypot(*(places - point).T).mean()

    around = found + 0.05 * np.array([[1, 0], [-1, 0], [0, 1], [0, -1]])
    assert all(mean(found) < mean(other) for other in around)


def test_an_offset_out_of_range_is_refused(strip):
    with pytest.raises(InputError, match=r"`offset` must be in 0..0.5"):
        off_centre_accuracy(strip.parts, offset=0.6)
