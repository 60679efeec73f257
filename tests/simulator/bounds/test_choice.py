"""Exchanges compared with all choices."""

import itertools

import numpy as np
import pytest
from rcskin.simulator.bounds import choice
from rcskin.simulator.bounds.full_fields import FullFields
from rcskin.simulator.bounds.position_bound import chosen_touch, place_likelihood, places_on
from rcskin.simulator.limits.frequency_design import identity_criterion, position_criterion


@pytest.mark.parametrize("repeats", [False, True])
@pytest.mark.parametrize("target", ["position", "column"])
def test_exchange_finds_the_best_of_all_choices(noisy_strip, target, repeats, monkeypatch):
    fields, f = FullFields(noisy_strip.parts, 1e5), noisy_strip.frequencies
    if target == "position":
        touch = chosen_touch(noisy_strip.parts.skin, noisy_strip.press)
        places = places_on(noisy_strip.parts.skin, touch, fields.cells)
        criterion = position_criterion(place_likelihood(fields, places, touch, f))
    else:
        criterion = identity_criterion(fields, target, f)
    every = itertools.combinations_with_replacement if repeats else itertools.combinations
    choices = np.array(list(every(range(len(f)), 3)))
    scores = criterion.score(choices)
    excludes = np.eye(len(f), dtype=bool) & (not repeats)
    for most in (choice.MAX_EXHAUSTIVE, 0):
        monkeypatch.setattr(choice, "MAX_EXHAUSTIVE", most)
        found = choice.best_choice(criterion.score, len(f), 3, [np.array([0, 4, 8])], excludes)
        assert criterion.score(found[None])[0] == pytest.approx(scores.min(), rel=1e-9)
        np.testing.assert_array_equal(found, choices[scores.argmin()])
