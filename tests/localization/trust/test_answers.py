"""Probabilities and thresholds.

Rates are told with what they are of, and with what they say at least. Faults by name: a model
trained with them names what it refuses, hardly ever a healthy skin.
"""

import numpy as np
import pytest
from rcskin.hardware.live.live_localizer import LiveLocalizer
from rcskin.localization.commands.localize import _table
from rcskin.localization.evaluation.fault_scores import fault_lines, fault_scores
from rcskin.localization.evaluation.result import evaluated
from rcskin.localization.inputs.samples import draw_stratified
from rcskin.localization.model.localizer_file import load, save
from rcskin.localization.model.training import train
from rcskin.localization.trust.answers import (
    BOUNDING_SESSIONS,
    CANNOT_TELL,
    CONFIDENCE,
    CountedRate,
    decide,
    independent_sweeps,
    lower_bound,
    threshold_of,
)
from rcskin.localization.trust.diagnosis import NO_FAULT, without_answer
from rcskin.localization.trust.temperature import calibration_error, probabilities, sharpness_of
from rcskin.simulator.dataset.dataset_plan import DatasetPlan
from rcskin.simulator.dataset.memory_dataset import in_memory
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import InputError
from scipy.stats import binomtest


@pytest.fixture
def overconfident():
    """Decisions four times too sharp for how often they are right, and the true classes."""
    random = np.random.default_rng(0)
    honest = 2.5 * random.standard_normal((4000, 5))
    chance = probabilities(honest, 1.0).cumsum(axis=1)
    index = (random.random((4000, 1)) > chance).sum(axis=1).clip(max=4)
    return 4 * honest, index


def test_probabilities_become_honest(overconfident):
    decisions, index = overconfident
    half = slice(2000), slice(2000, None)
    sharpness = sharpness_of(decisions[half[0]], index[half[0]])
    assert sharpness == pytest.approx(0.25, rel=0.1)
    right = decisions[half[1]].argmax(axis=1) == index[half[1]]
    raw, honest = (
        calibration_error(probabilities(decisions[half[1]], each).max(axis=1), right)
        for each in (1.0, sharpness)
    )
    assert honest < 0.03 < 0.2 < raw


def test_answers_above_the_threshold_are_right_at_the_rate_asked(overconfident):
    decisions, index = overconfident
    p = probabilities(decisions, 0.25)
    right = p.argmax(axis=1) == index
    threshold = threshold_of(p.max(axis=1)[:2000], right[:2000], 0.9)
    told = p.max(axis=1)[2000:] >= threshold
    assert 0.05 < told.mean() < 0.9
    assert right[2000:][told].mean() > 0.87 > right.mean()


@pytest.mark.parametrize(
    ("certain", "message"), [(1.0, "between 0 and 1"), (0.99, "cannot be reached")]
)
def test_a_rate_that_cannot_be_kept_is_refused(certain, message):
    with pytest.raises(InputError, match=message):
        threshold_of(np.linspace(0.5, 0.6, 10), np.arange(10) % 2 == 0, certain)


def test_no_answer_where_it_is_improbable_or_novel():
    p = np.array([[0.9, 0.1], [0.6, 0.4], [0.1, 0.9]])
    told = decide(np.array(["1,1", "1,2"]), p, np.array([False, False, True]), 0.8)
    assert told.labels.tolist() == ["1,1", CANNOT_TELL, CANNOT_TELL]
    assert told.probability.tolist() == [0.9, 0.6, 0.9]


def test_a_rate_asked_is_kept_with_confidence_not_by_luck():
    """A classifier that is right at 94.5 % wherever it is asked must not be said to keep 95 %."""
    random, lucky = np.random.default_rng(2), 0
    for _ in range(60):
        p, right = random.random(300), random.random(300) < 0.945
        try:
            threshold_of(p, right, 0.95)
            lucky += 1
        except InputError:
            pass
    assert lucky <= 5


def test_sweeps_are_thinned_in_like_shares_whatever_their_order():
    """52 000 sweeps of 26 classes in turn, of which evenly spaced ones miss one."""
    groups = np.arange(5200) % 26
    kept = draw_stratified(groups, 2000)
    counts = np.bincount(groups[kept], minlength=26)
    assert kept.size == 2000 and np.ptp(counts) <= 1
    np.testing.assert_array_equal(kept, draw_stratified(groups, 2000))
    assert 5200 in draw_stratified(np.append(groups, 99), 2000)


@pytest.mark.parametrize(
    ("right", "total", "told"),
    [
        (53, 53, "100 % (53 of 53, at least 94 % with 95 % confidence)"),
        (0, 10, "0 % (0 of 10, at least 0 % with 95 % confidence)"),
        (9999, 10000, "99.9 % (9999 of 10000, at least 99.9 % with 95 % confidence)"),
        (0, 0, "none of 0"),
    ],
)
def test_it_is_said_of_how_many(right, total, told):
    assert CountedRate.of(np.arange(total) < right, np.arange(total)).text == told


@pytest.mark.parametrize("sessions", range(1, BOUNDING_SESSIONS))
def test_few_sessions_bound_nothing(sessions):
    rate = CountedRate.of(np.ones(50, dtype=bool), np.arange(50) % sessions)
    assert (rate.text, rate.interval) == ("100 % (50 of 50)", (1.0, 1.0))


@pytest.mark.parametrize("rate", [0.5, 0.9, 0.99])
def test_the_bound_of_independent_sweeps_is_the_exact_one(rate):
    found = np.random.default_rng(0).binomial(60, rate, 1500)
    counts, times = np.unique(found, return_counts=True)
    kept = sum(n for k, n in zip(counts, times, strict=True) if lower_bound(int(k), 60) <= rate)
    assert kept / found.size > CONFIDENCE - 0.015
    exact = binomtest(int(counts[0]), 60, alternative="greater").proportion_ci(0.95, "exact").low
    assert lower_bound(int(counts[0]), 60) == pytest.approx(exact)


@pytest.mark.parametrize("count", [BOUNDING_SESSIONS, 10, 40])
@pytest.mark.parametrize("correlation", [0.0, 0.05, 0.1])
def test_the_bound_holds_in_other_sessions(count, correlation):
    """Rates of sessions are distributed as beta about 95 %; a session has 25 sweeps."""
    rate, each, random = 0.95, 25, np.random.default_rng(count)
    spread = 1 / correlation - 1 if correlation else np.inf
    sessions, kept, trials = np.repeat(np.arange(count), each), 0, 400
    for _ in range(trials):
        own = random.beta(rate * spread, (1 - rate) * spread, count) if correlation else rate
        true = random.random((each, count)) < own
        kept += CountedRate.of(true.T.ravel(), sessions).at_least() <= rate
    assert kept / trials > CONFIDENCE - 0.02


def test_sweeps_that_are_sessions_of_their_own_are_independent():
    true = np.random.default_rng(1).random(300) < 0.9
    assert independent_sweeps(true, np.arange(300)) == pytest.approx(300, rel=0.01)


ODDS = {"dead_foil": 0.15, "stuck_spot": 0.1, "aged_gain": 0.25}


@pytest.fixture(scope="module")
def sweeps():
    scene = load_scene("strip-1x3").with_(
        {
            "dataset.session.sweeps_per_session": 40,
            "dataset.session.rest_every": 8,
            "dataset.session.faults": {**ODDS, "gain_factor": {"low": 0.7, "high": 0.8}},
        }
    )
    return in_memory(DatasetPlan(scene.parts, 3200, 1, 1e-2))


@pytest.fixture(scope="module")
def parts(sweeps):
    """Sweeps to train on, and others."""
    return [sweeps.isel(sweep=own) for own in (sweeps["session"] < 55, sweeps["session"] >= 55)]


@pytest.fixture(scope="module", params=["Rs,Cp", "dlnZ,dphase"])
def model(request, parts, tmp_path_factory):
    """A trained model, as it is read from its file."""
    path = tmp_path_factory.mktemp("model") / "m.npz"
    save(path, train(parts[0], "column", quantities=request.param))
    return load(path)


def test_dead_foils_are_refused_and_named_and_healthy_skins_are_not(model, parts):
    samples, answers = model.samples(parts[1]), model.answers(parts[1])
    score = evaluated(model.learned, samples, answers).score
    named = model.faults(parts[1], answers)
    found = fault_scores(parts[1], answers, named, samples, score)
    scores = {each.kind: each for each in found}
    assert scores.keys() == {NO_FAULT, *(name.replace("_", " ") for name in ODDS)}
    dead, healthy = scores["dead foil"], scores[NO_FAULT]
    assert dead.named_right > 0.9 and dead.answered < 0.1
    assert healthy.named_wrong < 0.02 and healthy.answered > 0.9
    lines = fault_lines([*scores.values()], classes=True)
    assert len(lines) == 4 and all("named" in line for line in lines)


def test_only_sweeps_without_an_answer_have_a_fault(model, parts):
    answers = model.answers(parts[1])
    named = model.faults(parts[1], answers)
    assert (answers.labels[named != ""] == CANNOT_TELL).all()
    assert "dead foil" in model.diagnosis.misleading


def test_a_model_without_faults_names_none(parts):
    healthy = parts[0].isel(sweep=parts[0]["fault"] == "")
    model = train(healthy, "column", quantities="Rs,Cp")
    assert model.diagnosis is None
    assert not model.faults(parts[1], model.answers(parts[1])).astype(bool).any()
    with_faults = train(parts[0], "column", quantities="Rs,Cp")
    np.testing.assert_array_equal(
        model.learned.probabilities(model.features(parts[1])),
        with_faults.learned.probabilities(with_faults.features(parts[1])),
    )


def test_sweeps_that_all_have_faults_teach_no_localizer(parts):
    with pytest.raises(InputError, match="every sweep has a fault"):
        train(parts[0].isel(sweep=parts[0]["fault"] != ""), "column")


def test_live_and_localize_name_the_fault(model, parts):
    dead = np.flatnonzero(np.char.startswith(parts[1]["fault"].values.astype(str), "dead foil"))
    some = parts[1].isel(sweep=slice(dead[0], dead[0] + 10))
    live = LiveLocalizer(model, model.known_scene.parts)
    answer = live.answer(some.isel(sweep=[9]), some.isel(sweep=[0]), 0.0, 0.1)
    assert answer.label == "cannot tell: like a dead foil"
    _, rows = _table(model, some, None)
    assert [row[2] for row in rows][-1] == answer.label


def test_faults_in_words():
    assert without_answer("dead foil") == "cannot tell: like a dead foil"
    assert without_answer("aged gain") == "cannot tell: like an aged gain"
    assert without_answer("") == CANNOT_TELL
