"""Trained models as a whole: probabilities, refusals, positions, estimators by name.

What a skin drifts by since the rest before is no novelty to who allows for it.
"""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from rcskin.localization.evaluation.evaluation import nested
from rcskin.localization.inputs.samples import LocalizationProblem, Samples, samples_of
from rcskin.localization.inversion.estimators import chosen, estimators
from rcskin.localization.model.localizer_file import load, save
from rcskin.localization.model.training import train
from rcskin.localization.trust.answers import CANNOT_TELL
from rcskin.localization.trust.fitting import learn_classes
from rcskin.localization.trust.folds import splits_of
from rcskin.localization.trust.temperature import calibration_error, probabilities
from rcskin.simulator.scene.scene_files import load_scene, scene_text
from rcskin.simulator.sweeps import InputError, concatenate

SCENE = scene_text(load_scene("strip-1x3").with_({"skin.length": 0.06, "pixels.columns": 6}))
AGAINST_REST = ("dlnZ", "dphase")


@pytest.fixture(scope="module")
def mountings(make_sweeps):
    """A strip of six pixels with errors, on four mountings: 58 sweeps each, 10 unpressed."""
    parts = [make_sweeps(1, 6, 8, noise=0.006, rests=3, session=k, seed=k) for k in range(4)]
    return concatenate(parts).assign_attrs(scene=SCENE)


@pytest.fixture(scope="module")
def columns(mountings):
    return train(mountings, quantities=AGAINST_REST, certain=0.95)


def test_probabilities_of_sweeps_never_seen_are_honest(columns, make_sweeps):
    unseen = concatenate([make_sweeps(1, 6, 8, noise=0.006, session=9, seed=k) for k in (9, 10)])
    samples = columns.samples(unseen)
    classes, told = columns.probabilities(unseen)
    told = told[samples.rows]
    right = classes[told.argmax(axis=1)] == samples.y
    raw = probabilities(columns.predictor.decisions(samples.X), 1.0).max(axis=1)
    honest = calibration_error(told.max(axis=1), right)
    assert honest < 0.08 < calibration_error(raw, right)


def test_answers_are_right_more_often_than_guesses(make_sweeps):
    noisy = [make_sweeps(1, 6, 20, noise=0.04, rests=3, session=k, seed=k) for k in range(5)]
    model = train(concatenate(noisy[:4]), quantities=AGAINST_REST, certain=0.9)
    unseen = noisy[4]
    told = model.answers(unseen)
    samples = model.samples(unseen)
    guesses = model.predictor.predict(samples.X).astype(str)
    told, truth = told.labels[samples.rows], samples.y.astype(str)
    answered = told != CANNOT_TELL
    assert 0.3 < answered.mean() < 0.95
    assert (told == truth)[answered].mean() > 0.87 > 0.85 > (guesses == truth).mean()


def test_a_sweep_unlike_the_training_has_no_answer(columns, make_sweeps):
    unseen = make_sweeps(1, 6, 2, noise=0.006, session=9, seed=12)
    broken = unseen.copy(deep=True)
    broken["Rs"] = broken["Rs"] * xr_ramp(unseen)
    pressed = unseen["column"].values > 0
    told = columns.answers(broken, rest=unseen.isel(sweep=~pressed))
    assert told.novel.all() and (told.labels == CANNOT_TELL).all()


def xr_ramp(sweeps):
    """From 1 to 4 over the frequencies."""
    return 1 + 3 * (sweeps["frequency"] / sweeps["frequency"].max())


def test_nothing_pressed_is_known_only_where_it_was_shown(columns, strip):
    assert columns.knows_unpressed
    assert not train(strip.isel(sweep=strip["column"].values > 0)).knows_unpressed


def test_positions_are_found_with_deviations_that_hold(mountings, make_sweeps, tmp_path):
    model = train(mountings, "position", "kernel-ridge", quantities=AGAINST_REST)
    unseen = make_sweeps(1, 6, 8, noise=0.006, session=9, seed=13).assign_attrs(scene=SCENE)
    samples = model.samples(unseen)
    told, deviation = model.positions(unseen)
    away = np.abs(told - [0, 10, 0])[samples.rows]
    error = np.abs(told[samples.rows] - samples.y)
    assert np.median(error[:, 0]) < 5
    assert away[:, 1].max() < 1e-6
    inside = error[:, 0] < 2 * deviation[samples.rows][:, 0]
    assert 0.85 < inside.mean() <= 1
    rest = model.answers(unseen).labels[unseen["column"].values == 0]
    assert rest[0] == CANNOT_TELL and set(rest[1:]) == {"0"}
    save(tmp_path / "p.npz", model)
    np.testing.assert_array_equal(load(tmp_path / "p.npz").positions(unseen)[1], deviation)


def test_a_model_takes_its_interfaces_of_sweeps_that_have_more(sheet):
    left = sheet.isel(interface=[0])
    model = train(sheet, interfaces=["left"], quantities=("Rs", "Cp"))
    np.testing.assert_array_equal(model.predict(sheet), model.predict(left))


def test_sessions_are_held_out_as_a_whole_where_there_are_two(mountings):
    samples = samples_of(mountings, "column", AGAINST_REST)
    for kept, tested in splits_of(samples.strata, samples.sessions):
        assert not set(samples.sessions[kept]) & set(samples.sessions[tested])
    some = samples.part(np.flatnonzero(samples.sessions < 1))
    kept, tested = splits_of(some.strata, some.sessions)[0]
    assert set(some.sessions[kept]) & set(some.sessions[tested])


@pytest.mark.parametrize("tune", [False, True])
def test_nested_scores_count_every_sweep_once(mountings, tune):
    samples = samples_of(mountings, "column", AGAINST_REST)
    found = nested(samples, chosen("ksvm-ovo", "column"), tune=tune, folds=2)
    assert found.whole.confusion.total == len(samples.X)
    mean, spread = found.figures()["right of all"]
    assert 0.6 < mean <= 1 and spread >= 0


def test_shuffled_labels_are_found_by_chance_alone(mountings):
    shuffled = samples_of(mountings, "column", AGAINST_REST)
    order = np.random.default_rng(0).permutation(len(shuffled.y))
    shuffled = replace(shuffled, y=shuffled.y[order])
    found = nested(shuffled, chosen("ksvm-components", "column"), tune=True, folds=2)
    assert found.figures()["right of all"][0] < 0.35


def test_every_estimator_is_asked_by_its_name():
    for name, estimator in estimators().items():
        for target in estimator.targets:
            assert chosen(name, target) is not None


@pytest.mark.parametrize(
    ("name", "target", "message"),
    [
        ("mlp", "column", "one of ksvm-ovo, .* for `target` column, got 'mlp'"),
        ("ksvm-ovo", "position", "one of kernel-ridge, .*got 'ksvm-ovo'"),
        ("knn", "column", "`estimator` knn was removed, .*: use ksvm-components$"),
        ("gaussian-process", "position", "gaussian-process was removed, .*: use kernel-ridge$"),
        (None, "depth", "`target` must be one of column, row"),
    ],
)
def test_a_name_that_does_not_give_the_target_is_refused(name, target, message):
    with pytest.raises(InputError, match=message):
        chosen(name, target)


@pytest.mark.parametrize(("target", "fits"), [("column", 6), ("position", 6)])
def test_progress_is_reported_fit_by_fit(strip, target, fits):
    heard = []
    scene = scene_text(load_scene("strip-1x3"))
    model = train(
        strip.assign_attrs(scene=scene),
        target,
        quantities=("dlnZ",),
        progress=lambda *told: heard.append(told),
    )
    assert heard == [(f"training {model.estimator}", done, fits) for done in range(fits + 1)]


QUANTITIES = ("dlnZ", "dphase", "lnZ0", "phase0")
FREQUENCIES = (1e3, 1e4)
PROBLEM = LocalizationProblem("column", 8, QUANTITIES, ("left",), FREQUENCIES, "")
SESSIONS, COUNT, NOISE, DRIFT = 300, 4, 1e-3, 0.015
TOUCHES = 0.02 * np.array([[1, 0, 1, 0], [1, 1, 0, 0], [0, 1, 0, 1]])


def samples(seed, drift=0.0):
    """Three columns on skins that differ by half, each pressed after it has drifted."""
    random = np.random.default_rng(seed)
    skins = 0.5 * random.standard_normal((SESSIONS, 4))
    session = np.repeat(np.arange(SESSIONS), COUNT)
    column = random.integers(1, 4, len(session))
    change = TOUCHES[column - 1] * random.normal(1, 0.1, (len(session), 1))
    moved = 0.5 * drift * random.standard_normal((len(session), 4))
    noise = NOISE * random.standard_normal((len(session), 4))
    X = np.hstack([change + moved + noise, skins[session]])
    return Samples(PROBLEM, X, column.astype(str), session, np.arange(len(session)))


def quick_network():
    """The network with fewer steps."""
    network = chosen("network", "column")
    return replace(network, fit=partial(network.fit, stages=((2e-3, 150), (2e-4, 50))))


@pytest.fixture(
    scope="module", params=["gaussian", pytest.param("network", marks=pytest.mark.slow)]
)
def learned(request):
    allowing = {"gaussian": chosen("gaussian", "column"), "network": quick_network()}
    return learn_classes(samples(1), allowing[request.param])


def test_sweeps_of_skins_that_drift_are_answered(learned):
    drifted = samples(2, DRIFT)
    assert learned.novel(drifted.X).mean() < 0.05
    assert (learned.answers(drifted.X).labels == drifted.y).mean() > 0.9


def test_what_no_drift_explains_is_a_novelty(learned):
    broken = samples(3).X
    broken[:, :4] += 0.1
    assert learned.novel(broken).mean() > 0.95
