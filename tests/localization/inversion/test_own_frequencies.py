"""Localizers that invert the simulator, of interfaces that are read at frequencies of their own."""

import numpy as np
import pytest
from rcskin.localization.filtering.adaptive import AdaptivePolicy, inverter_for
from rcskin.localization.inputs.features import features
from rcskin.localization.model.training import train
from rcskin.simulator.measure.readout import read_out
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import every_press
from rcskin.simulator.scene.scene_files import load_scene, scene_text
from rcskin.simulator.sweeps import InputError, concatenate
from rcskin.simulator.sweeps.reading_subset import restricted

READOUT = {
    "magnitude_accuracy": 2e-3,
    "phase_accuracy": 2e-3,
    "magnitude_noise": 3e-3,
    "phase_noise": 3e-3,
}
FREQUENCIES = [1e3, 1e4, 1e5]
CHANGES = ("dlnZ", "dphase")
WITH_REST = (*CHANGES, "lnZ0", "phase0")


@pytest.fixture(scope="module")
def shared():
    changes = {"pixels": 2, "sweep.frequencies": FREQUENCIES, "readout": READOUT}
    return load_scene("sheet-5x5-two-interfaces").with_(changes)


@pytest.fixture(scope="module")
def own(shared):
    each = {"interface.1.frequencies": [1e3, 1e4], "interface.2.frequencies": [1e4, 1e5]}
    return shared.with_(each)


@pytest.fixture(scope="module")
def sweeps(shared, own):
    """Of all readings, and of those taken."""
    rest, *pressed = every_press(shared.parts.skin, shared.press)
    exact = simulate(Solver(shared.parts, 1e-4), [rest] * 9 + pressed * 4)
    random = np.random.default_rng(4)
    whole = concatenate([read_out(exact, shared.readout, random, session=k) for k in range(3)])
    part = restricted(whole, own.parts.setup.taken)
    return whole.assign_attrs(scene=scene_text(shared)), part.assign_attrs(scene=scene_text(own))


def trained(sweeps, name, target="pixel"):
    quantities = WITH_REST if name == "model-adapted" else CHANGES
    return train(sweeps, target, name, quantities=quantities)


@pytest.fixture(scope="module", params=["model-based", "model-adapted"])
def models(request, sweeps):
    return [trained(each, request.param) for each in sweeps]


def test_answers_are_those_of_all_readings_of_which_these_are_looked_at(sweeps, own):
    whole, part = (trained(each, "model-based").predictor for each in sweeps)
    X, fewer = (features(each, CHANGES, rest=each.isel(sweep=slice(9))) for each in sweeps)
    kept = np.flatnonzero(np.tile(own.parts.setup.taken.ravel(), 2))
    np.testing.assert_array_equal(fewer, X[:, kept])
    expected = whole.log_densities(X, tuple(kept.tolist()))
    told = part.log_densities(fewer)
    np.testing.assert_allclose(told, expected, rtol=1e-5, atol=1e-5)


def test_they_find_pixels(models, sweeps):
    for model, each in zip(models, sweeps, strict=True):
        answers = model.answers(each)
        right = [
            label == f"{row},{column}"
            for label, row, column in zip(
                answers.labels, each["row"].values, each["column"].values, strict=True
            )
        ]
        assert np.mean(np.array(right)[each["row"].values > 0]) > 0.8


def test_a_sweep_is_asked_reading_by_reading_of_those_taken(models, sweeps, own):
    part = sweeps[1]
    asker = AdaptivePolicy(models[1], 0.9999999)
    rest, pressed = part.isel(sweep=slice(9)), part.isel(sweep=10)
    questions = asker.begin(rest, 1.0)
    asked = []
    while (wanted := questions.next(np.full(own.parts.setup.taken.shape, 0.02))) is not None:
        name, frequency = wanted
        asked.append((["left", "bottom"].index(name), FREQUENCIES.index(frequency)))
        here = pressed.sel(interface=name, frequency=frequency)
        questions.add_reading(name, frequency, complex(here["Rs"].item(), here["X"].item()))
    assert len(asked) == len(set(asked)) and all(own.parts.setup.taken[place] for place in asked)
    assert questions.answer(1.0).label == f"{pressed['row'].item()},{pressed['column'].item()}"
    step, curve = inverter_for(models[1], rest)
    assert (
        curve.shape == (own.parts.setup.taken.sum(),)
        and step.noise.size == 2 * own.parts.setup.taken.sum()
    )


def test_sweeps_read_otherwise_than_their_scene_says_are_refused(sweeps, own, shared):
    whole, part = sweeps
    for each, scene in ((whole, own), (part, shared)):
        with pytest.raises(
            InputError, match="takes each interface at its `frequencies` of the scene"
        ):
            trained(each.assign_attrs(scene=scene_text(scene)), "model-based")


@pytest.mark.slow
def test_positions_are_found(sweeps):
    model = trained(sweeps[1], "model-based", "position")
    place, deviation = model.positions(sweeps[1])
    told = np.isfinite(place).all(axis=1)
    assert told.any() and np.isfinite(deviation[told]).all()
