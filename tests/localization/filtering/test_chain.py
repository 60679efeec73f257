"""The forward pass against every path that there is, and chains that balance as they should."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from rcskin.localization.filtering.chain import Belief, Cut, Evidence, TouchDynamics
from rcskin.localization.filtering.follower import chain_of_classes, chain_of_places
from rcskin.simulator.sweeps import InputError
from scipy.linalg import expm

PITCH = (0.06, 0.04)
"""m, of rows and of columns."""
TOUCHING = TouchDynamics(lasts=2.0, every=5.0, speed=20.0)
TARGETS = {
    "column": [0, 1, 2, 3],
    "touches": [0, 1, 2],
    "pixel": ["0,0", "1,1", "1,2", "2,1", "2,3"],
    "pair": ["0,0", "1,1", "1,2", "2,1", "1,1+1,2", "1,1+2,1", "1,2+2,1"],
}


@pytest.fixture(params=TARGETS)
def chain(request):
    return chain_of_classes(request.param, TARGETS[request.param], PITCH, TOUCHING)


def rates(chain):
    found = chain.flows / chain.stationary[:, None]
    np.fill_diagonal(found, 0.0)
    return found - np.diag(found.sum(axis=1))


def transitions(chain, seconds):
    """By SciPy's exponential, not by modes."""
    return expm(rates(chain) * seconds)


def evidence(random, states, cuts):
    """Of readings that tell much, little and nothing."""
    told = [random.normal(0, 3, (2, states)) for _ in range(cuts)]
    return Evidence(random.normal(0, 3, states), tuple(Cut(*each) for each in told))


def within(chain, seen, seconds):
    """Chance of a state after a sweep and of its readings, by the state before; (before, after)."""
    stay = np.diag(np.exp(np.diag(rates(chain)) * seconds))
    change = transitions(chain, seconds) - stay
    whole = np.exp(seen.whole)
    at_cuts = sum(np.exp(cut.before[:, None] + cut.after) for cut in seen.cuts)
    ends = (whole[:, None] + whole) / 2
    return stay * whole + change * (ends + at_cuts) / (len(seen.cuts) + 1)


@pytest.mark.parametrize("cuts", [0, 1, 3])
def test_the_forward_pass_is_the_sum_over_all_paths(cuts):
    random = np.random.default_rng(cuts)
    chain = chain_of_classes("column", [0, 1, 2], PITCH, TOUCHING)
    states, spans = len(chain.stationary), [(0.0, 0.4), (0.3, 0.5), (1.0, 0.2)]
    seen = [evidence(random, states, cuts) for _ in spans]
    belief = chain.start()
    for (gap, during), each in zip(spans, seen, strict=True):
        belief = chain.updated(chain.after(belief, gap), each, during)
    sums = np.zeros(states)
    sweeps = [within(chain, each, during) for (_, during), each in zip(spans, seen, strict=True)]
    between = [transitions(chain, gap) for gap, _ in spans]
    for path in itertools.product(range(states), repeat=6):
        weight = chain.stationary[path[0]]
        for k in range(3):
            weight = weight * sweeps[k][path[2 * k], path[2 * k + 1]]
            if k < 2:
                weight = weight * between[k + 1][path[2 * k + 1], path[2 * k + 2]]
        sums[path[5]] += weight
    np.testing.assert_allclose(belief.states, sums / sums.sum(), rtol=1e-9)


@pytest.mark.parametrize("kinds", [None, [0, 1, 1, 2]])
def test_the_chance_of_a_change_is_summed_over_paths_to_states_of_another_kind(kinds):
    random = np.random.default_rng(7)
    chain = chain_of_classes("column", [0, 1, 2], PITCH, TOUCHING)
    chain = replace(chain, kinds=None if kinds is None else np.array(kinds))
    belief, seen = Belief(random.dirichlet(np.ones(4))), evidence(random, 4, 3)
    paths = belief.states[:, None] * within(chain, seen, 0.4)
    change = transitions(chain, 0.4) - np.diag(np.exp(np.diag(rates(chain)) * 0.4))
    at_cuts = sum(np.exp(cut.before[:, None] + cut.after) for cut in seen.cuts) / 4
    among = np.ones((4, 4), dtype=bool)
    if kinds:
        among[1:3, 1:3] = False
    changing = belief.states[:, None] * change * at_cuts * among
    found = chain.updated(belief, seen, 0.4).changed
    assert found == pytest.approx(changing.sum() / paths.sum(), rel=1e-9)


def test_modes_move_as_the_exponential_of_the_rates(chain):
    start = np.random.default_rng(0).dirichlet(np.ones(len(chain.stationary)))
    for seconds in (0.01, 0.4, 7.0):
        np.testing.assert_allclose(
            chain.propagated(start, seconds),
            start @ transitions(chain, seconds),
            rtol=1e-9,
            atol=1e-12,
        )


def test_touches_last_and_come_as_stated(chain):
    leaving = rates(chain)
    np.testing.assert_allclose(chain.stationary @ leaving, 0, atol=1e-12)
    coming = leaving[0, 1:-1].sum()
    assert coming == pytest.approx((1 / 5.0), rel=1e-9)
    assert leaving[1, 0] == pytest.approx(1 / 2.0)


def test_touches_move_to_neighbours_alone_and_as_fast_as_stated():
    leaving = rates(chain_of_classes("column", TARGETS["column"], PITCH, TOUCHING))
    assert leaving[1, 3] == 0
    assert leaving[2, 1] == leaving[2, 3] == pytest.approx(20.0 / 40.0 / 2)


def test_places_are_wandered_over_as_far_as_stated():
    """A touch of 20 mm/s wanders over 20 mm in a second, whatever the cells."""
    for cells in (20, 30):
        width = 240.0 / cells
        one = TouchDynamics(lasts=1e9, every=1e9, speed=20.0)
        places = chain_of_places(cells, cells, (width, width), one, knows_unpressed=True)
        middle = np.zeros(len(places.stationary))
        middle[1 + cells // 2 * cells + cells // 2] = 1.0
        later = places.propagated(middle, 1.0)[1:-1].reshape(cells, cells)
        at = width * (np.arange(cells) - cells // 2)
        spread = (later * (at[:, None] ** 2 + at**2)).sum()
        assert spread == pytest.approx(20.0**2 if width < 20 else 20.0 * width, rel=0.02)


def test_a_change_in_mid_sweep_is_noticed_and_evidence_of_nothing_changes_little():
    chain = chain_of_classes("column", TARGETS["column"], PITCH, TOUCHING)
    one, other, far = np.array([0, -50.0, -50, -50, -50]), np.full(5, -50.0), np.full(5, -60.0)
    other[2] = 0.0
    resting = Belief(np.array([0.99, 0.0025, 0.0025, 0.0025, 0.0025]))
    midway = chain.updated(resting, Evidence(far, (Cut(one, other),)), 0.4)
    assert midway.changed > 0.99 and midway.states.argmax() == 2
    steady = chain.updated(resting, Evidence(one, (Cut(one, one),)), 0.4)
    assert steady.changed < 0.01 and steady.states.argmax() == 0
    blind = chain.updated(resting, Evidence(np.zeros(5)), 0.4)
    np.testing.assert_allclose(blind.states, chain.after(resting, 0.4).states, rtol=1e-9)


def test_chains_of_models_that_know_no_rest_lead_everywhere():
    chain = chain_of_classes("column", [1, 2, 3], PITCH, TOUCHING)
    assert (transitions(chain, 1.0) > 0).all()


@pytest.mark.parametrize("name", ["lasts", "every", "speed"])
def test_times_and_speeds_are_above_zero(name):
    with pytest.raises(InputError, match=f"`touch-{name}` must be above 0, got 0"):
        TouchDynamics(**{name: 0.0})
