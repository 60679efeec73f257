"""Exported graphs give the answers of their models, from raw readings."""

import json
from dataclasses import replace

import numpy as np
import pytest
import rcskin
from rcskin.localization.adaptation import adapt_classes, adapt_positions
from rcskin.localization.export.c_file import c_files
from rcskin.localization.export.onnx_check import difference, inputs_of, outputs_of
from rcskin.localization.export.onnx_file import onnx_model
from rcskin.localization.export.portable import portable
from rcskin.localization.learners import networks
from rcskin.localization.model.training import train
from rcskin.localization.parts.predictor import Predictor
from rcskin.localization.trust.diagnosis import NO_FAULT, Diagnosis
from rcskin.simulator.sweeps import InputError, build
from rcskin.simulator.sweeps.reading_quantities import GAIN, MAGNITUDE

from .conftest import CASES

pytest.importorskip("onnx", reason="onnx is not installed: pip install '.[onnx]'")
pytest.importorskip("onnxruntime", reason="onnxruntime is not installed")


def compared(model, sweeps, rest=None, single=False):
    parts = portable(model)
    return difference(onnx_model(model, parts, single=single), model, parts, sweeps, rest)


@pytest.mark.parametrize("case", CASES)
def test_a_graph_answers_as_its_model(trained, make_sessions, case):
    unseen = make_sessions(seed=50, spread=0.4, repetitions=45)
    found = compared(trained(case), unseen)
    assert found.sweeps > 400 and found.labels == 0
    tolerance = 1e-5 if "network" in case else 1e-9
    assert found.probability < tolerance and found.position < 10 * tolerance


@pytest.mark.parametrize("case", ["the paper's", "gaussian", "network"])
def test_single_precision_is_near(trained, make_sessions, case):
    found = compared(trained(case), make_sessions(seed=50, spread=0.4), single=True)
    assert found.labels == 0 and found.probability < 3e-3


@pytest.mark.parametrize("case", ["the paper's, changes", "network of two", "positions"])
def test_adapted_models_too(trained, make_sessions, case):
    model, sweeps = trained(case), make_sessions(seed=20, sessions=2)
    samples = model.samples(sweeps)
    if model.target == "position":
        adapted = adapt_positions(model, samples, model.gate and model.gate.samples(sweeps))
    else:
        adapted = adapt_classes(model, samples)
    found = compared(adapted.model, make_sessions(seed=50))
    assert found.labels == 0 and max(found.probability, found.position) < 1e-5


@pytest.mark.parametrize("quantities", ["Rs,Cp", "dlnZ,dphase"])
def test_readings_that_are_skipped_are_ignored(make_sessions, few_readings, quantities):
    model = train(few_readings(make_sessions()), "column", "ksvm-ovo", quantities=quantities)
    unseen = few_readings(make_sessions(seed=50))
    assert compared(model, unseen).rounding_alone
    parts = portable(model)
    exported = onnx_model(model, parts)
    rows = model.usable_features(unseen)[1]
    other = unseen.fillna(1.0)
    kept, changed = (outputs_of(exported, model, each, None, rows) for each in (unseen, other))
    np.testing.assert_array_equal(kept["probabilities"], changed["probabilities"])
    own = {each.key: each.value for each in exported.metadata_props}
    assert json.loads(own["taken"]) == [list(map(int, row)) for row in model.problem.taken]


@pytest.mark.parametrize("kind", [GAIN, MAGNITUDE])
@pytest.mark.parametrize("relative", [True, False])
def test_gains(kind, relative):
    random, count = np.random.default_rng(1), 90
    column = np.arange(count) % 3
    shift = 0.1 * column[:, None, None] * np.array([0.5, 1.0, 1.5j])
    noise = random.standard_normal((2, count, 1, 3)) * 1e-2
    sweeps = build(
        0.5 * np.exp(-3.1j + shift + noise[0] + 1j * noise[1]),
        [1e3, 2e3, 4e3],
        interface=["left"],
        press=["none" if not c else f"1,{c}:2.0" for c in column],
        row=np.minimum(column, 1),
        column=column,
        kind=kind,
    ).dataset()
    phases = kind is GAIN
    quantities = ("dlnG", "dphaseG") if relative else ("gain", "lnG", "phaseG")
    names = [name for name in quantities if phases or "phase" not in name]
    model = train(sweeps, "column", "ksvm-ovo", quantities=names)
    assert compared(model, sweeps).rounding_alone


def test_one_baseline_of_several_sweeps_serves_all(trained, make_sessions):
    onnxruntime = pytest.importorskip("onnxruntime")
    model = trained("network")
    unseen = make_sessions(seed=50, sessions=1)
    rest = unseen.isel(sweep=unseen["row"].values == 0)
    pressed = unseen.isel(sweep=unseen["row"].values > 0)
    exported = onnx_model(model, portable(model))
    session = onnxruntime.InferenceSession(exported.SerializeToString())
    given = {name: pressed[name].values for name in ("Rs", "X")}
    for prefix in ("baseline_", "opening_"):
        given |= {f"{prefix}{name}": rest[name].values[None] for name in ("Rs", "X")}
    probabilities = session.run(["probabilities"], given)[0]
    expected = model.probabilities(pressed, rest)[1]
    np.testing.assert_allclose(probabilities, expected, atol=1e-5)


def test_without_a_baseline_the_guards_of_changes_are_off(trained, make_sessions):
    unseen = make_sessions(seed=50, unpressed=False, rests=1, spread=0.4)
    model = trained("the paper's")
    assert model.guards_use_changes
    names = [each.name for each in onnx_model(model, portable(model)).graph.input]
    assert np.isnan(inputs_of(names, model, unseen)["baseline_Rs"]).all()
    assert compared(model, unseen).rounding_alone


def test_a_missing_reading_is_no_answer(trained, make_sessions):
    model = trained("the paper's")
    unseen = make_sessions(seed=50, sessions=1)
    exported = onnx_model(model, portable(model))
    spoilt = unseen.copy(deep=True)
    spoilt["Rs"][:, 0, 0] = np.nan
    found = outputs_of(exported, model, spoilt, None, np.arange(3))
    assert (found["label"] == -1).all() and np.isnan(found["probabilities"]).all()


def test_the_file_says_what_it_takes_and_gives(trained):
    model = trained("gaussian of a curve")
    exported = onnx_model(model, portable(model))
    own = {each.key: each.value for each in exported.metadata_props}
    assert json.loads(own["frequencies_Hz"]) == list(model.frequencies)
    assert json.loads(own["labels"]) == list(map(str, model.classes))
    assert json.loads(own["interfaces"]) == ["left", "right"]
    assert (own["scene"], own["estimator"]) == (model.problem.scene, "gaussian")
    assert own["rcskin_version"] and own["features_version"] == "1"
    meanings = json.loads(own["inputs"])
    shapes = {
        each.name: [d.dim_value or d.dim_param for d in each.type.tensor_type.shape.dim]
        for each in exported.graph.input
    }
    assert set(shapes) == set(meanings)
    assert shapes["Rs"] == ["sweep", 2, 6]
    assert shapes["opening_X"] == ["session", "opening_sweep", 2, 6]
    assert meanings["X"] == "series reactance, Im Z, ohm"
    assert {each.name for each in exported.graph.output} == set(json.loads(own["outputs"]))


def test_faults_that_a_graph_does_not_know_are_named(trained, make_sessions):
    model = trained("the paper's, changes")
    limits = {NO_FAULT: model.learned.guards.kinds, "dead foil": model.learned.guards.kinds}
    faulty = replace(model, diagnosis=Diagnosis(limits, ("dead foil",)))
    exported = onnx_model(faulty, portable(faulty))
    own = {each.key: each.value for each in exported.metadata_props}
    named = "faults are not recognized: sweeps like those of dead foil are answered too"
    assert json.loads(own["limits"]) == [named]
    assert named in c_files(faulty, portable(faulty), "skin").header
    assert difference(exported, faulty, portable(faulty), make_sessions(seed=50)).labels == 0


def test_a_model_that_inverts_the_simulator_stays(trained):
    class Inverting(Predictor):
        classes, features = trained("the paper's").predictor.classes, 24

    learned = replace(trained("the paper's").learned, predictor=Inverting())
    model = replace(trained("the paper's"), learned=learned, estimator="model-based")
    with pytest.raises(InputError, match="model-based computes with the simulator and cannot be"):
        portable(model)


@pytest.fixture
def of_few_steps(monkeypatch):
    monkeypatch.setattr(networks, "STAGES", networks.SHORT_STAGES)


@pytest.mark.slow
@pytest.mark.parametrize("estimator", ["ksvm-ovo", "network", "gaussian"])
@pytest.mark.parametrize("quantities", ["Rs,Cp", "dlnZ,dphase,lnZ0,phase0"])
def test_ten_thousand_sweeps(of_few_steps, estimator, quantities):
    scene = rcskin.load("sheet-4x4").with_({"dataset.session.sweeps_per_session": 100})
    known, unseen = (rcskin.dataset(scene, n, seed=n, rtol=1e-3) for n in (2500, 10_000))
    model = train(known, "column", estimator, quantities=quantities)
    found = compared(model, unseen)
    assert found.sweeps > 8000 and found.probability < 1e-5 and found.labels == 0
