"""Faults by name: a model trained with them names what it refuses, hardly ever a healthy skin."""

import numpy as np
import pytest
from rcskin.hardware.live.live_localizer import LiveLocalizer
from rcskin.localization.commands.localize import _table
from rcskin.localization.evaluation.fault_scores import fault_lines, fault_scores
from rcskin.localization.evaluation.result import evaluated
from rcskin.localization.model.localizer_file import load, save
from rcskin.localization.model.training import train
from rcskin.localization.trust.answers import CANNOT_TELL
from rcskin.localization.trust.diagnosis import NO_FAULT, without_answer
from rcskin.simulator.dataset.dataset_plan import DatasetPlan
from rcskin.simulator.dataset.memory_dataset import in_memory
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import InputError

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
