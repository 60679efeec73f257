"""Known optima of a line, and properties of any search."""

import itertools
import math

import numpy as np
import pytest
from rcskin.simulator.bounds.frequency_sets import equation_6
from rcskin.simulator.bounds.touch_pairs import NEAREST, SAME, nearest
from rcskin.simulator.bounds.touch_readings import hypotheses
from rcskin.simulator.design.evaluator import SceneEvaluator, SearchJournal, SearchSettings
from rcskin.simulator.design.goals import PressedPixels
from rcskin.simulator.design.layout import Material, designed
from rcskin.simulator.design.reading_pool import terminals
from rcskin.simulator.design.search import best_value, search
from rcskin.simulator.measure.experiment import own_presses
from rcskin.simulator.press.batch import PressBatch
from rcskin.simulator.scene.design_goals import Design
from rcskin.tests.simulator.bounds.every_strength import exact

SINGLE = {"frequencies": 1, "readings": 1, "casts": 1, "band": (300.0, 30e3), "sheet_ratio": 1.0}
EVEN = {"sheet_resistance": 1.0, "capacitance": 1.0, "foam_spread": 0.0, "loss_tangent": 0.0}
BARE = {"stray_capacitance": 0.0, "lead_resistance": 0.0}


def asking(draws=100, **asked):
    return SearchSettings(
        Design(**{**SINGLE, **asked}), 1, draws, SearchJournal(None, {}), lambda *_: None
    )


def bench(scene, **asked):
    return SceneEvaluator(scene.parts, asking(**asked), terminals(scene.parts.skin))


def test_the_best_single_frequency_of_a_line_lies_between_those_of_equation_6(strip):
    found = bench(strip(session=EVEN | BARE))
    picked = found.picked(Material(50e3, 50e3), [0], [])
    near, far = equation_6(found.parts.skin, found.parts.setup, 4)[[0, -1]]
    assert min(near, far) < found.frequency[picked.frequencies[0]] < max(near, far)


def test_the_required_number_of_frequencies_is_read(strip):
    """Even those of a scene that has few, in a band that is narrow."""
    found = bench(strip(session=EVEN | BARE), frequencies=60, band=(5e3, 10e3))
    picked = found.picked(Material(50e3, 50e3), [0], [])
    assert len(picked.frequencies) == 60
    few = bench(strip(session=EVEN | BARE), frequencies=20, band=(5e3, 10e3))
    fewer = few.picked(Material(50e3, 50e3), [0], [])
    assert picked.share > fewer.share


def test_twice_the_sheet_resistance_has_the_same_merit_at_half_the_frequencies(strip):
    frequencies = (500.0, 1e3, 2e3, 4e3, 8e3, 16e3)
    clear = {"magnitude_noise": 0.005, "phase_noise": 0.005}
    scene = strip(clear, EVEN | BARE, frequencies=frequencies)
    found = bench(scene, frequencies=3, band=None)
    numbers = [list(found.frequency).index(f) for f in frequencies]
    told = found.share_of(Material(50e3, 50e3), [0], numbers[1:4])
    assert 0.5 < told < 0.99
    assert found.share_of(Material(100e3, 100e3), [0], numbers[:3]) == pytest.approx(told, abs=2e-3)
    assert found.share_of(Material(25e3, 25e3), [0], numbers[2:5]) == pytest.approx(told, abs=2e-3)


def test_a_search_ends_no_worse_than_any_of_its_steps_and_keeps_its_bounds(strip):
    scene = strip()
    asked = asking(frequencies=2, sheet_resistance=(20e3, 100e3), seconds=0.02, casts=3)
    found = search(scene.parts, asked)
    assert found.before.name == "as it is" and found.best.taken
    assert found.best.tenth == max(step.tenth for step in found.steps[1:] if step.taken)
    material = found.best.layout.material
    assert 20e3 <= math.sqrt(material.top * material.bottom) <= 100e3
    assert len(found.best.layout.frequencies) <= 2
    assert found.picked.share <= min(
        found.picked.bound_over_readings, found.picked.bound_over_frequencies
    )
    again = search(scene.parts, asked)
    assert again.steps == found.steps
    made = designed(scene, found.best.layout)
    assert made.frequencies.tolist() == list(found.best.layout.frequencies)


def test_the_exact_bound_of_more_readings_and_frequencies_is_never_less(strip):
    both = {"top-left": {}, "bottom-left": {}, "bottom-right": {}}
    scene = strip(contacts=both, session=EVEN | BARE)
    found = bench(scene, readings=3, draws=4000)
    material = Material(50e3, 50e3)
    shares = []
    for count in (1, 2, 3):
        picked = found.picked(material, [], [3])
        layout = found.layout(material, picked)
        readings = tuple(found.pool[:count])
        shares.append(found.merits(type(layout)(material, readings, (2e3, 8e3)))[0])
    error = 4 * 0.5 / math.sqrt(4000)
    assert all(more > less - error for less, more in itertools.pairwise(shares))


@pytest.mark.parametrize(
    ("bounds", "best"),
    [((1.0, 1000.0), 37), ((100.0, 1000.0), 100), ((1.0, 2.0), 2), ((5.0, 5.0), 5)],
)
def test_the_best_number_is_found_between_the_points_of_its_grid(bounds, best):
    def told(value):
        return -(math.log(value[0] / 37.0) ** 2)

    assert best_value(told, [bounds], np.array([5.0])) == pytest.approx(best, rel=0.03)


def test_the_best_of_three_numbers_that_depend_on_each_other_is_found():
    def told(at):
        return 1 - 0.1 * np.square(np.log(at[0] * at[1] / 60) + [0, 1, -1] * np.log(at[1:2])).sum()

    found = best_value(told, [(1.0, 1000.0), (0.5, 2.0), (1.0, 1.0)], np.array([5.0, 1.5, 1.0]))
    assert found == pytest.approx([60, 1, 1], rel=0.03)


def test_common_draws_and_independent_draws_agree_on_a_lossy_sample(strip):
    scene = strip(session={"lead_resistance": 2e3, "stray_capacitance": 1e-11, "loss_tangent": 0.1})
    trained = bench(scene, band=None)._trained
    judge = PressedPixels(scene.parts, Design(casts=1), 4000, 1)
    own = bench(scene, band=None).own
    on = trained.readout(trained.sample(0), own.material, own.readings)
    told = judge.score(on, scene.frequencies)
    assert 0.3 < told < 0.99
    anew = exact(
        on.likelihood(scene.frequencies, 6),
        hypotheses(scene.parts.skin, scene.parts.plan, "pixel"),
        own_presses(scene.parts.skin, scene.press),
        seed=1,
        draws=4000,
    )
    assert told == pytest.approx(anew.share, abs=4 * math.sqrt(0.5 / 4000))


def test_the_nearest_pairs_are_those_at_the_nearest_strengths():
    random = np.random.default_rng(4)
    count, touches = 14, 2
    middle = 3 * random.standard_normal((count, 2, 3, 2)) + 500
    slopes = random.standard_normal((count, touches, 2, 3, 2))
    middle[3], slopes[3] = middle[8], slopes[8]
    answers = [(k // 2,) for k in range(count)]
    apart = np.full((count, count), np.inf)
    for one, other in itertools.permutations(range(count), 2):
        if answers[one] != answers[other]:
            turned = np.concatenate([slopes[one], -slopes[other]]).reshape(2 * touches, -1)
            rows = np.vstack([turned.T, np.eye(2 * touches)])
            rest = np.concatenate([(middle[one] - middle[other]).ravel(), np.zeros(2 * touches)])
            apart[one, other] = np.linalg.lstsq(rows, rest, rcond=None)[1][0]
    expected = {
        (min(one, int(other)), max(one, int(other)))
        for one in range(count)
        for other in np.argsort(apart[one])[:NEAREST]
        if SAME**2 < apart[one, other] < np.inf
    }
    found = nearest(middle, slopes, answers)
    assert {tuple(each) for each in found.tolist()} == expected
    assert (3, 8) not in expected and found.tolist() == sorted(found.tolist())


def test_a_search_for_pairs_finishes(strip):
    """By shares that more readings never lessen."""
    scene = strip({"magnitude_noise": 4e-3, "phase_noise": 4e-3}, columns=3)
    asked = asking(target="pair", frequencies=2, sheet_resistance=(20e3, 100e3), draws=300)
    found = search(scene.parts, asked)
    assert 0.5 < found.before.tenth < found.best.tenth <= 1


def test_model_and_exact_solution_agree_far_within_the_meters_error(strip):
    from rcskin.simulator.models.solver import Solver
    from rcskin.simulator.press.press import parse_press

    scene = strip()
    found = bench(scene, band=None)
    on = found._trained.readout(None, Material(50e3, 50e3), found.pool)
    batch = PressBatch.of([(np.array([2]), np.array([1.0]))])
    told = on.likelihood(scene.frequencies, 0).observed(batch)[0]
    Z = Solver(scene.parts, 1e-6).solve(parse_press("1,3:2.0", default=2.0)).Z[0]
    exact = np.concatenate([np.log(np.abs(Z)), np.angle(Z)])
    assert np.abs(told - exact).max() < 2e-3
