"""What part of an error two orders show: told by meshes, told by orders, and against the truth."""

from itertools import pairwise

import numpy as np
import pytest
from rcskin.simulator.fem.error_estimate import WINDOW, frequencies_around, relative_difference
from rcskin.simulator.fem.safety_factors import FIRST_MESH, MIN_FACTOR, PREDICTED, VARIED
from rcskin.simulator.models.heterogeneous.error_history import (
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


def test_meshes_tell_how_much_of_the_error_the_next_order_shows():
    course, k = ErrorHistory(), 2.5
    pairs = [(off_by(error), off_by(error * (1 - 1 / k))) for error in (1e-2, 3e-3, 2.9e-3)]
    assert course.effect(FREQUENCY, *pairs[0]).tolist() == [FIRST_MESH] * 3
    assert course.effect(FREQUENCY, *pairs[1]) == pytest.approx(k, rel=1e-6)
    left, kept = FREQUENCY[1:], np.isin(AROUND, frequencies_around(FREQUENCY[1:]))
    later = [each[:, kept] for each in pairs[2]]
    assert course.effect(left, *later) == pytest.approx(k, rel=1e-6)


def test_what_corners_tell_of_a_mesh_in_advance_is_believed_where_it_is_less():
    """What the meshes before it told may be of corners that it has done with."""
    course = ErrorHistory()
    course.effect(FREQUENCY, off_by(1e-2), off_by(6e-3))
    course.predict(FREQUENCY[[0, -1]], np.array([1.0, 3.0]))
    found = course.effect(FREQUENCY, off_by(1e-3), off_by(6e-4))
    assert found == pytest.approx([PREDICTED, 2.5, 2.5])


def test_where_a_corner_is_weaker_than_elsewhere_more_is_believed_to_be_left():
    course, power = ErrorHistory(), np.array([0.1, np.inf])
    course.account_for_corners(power, 3)
    k = at_corners(power[0], 3)
    assert course.effect(FREQUENCY, off_by(1e-2), off_by(9e-3)) == pytest.approx([k] * 3)
    assert course.effect(FREQUENCY, off_by(5e-3), off_by(4.5e-3)) == pytest.approx([k] * 3)


def test_the_error_of_a_first_mesh_is_told_anew_by_what_corners_will_show():
    course, told = ErrorHistory(), np.array([[1e-3, 4e-3, 2e-3], [2e-3, 1e-3, 1e-3]])
    course.record(FREQUENCY, told)
    some = FREQUENCY[[0, 2]]
    assert course.expected_at(some, 2.0) == pytest.approx(np.array([2e-3, 2e-3]) * 2.0 / FIRST_MESH)
    assert course.expected_at(some, 1.0) == pytest.approx(
        np.array([2e-3, 2e-3]) * MIN_FACTOR / FIRST_MESH
    )
    assert course.expected_at(np.array([7.0]), 5.0) == pytest.approx([4e-3])
    for error in (1e-2, 3e-3):
        course.effect(FREQUENCY, off_by(error), off_by(error / 2))
    assert course.expected_at(some, 1.0) == pytest.approx([2e-3, 2e-3])


def test_at_corners_the_next_order_shows_as_little_as_their_exponent_tells():
    found = at_corners(np.array([0.5, 2 / 3, np.inf]), 3)
    assert found == pytest.approx([1 / (1 - 0.75**2), 1 / (1 - 0.75 ** (8 / 3)), 1.0])


def test_what_does_not_change_tells_nothing():
    course = ErrorHistory()
    for _ in range(3):
        assert course.effect(FREQUENCY, off_by(1e-3), off_by(1e-5)).tolist() == [FIRST_MESH] * 3


def test_smooth_errors_are_not_taken_for_less_than_the_least():
    course = ErrorHistory()
    for error in (1e-2, 1e-3):
        found = course.effect(FREQUENCY, off_by(error), Z)
    assert found.tolist() == [MIN_FACTOR] * 3


@pytest.mark.parametrize("power", [1.5, 2.0, 4.0, 8.0])
@pytest.mark.parametrize("order", [2, 3, 5, 9])
def test_orders_tell_how_their_errors_fall(order, power):
    orders = [off_by(1e-2 * p**-power) for p in range(order + 1, max(order - 3, 0), -1)]
    true = smoothed(relative_difference(orders[1], Z))
    told = VARIED * by_orders(order, steps(orders))
    assert (told >= true).all()
    assert (told <= 5 * true).all()


def test_orders_that_gain_by_twos_are_not_believed():
    """In a cell far wider than a layer the next order hardly changes the answer."""
    orders = [off_by(error) for error in (0.99e-2, 1e-2, 2.5e-2, 2.6e-2)]
    assert (VARIED * by_orders(3, steps(orders))).max() >= 1e-2


def test_meshes_that_gain_too_little_will_not_reach_a_tolerance():
    course = ErrorHistory()
    assert course.relative_error(1e-5) == 1.0
    assert course.will_reach(1e-5, 2)
    course.record(np.ones(1), np.array([8e-4]))
    assert course.relative_error(1e-5) == pytest.approx(80)
    assert course.will_reach(1e-5, 2)
    course.record(np.ones(1), np.array([2e-4]))
    assert not course.will_reach(1e-5, 2)
    assert course.will_reach(1e-5, 3)


def test_what_grows_with_frequency_is_told_as_it_is_and_what_changes_sign_is_not_lost():
    steep = (AROUND / 1e3) ** 3
    np.testing.assert_allclose(smoothed(steep), steep[: len(FREQUENCY)])
    crossing = np.abs(AROUND / FREQUENCY[0] / 1.001 - 1)
    assert smoothed(crossing)[0] > 0.01 * (WINDOW - 1)
