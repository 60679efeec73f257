"""Ratio of an error to the difference of two orders: by meshes, by orders, and the truth."""

from itertools import pairwise

import numpy as np
import pytest
from rcskin.simulator.fem.error_estimate import (
    FIRST_MESH,
    MIN_FACTOR,
    PREDICTED,
    VARIED,
    WINDOW,
    frequencies_around,
    relative_difference,
)
from rcskin.simulator.models.heterogeneous.discretised import (
    ErrorHistory,
    at_corners,
    by_orders,
    smoothed,
)

FREQUENCY = np.array([1e3, 1e4, 1e5])
AROUND = frequencies_around(FREQUENCY)
OMEGA = 2 * np.pi * AROUND
Z = (1 / (1e-6 + 1j * OMEGA * 1e-10))[None]
WAY = np.exp(0.7j) * np.abs(1 / Z)
"""Along which the admittance is off."""


def off_by(error):
    return 1 / (1 / Z + error * WAY)


def steps(orders):
    """How far each order is off the one above it."""
    return [smoothed(relative_difference(low, high)) for high, low in pairwise(orders)]


def test_meshes_give_the_ratio_of_error_and_difference():
    history, k = ErrorHistory(), 2.5
    pairs = [(off_by(error), off_by(error * (1 - 1 / k))) for error in (1e-2, 3e-3, 2.9e-3)]
    assert history.effect(FREQUENCY, *pairs[0]).tolist() == [FIRST_MESH] * 3
    assert history.effect(FREQUENCY, *pairs[1]) == pytest.approx(k, rel=1e-6)
    left, kept = FREQUENCY[1:], np.isin(AROUND, frequencies_around(FREQUENCY[1:]))
    later = [each[:, kept] for each in pairs[2]]
    assert history.effect(left, *later) == pytest.approx(k, rel=1e-6)


def test_the_smaller_of_observed_and_predicted_ratio_counts():
    """Previous meshes may have had errors at corners that this mesh resolves."""
    history = ErrorHistory()
    history.effect(FREQUENCY, off_by(1e-2), off_by(6e-3))
    history.predict(FREQUENCY[[0, -1]], np.array([1.0, 3.0]))
    found = history.effect(FREQUENCY, off_by(1e-3), off_by(6e-4))
    assert found == pytest.approx([PREDICTED, 2.5, 2.5])


def test_where_a_corner_is_weaker_than_elsewhere_more_is_believed_to_be_left():
    history, power = ErrorHistory(), np.array([0.1, np.inf])
    history.account_for_corners(power, 3)
    k = at_corners(power[0], 3)
    assert history.effect(FREQUENCY, off_by(1e-2), off_by(9e-3)) == pytest.approx([k] * 3)
    assert history.effect(FREQUENCY, off_by(5e-3), off_by(4.5e-3)) == pytest.approx([k] * 3)


def test_the_error_of_a_first_mesh_is_corrected_by_the_prediction():
    history, estimated = ErrorHistory(), np.array([[1e-3, 4e-3, 2e-3], [2e-3, 1e-3, 1e-3]])
    history.record(FREQUENCY, estimated)
    some = FREQUENCY[[0, 2]]
    assert history.expected_at(some, 2.0) == pytest.approx(
        np.array([2e-3, 2e-3]) * 2.0 / FIRST_MESH
    )
    assert history.expected_at(some, 1.0) == pytest.approx(
        np.array([2e-3, 2e-3]) * MIN_FACTOR / FIRST_MESH
    )
    assert history.expected_at(np.array([7.0]), 5.0) == pytest.approx([4e-3])
    for error in (1e-2, 3e-3):
        history.effect(FREQUENCY, off_by(error), off_by(error / 2))
    assert history.expected_at(some, 1.0) == pytest.approx([2e-3, 2e-3])


def test_at_corners_the_ratio_follows_from_the_exponent():
    found = at_corners(np.array([0.5, 2 / 3, np.inf]), 3)
    assert found == pytest.approx([1 / (1 - 0.75**2), 1 / (1 - 0.75 ** (8 / 3)), 1.0])


def test_an_unchanged_difference_gives_no_ratio():
    history = ErrorHistory()
    for _ in range(3):
        assert history.effect(FREQUENCY, off_by(1e-3), off_by(1e-5)).tolist() == [FIRST_MESH] * 3


def test_smooth_errors_are_not_taken_for_less_than_the_least():
    history = ErrorHistory()
    for error in (1e-2, 1e-3):
        found = history.effect(FREQUENCY, off_by(error), Z)
    assert found.tolist() == [MIN_FACTOR] * 3


@pytest.mark.parametrize("power", [1.5, 2.0, 4.0, 8.0])
@pytest.mark.parametrize("order", [2, 3, 5, 9])
def test_orders_give_the_decay_of_their_errors(order, power):
    orders = [off_by(1e-2 * p**-power) for p in range(order + 1, max(order - 3, 0), -1)]
    true = smoothed(relative_difference(orders[1], Z))
    estimated = VARIED * by_orders(order, steps(orders))
    assert (estimated >= true).all()
    assert (estimated <= 5 * true).all()


def test_orders_that_gain_by_twos_are_not_believed():
    """In a cell far wider than a layer the next order hardly changes the answer."""
    orders = [off_by(error) for error in (0.99e-2, 1e-2, 2.5e-2, 2.6e-2)]
    assert (VARIED * by_orders(3, steps(orders))).max() >= 1e-2


def test_meshes_that_gain_too_little_will_not_reach_a_tolerance():
    history = ErrorHistory()
    assert history.relative_error(1e-5) == 1.0
    assert history.will_reach(1e-5, 2)
    history.record(np.ones(1), np.array([8e-4]))
    assert history.relative_error(1e-5) == pytest.approx(80)
    assert history.will_reach(1e-5, 2)
    history.record(np.ones(1), np.array([2e-4]))
    assert not history.will_reach(1e-5, 2)
    assert history.will_reach(1e-5, 3)


def test_smoothing_keeps_powers_of_frequency_and_changes_of_sign():
    steep = (AROUND / 1e3) ** 3
    np.testing.assert_allclose(smoothed(steep), steep[: len(FREQUENCY)])
    crossing = np.abs(AROUND / FREQUENCY[0] / 1.001 - 1)
    assert smoothed(crossing)[0] > 0.01 * (WINDOW - 1)
