"""Regions of a normal posterior, which closed forms know."""

import numpy as np
import pytest
from rcskin.localization.inversion.region import PlaceDistribution, region_of

MIDDLE, DEVIATION, SIDE = np.array([62.0, 57.0]), 8.0, 120.0
REACH = DEVIATION * np.sqrt(-2 * np.log(0.05))
"""Of 95 %: of a normal density in the plane exp(-r²/2d²) lies beyond r."""


@pytest.fixture
def places():
    covariance = DEVIATION**2 * np.eye(2)
    bounds = np.array([[0.0, SIDE], [0.0, SIDE]])
    return PlaceDistribution(np.ones(1), MIDDLE[None], covariance[None], bounds)


def around(radius, count=24):
    turn = np.linspace(0, 2 * np.pi, count, endpoint=False)
    return MIDDLE[0] + radius * np.cos(turn), MIDDLE[1] + radius * np.sin(turn)


@pytest.mark.parametrize("radius", [5.0, 10.0, 20.0])
def test_no_disc_holds_more_than_the_one_about_the_middle(places, radius):
    expected = 1 - np.exp(-(radius**2) / (2 * DEVIATION**2))
    assert places.share_within(radius) == pytest.approx(expected, abs=0.03)


def test_the_region_is_the_disc_that_holds_so_much(places):
    region = region_of(places, 0.95)
    assert region.area == pytest.approx(np.pi * REACH**2, rel=0.05)
    for radius, inside in ((0.93 * REACH, True), (1.07 * REACH, False)):
        assert {region.covers(x, y) for x, y in np.transpose(around(radius))} == {inside}


def test_it_is_shaded_as_the_density_falls_and_ends_at_its_border(places):
    region = region_of(places, 0.95)
    assert region.shade(*MIDDLE) == pytest.approx(1.0, abs=0.03)
    for radius in (5.0, 15.0):
        expected = np.exp(-(radius**2) / (2 * DEVIATION**2))
        np.testing.assert_allclose(region.shade(*around(radius)), expected, rtol=0.03)
    np.testing.assert_array_equal(region.shade(*around(1.07 * REACH)), 0.0)
