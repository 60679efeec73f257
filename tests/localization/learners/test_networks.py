"""Networks that learn many sweeps in ever smaller steps.

What tuning may choose from.
"""

import _thread
import threading
from dataclasses import replace
from inspect import signature

import numpy as np
import pytest
from rcskin.localization.inputs.samples import LocalizationProblem, Samples
from rcskin.localization.learners import networks
from rcskin.localization.learners.classifiers import reference
from rcskin.localization.learners.networks import SHORT_STAGES, STAGES, fitted_layers
from rcskin.localization.learners.registry import learners
from rcskin.localization.model.localizer_file import load, save
from rcskin.localization.model.training import train
from rcskin.localization.parts.parts import LogProbabilities
from rcskin.localization.parts.predictor import MIN_PROBABILITY
from rcskin.localization.trust.folds import (
    PLENTY,
    describe_splits,
    held_out_indices,
    scoring_splits,
    splits_of,
)
from rcskin.localization.trust.tuning import trainer
from rcskin.simulator.scene.scene_files import load_scene, scene_text
from rcskin.simulator.sweeps import concatenate

OF_COLUMNS = ((2e-3, 4000), (5e-4, 1000))
OF_POSITIONS = ((2e-3, 400), (5e-4, 100))
SCENE = scene_text(load_scene("strip-1x3").with_({"skin.length": 0.06, "pixels.columns": 6}))
SEEN = ("dlnZ", "dphase", "lnZ0", "phase0")


@pytest.fixture(scope="module")
def mountings(make_sweeps):
    parts = [make_sweeps(1, 6, 4, noise=0.006, rests=3, session=k, seed=k) for k in range(8)]
    return concatenate(parts).assign_attrs(scene=SCENE)


@pytest.mark.parametrize("target", [pytest.param("column", marks=pytest.mark.slow), "position"])
def test_a_network_finds_sweeps_never_seen_and_is_the_same_from_its_file(
    mountings, make_sweeps, tmp_path, monkeypatch, target
):
    small = ((64, 64), OF_COLUMNS) if target == "column" else ((64,), OF_POSITIONS)
    for name, each in zip(("HIDDEN", "STAGES"), small, strict=True):
        monkeypatch.setattr(networks, name, each)
    model = train(mountings, target, "network", quantities=SEEN)
    unseen = make_sweeps(1, 6, 8, noise=0.006, rests=3, session=9, seed=13).assign_attrs(
        scene=SCENE
    )
    samples = model.samples(unseen)
    answers = model.predictor.predict(samples.X)
    if target == "column":
        assert (answers == samples.y).mean() > 0.85
    else:
        assert np.median(np.abs(answers - samples.y)[:, 0]) < 5
    save(tmp_path / "n.npz", model)
    again = load(tmp_path / "n.npz").predictor.predict(samples.X)
    np.testing.assert_array_equal(again, answers)


def test_the_same_seed_gives_the_same_network_and_smaller_steps_fit_better():
    random = np.random.default_rng(0)
    X = random.standard_normal((2000, 3))
    y = np.sin(2 * X[:, 0]) * X[:, 1]
    coarse, fine, again = (
        fitted_layers(np.float32(X), y, stages, (32,))(X)[:, 0]
        for stages in (((0.2, 300),), ((0.2, 300), (1e-3, 300)), ((0.2, 300), (1e-3, 300)))
    )
    assert np.var(fine - y) < 0.8 * np.var(coarse - y)
    np.testing.assert_array_equal(fine, again)


@pytest.mark.parametrize("classify", [True, False])
def test_however_many_batches_are_handed_over_the_network_is_the_same(monkeypatch, classify):
    random = np.random.default_rng(0)
    X = np.float32(random.standard_normal((1234, 3)))
    y = np.sign(X[:, 0] * X[:, 1]).astype(int)
    told = []
    for batches in (1, 3, 1000):
        monkeypatch.setattr(networks, "BATCHES_AT_ONCE", batches)
        stages = ((1e-2, 30), (1e-3, 10))
        layers = fitted_layers(X, y, stages, (8,), classify=classify).layers
        told.append([each.weights for each in layers])
    for one, two, three in zip(*told, strict=True):
        np.testing.assert_array_equal(one, two)
        np.testing.assert_array_equal(one, three)


def test_every_sweep_is_in_as_many_batches_but_for_one():
    for size, batch, steps in ((1234, 500, 7), (40, 40, 5), (2501, 500, 2)):
        rows = np.concatenate([*networks._drawn(np.random.default_rng(0), size, batch, steps)])
        seen = np.bincount(rows, minlength=size)
        assert seen.min() >= 1 and np.ptp(seen) <= 1
        assert rows.size % batch == 0 and rows.size >= steps * batch


def test_sweeps_in_plenty_are_held_out_once():
    sessions = np.arange(PLENTY + 500) // 500
    once, few = scoring_splits(None, sessions), scoring_splits(None, sessions[:2000])
    assert len(once) == 1 and describe_splits(once, sessions) == "1 fold, whole sessions held out"
    assert 0.15 < held_out_indices(once).size / sessions.size < 0.25
    np.testing.assert_array_equal(held_out_indices(few), np.arange(2000))
    assert len(few) == len(splits_of(None, sessions[:2000]))


def test_ctrl_c_ends_more_than_a_stage():
    random = np.random.default_rng(0)
    X, y = np.float32(random.standard_normal((40, 3))), np.arange(40) % 2
    interruption = threading.Timer(0.5, _thread.interrupt_main)
    interruption.start()
    with pytest.raises(KeyboardInterrupt):
        fitted_layers(X, y, ((1e-3, 10**9),), (4,), classify=True)


def test_the_smaller_of_two_probabilities_keeps_its_digits():
    X = np.linspace(-1, 1, 200)[:, None]
    layers = fitted_layers(np.float32(X), X[:, 0] > 0, ((1e-2, 300),), (8,), classify=True)
    found = np.exp(LogProbabilities(1e-30)(layers(4 * X)))
    assert 0 < found.min() < MIN_PROBABILITY
    odds = np.log(found[:, 1] / found[:, 0])
    assert (np.diff(odds) >= 0).all() and np.unique(odds).size > 150


AGAINST_REST = "dlnZ", "dphase", "lnZ0", "phase0"


def asked(target):
    return LocalizationProblem(target, 8, AGAINST_REST, ("left",), (1e3, 1e4), "")


TOLD = [
    (made, target)
    for made in learners().values()
    for target in ("column", "position")
    if target in made.targets
]


@pytest.mark.parametrize(
    ("made", "target"), TOLD, ids=[f"{made.name}-{target}" for made, target in TOLD]
)
def test_whatever_is_tuned_is_a_parameter_of_the_training(made, target):
    taken = {*signature(made.fit).parameters, *signature(reference).parameters}
    assert made.grid_for(asked(target)).keys() <= taken


def test_networks_may_be_tuned_to_a_short_course():
    network = learners()["network"]
    for target in ("column", "position"):
        assert network.grid_for(asked(target)) == {"stages": [STAGES, SHORT_STAGES]}


def test_a_tuned_network_learns_in_the_steps_that_find_more():
    random = np.random.default_rng(0)
    sessions = np.repeat(np.arange(6), 20)
    y = np.tile(np.arange(1, 3), 60)
    X = random.standard_normal((120, 8)) + 3 * y[:, None]
    few, none = ((1e-2, 100),), ((1e-9, 1),)
    made = replace(learners()["network"], grid={"stages": [none, few]})
    samples = Samples(asked("column"), X, y, sessions, np.arange(120))
    tuned, expected = (
        trainer(each, tune=True)(samples).decisions(X)
        for each in (made, replace(made, grid={"stages": [few]}))
    )
    np.testing.assert_array_equal(tuned, expected)
