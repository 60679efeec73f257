"""The best frequencies, and the sets that they are compared with."""

import numpy as np
import pytest
from rcskin.simulator.bounds.choice import best_choice
from rcskin.simulator.bounds.frequency_sets import (
    DISTINCT,
    LOGARITHMIC,
    frequencies_among,
    own_band,
    too_near,
)
from rcskin.simulator.bounds.position_bound import chosen_touch
from rcskin.simulator.limits.frequency_design import design
from rcskin.simulator.limits.survey import SurveyOptions, survey
from rcskin.simulator.sweeps import InputError


def test_the_best_set_is_no_worse_than_the_others_and_always_the_same(noisy_strip):
    found, again = (
        design(
            noisy_strip.parts,
            4,
            (1e2, 1e5),
            chosen_touch(noisy_strip.parts.skin, noisy_strip.press),
            grid=12,
        )
        for _ in range(2)
    )
    assert min(found.figures.values()) == found.figures["optimal"]
    assert (found.best[1:] / found.best[:-1]).min() >= DISTINCT
    assert all(found.ratio(name) >= 1 for name in found.sets)
    np.testing.assert_array_equal(found.best, again.best)
    assert len(set(found.best)) == 4 and len(found.sets[LOGARITHMIC]) == 4


def test_the_error_is_that_of_limits(noisy_strip):
    """Of the same frequencies: the median over the sheet, as `rcskin limits` shows it."""
    touch = chosen_touch(noisy_strip.parts.skin, noisy_strip.press)
    found = design(noisy_strip.parts, 3, own_band(noisy_strip.parts.setup), touch)
    limits = {each.name: each for each in survey(noisy_strip.parts, SurveyOptions(touch), n=3)}
    assert set(found.errors) == {"optimal", "Eq. 6", "log spacing"}
    for name, error in found.errors.items():
        same = limits[f"3, {name}"]
        np.testing.assert_array_equal(found.sets[name], same.frequency)
        assert error == pytest.approx(same.bounds.median_error(), rel=1e-6)


def test_frequencies_are_chosen_among_those_given(noisy_strip):
    given = np.array([1e3, 1.01e3, 5e4, 6e4])
    touch = chosen_touch(noisy_strip.parts.skin, noisy_strip.press)
    found = design(noisy_strip.parts, 3, (1e2, 1e5), touch, among=given)
    assert np.isin(found.best, given).all() and len(set(found.best)) == 3
    with pytest.raises(InputError, match="from 1 to 4, the number of candidate frequencies, got 5"):
        design(noisy_strip.parts, 5, (1e2, 1e5), touch, among=given)


@pytest.mark.parametrize("n", [2, 10, 39, 40])
def test_any_number_of_frequencies_fits_on_its_grid(n):
    excludes = too_near(np.geomspace(1e3, 2e3, 40), n)
    found = best_choice(lambda choices: choices.sum(axis=1), 40, n, excludes=excludes)
    assert len(set(found.tolist())) == n
    assert not excludes[np.ix_(found, found)][np.triu_indices(n, 1)].any()


@pytest.mark.parametrize("text", ["0,1e3", "many", "1e3,inf", "", "-5"])
def test_an_invalid_list_of_frequencies_is_refused(noisy_strip, text):
    with pytest.raises(InputError, match="--among must be `scene` or F,F"):
        frequencies_among(text, noisy_strip.parts.setup)


@pytest.mark.parametrize(("n", "grid"), [(0, 10), (11, 10), (3, 1)])
def test_numbers_out_of_range_are_refused(noisy_strip, n, grid):
    with pytest.raises(InputError, match="must be from"):
        design(
            noisy_strip.parts,
            n,
            (1e2, 1e5),
            chosen_touch(noisy_strip.parts.skin, noisy_strip.press),
            grid=grid,
        )
