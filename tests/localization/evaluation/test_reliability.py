"""Charts of whether what is stated can be believed, on answers whose truth is drawn as stated."""

import numpy as np
import pytest
from matplotlib.figure import Figure
from rcskin.localization.evaluation.reliability import (
    draw_coverage,
    draw_regions,
    draw_reliability,
    draw_risk,
    risk,
)
from rcskin.localization.inversion.region import PlaceDistribution, region_of

SEED = 3


@pytest.fixture
def axes():
    return Figure().subplots()


def stated(count=4000):
    random = np.random.default_rng(SEED)
    probability = random.uniform(0.3, 1.0, count)
    return probability, random.random(count) < probability


def points(axes):
    """Of the first line drawn, as shares of 1."""
    return axes.lines[0].get_xydata().T / 100


def test_answers_as_good_as_said_lie_on_the_diagonal(axes):
    draw_reliability(axes, *stated())
    said, found = points(axes)
    assert said.size == 10
    np.testing.assert_allclose(found, said, atol=0.08)


def test_overconfidence_lies_below_it_and_is_stated_in_the_title(axes):
    probability, right = stated()
    draw_reliability(axes, np.minimum(1.0, probability + 0.2), right)
    said, found = points(axes)
    assert (found < said - 0.05).all()
    off = float(axes.get_title().split("off by ")[1].split(" %")[0])
    assert off == pytest.approx(
        100 * (np.minimum(1, probability + 0.2) - probability).mean(), abs=2
    )


def test_the_axes_begin_below_the_lowest_point_and_not_at_the_end_of_a_bar(axes):
    """Of ten answers nearly sure and all wrong but one, a bar reaches down to nothing."""
    draw_reliability(axes, np.repeat([0.6, 0.9], 10), np.arange(20) >= 4)
    assert axes.get_xlim()[0] == axes.get_ylim()[0] == pytest.approx(57)


@pytest.mark.parametrize("count", [1, 2, 15])
def test_few_answers_are_drawn_too(axes, count):
    draw_reliability(axes, *stated(count))
    assert len(points(axes)[0]) == 1


def test_risk_falls_as_fewer_are_answered_and_keeps_what_was_promised(axes):
    probability, right = stated()
    told, wrong, promised = risk(probability, right)
    assert told[-1] == 1 and wrong[-1] == pytest.approx(1 - right.mean())
    many = told > 0.1
    np.testing.assert_allclose(wrong[many], promised[many], atol=0.04)
    assert wrong[told.searchsorted(0.3)] < wrong[-1] / 2
    draw_risk(axes, probability, right)
    assert axes.get_title().startswith(f"{100 * (1 - right.mean()):.1f} % wrong")


def test_answers_of_one_probability_are_one_point():
    told, wrong, promised = risk(np.full(4, 0.75), np.array([True, False, True, True]))
    np.testing.assert_array_equal([told, wrong, promised], [[1], [0.25], [0.25]])


def posteriors(count, wider=1.0):
    """Normal ones of 3 by 8 mm, said to be wider by a factor, within 120 by 80 mm; and touches."""
    random, sides = np.random.default_rng(SEED), np.array([3.0, 8.0])
    bounds = np.array([[0.0, 120.0], [0.0, 80.0]])
    means = random.uniform([30, 30], [90, 50], (count, 2))
    covariance = np.diag((wider * sides) ** 2)[None]
    places = [PlaceDistribution(np.ones(1), mean[None], covariance, bounds) for mean in means]
    return places, means + sides * random.standard_normal((count, 2))


@pytest.mark.parametrize(("wider", "held"), [(1.0, 0.95), (0.5, 0.53), (2.0, 1.0)])
def test_regions_hold_touches_as_often_as_theory_says(axes, wider, held):
    places, touches = posteriors(400, wider)
    content = np.array([each.content(*at) for each, at in zip(places, touches, strict=True)])
    draw_coverage(axes, content)
    share = float(axes.get_title().split("hold ")[1].split(" %")[0]) / 100
    assert share == pytest.approx(held, abs=3 * np.sqrt(held * (1 - held) / 400) + 0.01)


def test_regions_are_drawn_around_their_touches(axes):
    places, touches = posteriors(2)
    regions = {k: region_of(each, 0.95) for k, each in enumerate(places)}
    draw_regions(axes, touches, regions)
    assert len(axes.lines) == 2 and len(axes.collections) == 2
    np.testing.assert_allclose(axes.lines[1].get_xydata(), touches[1:])
