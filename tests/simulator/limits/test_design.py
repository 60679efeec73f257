"""The best frequencies: exchange against every choice there is, and the sets it is held against."""

import itertools

import numpy as np
import pytest
from rcskin.simulator.bounds.exchange import best_choice
from rcskin.simulator.bounds.fields import Fields
from rcskin.simulator.bounds.position import chosen_touch, places_on, position_slopes
from rcskin.simulator.bounds.sets import LOGARITHMIC, chosen_band, equation_6, logarithmic
from rcskin.simulator.limits.criteria import identity_criterion, position_criterion
from rcskin.simulator.limits.design import design
from rcskin.simulator.scene.files import load_scene
from rcskin.simulator.sweeps import InputError


@pytest.fixture(scope="module")
def strip(noisy):
    return noisy(
        accuracy=True,
        length=0.1,
        width=0.02,
        columns=4,
        frequencies=np.geomspace(1e2, 1e5, 9).tolist(),
    )


@pytest.mark.parametrize("repeats", [False, True])
@pytest.mark.parametrize("target", ["position", "column"])
def test_exchange_finds_the_best_of_all_choices(strip, target, repeats):
    fields, f = Fields(strip, 1e5), strip.frequencies
    if target == "position":
        touch = chosen_touch(strip)
        places = places_on(strip, touch, fields.cells)
        criterion = position_criterion(position_slopes(fields, places, touch, f))
    else:
        criterion = identity_criterion(fields, target, f)
    every = itertools.combinations_with_replacement if repeats else itertools.combinations
    choices = np.array(list(every(range(len(f)), 3)))
    scores = criterion.score(choices)
    found = best_choice(criterion.score, len(f), 3, [np.array([0, 4, 8])], repeats=repeats)
    assert criterion.score(found[None])[0] == pytest.approx(scores.min(), rel=1e-9)
    np.testing.assert_array_equal(found, choices[scores.argmin()])


def test_the_best_set_is_no_worse_than_the_others_and_always_the_same(strip):
    found, again = (design(strip, 4, (1e2, 1e5), chosen_touch(strip), grid=12) for _ in range(2))
    assert min(found.figures.values()) == found.figures["optimal"]
    assert all(found.ratio(name) >= 1 for name in found.sets)
    np.testing.assert_array_equal(found.best, again.best)
    assert len(set(found.best)) == 4 and len(found.sets[LOGARITHMIC]) == 4


def test_equation_6_gives_the_papers_frequencies():
    for n, paper in ((3, [707, 1592, 6367]), (5, [707, 1105, 1965, 4421, 17685])):
        np.testing.assert_allclose(equation_6(load_scene("strip-1x5"), n), paper, atol=1)


def test_one_frequency_by_even_spacing_is_the_middle_of_the_band():
    assert logarithmic((1e2, 1e4), 1).tolist() == [1000.0]
    np.testing.assert_allclose(logarithmic((1e2, 1e4), 3), [100, 1000, 10000])


def test_an_end_of_a_band_that_is_absent_is_the_scenes(strip):
    low, high = strip.frequencies[[0, -1]]
    middle = float(low + high) / 2
    assert chosen_band(f"{middle!r}:", strip) == (middle, high)
    assert chosen_band(f":{middle!r}", strip) == (low, middle)
    assert chosen_band(None, strip) == chosen_band(":", strip) == (low, high)


@pytest.mark.parametrize("text", ["1e3", "2e3:1e3", "0:1e3", "a:b", "1e3:nan"])
def test_a_band_that_is_none_is_refused(strip, text):
    with pytest.raises(InputError, match="--band must be LOW:HIGH"):
        chosen_band(text, strip)


@pytest.mark.parametrize(("n", "grid"), [(0, 10), (11, 10), (3, 1)])
def test_numbers_out_of_range_are_refused(strip, n, grid):
    with pytest.raises(InputError, match="must be from"):
        design(strip, n, (1e2, 1e5), chosen_touch(strip), grid=grid)
