"""Readings one after the other that tell a place: together what a whole sweep tells of it."""

import runpy
from pathlib import Path

import numpy as np
import pytest
from rcskin.localization.inversion.classifier import InversionPlan
from rcskin.localization.inversion.position import ModelBasedPosition, cells_of
from rcskin.localization.inversion.region import region_of
from rcskin.localization.inversion.sequential_posterior import PlacePosterior, log_prior_of

_rig = runpy.run_path(str(Path(__file__).with_name("test_position.py")))
builder, change, touches = (_rig[name] for name in ("builder", "change", "touches"))
READINGS, REST = _rig["NUMBERS"] // 2, _rig["REST"]
EVERY = np.arange(READINGS)


@pytest.fixture(scope="module")
def own():
    plan = InversionPlan("", "position", rest_sweeps=REST, builder=builder)
    return ModelBasedPosition.fitted(plan)


def told(own, x, order, rest=0.5):
    placing = PlacePosterior(own, log_prior_of(own, rest))
    for k in order:
        placing.update(k, x[[k, k + READINGS]])
    return placing


def test_all_readings_in_any_order_give_what_the_whole_sweep_gives(own):
    X, _ = touches(4, 0)
    for x, whole, cells in zip(X, own.places(X), own.cells(X), strict=True):
        for order in (EVERY, EVERY[::-1]):
            placing = told(own, x, order, rest=0.0)
            np.testing.assert_allclose(placing.places.peak(3.0), whole.peak(3.0), atol=0.1)
            np.testing.assert_allclose(cells_of(placing.posterior), cells, atol=0.02, rtol=0.05)
            assert not placing.novel and placing.unpressed == 0


def test_regions_of_parts_of_sweeps_hold_the_touch_as_often_as_they_say(own):
    X, theta = touches(60, 2)
    half = [told(own, x, (0, 3, 5)) for x in X]
    regions = [region_of(placing.places, 0.95) for placing in half]
    covered = [r.covers(x, y) for r, (x, y, _) in zip(regions, theta, strict=True)]
    assert 0.95 - 0.06 < np.mean(covered) <= 1


def test_rest_is_distinguished_from_touches_and_both_from_what_is_neither(own):
    X, _ = touches(20, 3)
    assert max(told(own, x, EVERY).unpressed for x in X) < 0.05
    nothing = own.noise * np.random.default_rng(1).standard_normal((20, 2 * READINGS))
    assert min(told(own, x, EVERY).unpressed for x in nothing) > 0.95
    assert told(own, X[0] + 0.05 * (-1.0) ** np.arange(2 * READINGS), EVERY).novel


def test_readings_that_gain_most_shrink_the_region_most(own):
    """Against what each reading does to the mean ln of the region's area, over some touches."""
    X, _ = touches(12, 4)
    before = [told(own, x, [0]) for x in X]
    gains = np.mean([placing.gains(EVERY[1:]) for placing in before], axis=0)
    sizes = [
        np.mean([np.log(region_of(told(own, x, [0, k]).places, 0.95).area) for x in X])
        for k in EVERY[1:]
    ]
    assert np.corrcoef(gains, sizes)[0, 1] < -0.8
    assert (gains > 0).all()


def test_a_belief_that_a_touch_is_there_counts(own):
    prior = log_prior_of(own, 0.5)
    believed = prior.copy()
    believed[1:] -= 50.0
    believed[1 + 37] += 50.0
    placing = PlacePosterior(own, believed)
    assert cells_of(placing.posterior)[:, 0].argmax() == 37
    assert placing.unpressed > PlacePosterior(own, prior).unpressed
