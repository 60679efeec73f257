"""Common draws: accuracies, errors of their differences, and more readings."""

import numpy as np
import pytest
from rcskin.simulator.bounds.bayes import (
    NEGLIGIBLE,
    Draws,
    DrawScores,
    bayes,
    in_tiles,
    posterior,
    posterior_of_tiles,
)
from rcskin.simulator.bounds.field_choice import fields_of
from rcskin.simulator.bounds.full_fields import CELLS_PER_PIXEL, FullFields
from rcskin.simulator.bounds.likelihood import Likelihood
from rcskin.simulator.bounds.position_bound import chosen_touch, place_likelihood, places_on
from rcskin.simulator.bounds.touch_readings import TouchReadings, hypotheses
from rcskin.simulator.measure.experiment import own_presses
from rcskin.simulator.models.parameters import nominal
from rcskin.simulator.models.reduced.cases import pixel_touches
from rcskin.simulator.models.terminals import read, trained
from rcskin.simulator.scene.parts import Setup
from rcskin.tests.simulator.bounds.every_strength import compared, exact

SPAN = {"span": (0.01, 1.0)}
FOILS = dict.fromkeys(("top-left", "bottom-left", "top-bottom", "bottom-bottom"), SPAN)
READINGS = {
    "left": ("top-left", "bottom-left"),
    "bottom": ("top-bottom", "bottom-bottom"),
    "crossed": ("top-left", "bottom-bottom"),
    "one sheet": ("top-left", "top-bottom"),
}
NOISE = {"magnitude_noise": 0.02, "phase_noise": 0.02}


def draws_of(scene, target="pixel", **more):
    """Random presses of a scene's pixels."""
    among = hypotheses(scene.parts.skin, scene.parts.plan, target)
    return Draws(among, own_presses(scene.parts.skin, scene.press), **more)


@pytest.fixture(scope="module")
def scene(noisy):
    wide = {"rows": 2, "columns": 3, "frequencies": (1e3, 1e4, 1e5)}
    return noisy(readout=NOISE, accuracy=True, contacts=FOILS, interfaces=READINGS, **wide)


@pytest.fixture(scope="module")
def model(scene):
    return trained(scene.parts, 1e-2, pixel_touches(scene.parts.skin, scene.parts.plan, (0.5, 3.0)))


def read_by(model, scene, count=None, variation=None):
    """The likelihood of a skin that is read through so many of a scene's interfaces."""
    some = scene.interfaces[:count]
    skin, meter = read(model, some).at(variation), scene.parts.meter
    return Likelihood(
        scene.parts.skin, skin.sweeps, Setup(some, scene.frequencies, scene.leads), meter
    )


@pytest.fixture(scope="module")
def scores(scene, model):
    """A function from a number of readings to what they tell."""
    draws = draws_of(scene, draws=3000)
    return lambda count: draws.score(read_by(model, scene, count))


def test_the_accuracy_is_that_of_the_best_classifier(scene, model, scores):
    readings = TouchReadings(scene.parts, own_presses(scene.parts.skin, scene.press))
    readings._reduced = read(model, scene.interfaces)
    asked = (
        readings,
        hypotheses(scene.parts.skin, scene.parts.plan, "pixel"),
        own_presses(scene.parts.skin, scene.press),
    )
    best = exact(*asked, seed=2, draws=3000)
    assert 0.4 < best.share < 0.97
    for found in (scores(len(READINGS)).accuracy, bayes(*asked, seed=3, draws=3000)):
        assert found.share == pytest.approx(best.share, abs=4 * np.hypot(found.error, best.error))


def gain(one, other):
    """Difference of two accuracies by the same draws, with its standard error."""
    return DrawScores(one.correct - other.correct).accuracy


def test_more_readings_never_lower_the_accuracy(scores):
    each = [scores(count) for count in range(1, len(READINGS) + 1)]
    for fewer, more in zip(each[:-1], each[1:], strict=True):
        assert gain(more, fewer).share > -4 * gain(more, fewer).error
    assert gain(each[1], each[0]).share > 0.05


def test_a_difference_has_a_far_smaller_error_than_each_accuracy(scene, model):
    """By as much as it says: other draws give it as well."""
    other = nominal(model.parts.skin)
    conducting = type(other)(
        other.top * 0.97, other.bottom, other.films, other.capacitance, other.loss
    )
    skins = [read_by(model, scene, 2, each) for each in (None, conducting)]
    gains = []
    for seed in range(12):
        one, two = (draws_of(scene, draws=500, seed=seed).score(skin) for skin in skins)
        gains.append(gain(one, two))
    assert gains[0].error < 0.2 * one.accuracy.error
    spread = np.std([each.share for each in gains], ddof=1)
    assert 0.4 < np.mean([each.error for each in gains]) / spread < 2.5


def test_readings_that_are_not_taken_have_no_effect(scene, model, scores):
    """At no frequency of the others, the first is alone."""
    taken = np.zeros((len(READINGS), 3), dtype=bool)
    taken[0] = True
    found = draws_of(scene, draws=3000).score(read_by(model, scene).some(taken))
    np.testing.assert_allclose(found.correct, scores(1).correct, atol=1e-3)


@pytest.fixture(scope="module")
def pair_scene(scene):
    """Of few readings, by a meter that errs little enough for many strengths."""
    clear = {"readout.magnitude_noise": 6e-3, "readout.phase_noise": 6e-3}
    read_by = [each.model_dump(mode="json") for each in scene.interfaces[:1]]
    return scene.with_({"interface": read_by, "press.factor_spread": 0.2, **clear})


def test_the_accuracy_of_pairs_is_that_of_the_best_classifier(pair_scene, model):
    presses = own_presses(pair_scene.parts.skin, pair_scene.press)
    readings = TouchReadings(pair_scene.parts, presses)
    readings._reduced = read(model, pair_scene.interfaces)
    asked = readings, hypotheses(pair_scene.parts.skin, pair_scene.parts.plan, "pair"), presses
    best = exact(*asked, seed=2, draws=3000)
    assert 0.4 < best.share < 0.97
    draws = draws_of(pair_scene, "pair", draws=3000)
    common = draws.score(read_by(model, pair_scene)).accuracy
    for found in (common, bayes(*asked, seed=3, draws=3000)):
        assert found.share == pytest.approx(best.share, abs=4 * np.hypot(found.error, best.error))


def test_what_tiles_leave_out_is_negligible(pair_scene, model):
    presses = own_presses(pair_scene.parts.skin, pair_scene.press)
    readings = TouchReadings(pair_scene.parts, presses)
    readings._reduced = read(model, pair_scene.interfaces)
    among = hypotheses(pair_scene.parts.skin, pair_scene.parts.plan, "pair")
    known, measured = compared(readings, among, presses, 3, 200)
    sizes = np.diff([*known.starts, len(known.chance)])
    orders, tiles = [], []
    for start, size in zip(known.starts, sizes, strict=True):
        side = next(n for n in range(int(size**0.5), 0, -1) if size % n == 0)
        order, begun = in_tiles((side, int(size) // side))
        assert sorted(order) == list(range(size))
        orders.append(start + order)
        tiles.append(start + begun)
    order, tiles = np.concatenate(orders), np.concatenate(tiles)
    assert len(tiles) > 2 * len(among)
    sorted_ = known._replace(readings=known.readings[order], chance=known.chance[order])
    found = posterior_of_tiles(sorted_, tiles, measured)
    bound = 4 * len(tiles) * NEGLIGIBLE
    np.testing.assert_allclose(found, posterior(known, measured), atol=bound + 1e-11)


def test_bounds_on_position_are_those_of_the_full_elements(scene):
    touch, highest = chosen_touch(scene.parts.skin, scene.press), float(scene.frequencies[-1])
    places = places_on(scene.parts.skin, touch, CELLS_PER_PIXEL)[1::5]
    both = [fields_of(scene.parts, highest, touch), FullFields(scene.parts, highest)]
    assert not isinstance(both[0], FullFields)
    found, truth = (
        place_likelihood(each, places, touch, scene.frequencies).bounds() for each in both
    )
    for name in ("x", "y", "strength"):
        np.testing.assert_allclose(getattr(found, name), getattr(truth, name), rtol=0.04)
