"""Touches followed on skins in closed form: alone, together, in mid-sweep, and by choice."""

import numpy as np
import pytest
from rcskin.localization.filtering.adaptive import AdaptivePolicy
from rcskin.localization.filtering.chain import TouchDynamics
from rcskin.localization.filtering.follower import Follower
from rcskin.localization.inversion.estimators import MODEL_BASED
from rcskin.localization.model.training import train
from rcskin.localization.trust.answers import CANNOT_TELL
from rcskin.simulator.measure.readout import read_out
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import InputError, concatenate

CHANGE = ("dlnZ", "dphase")
PACE = 0.4


@pytest.fixture(scope="module")
def exact():
    """The strip at rest and pressed at each column, without noise."""
    scene = load_scene("strip-1x3")
    presses = ["none", *(f"1,{k}:{f}" for k in (1, 2, 3) for f in (1.8, 2.0, 2.2))]
    return simulate(Solver(scene.parts), [parse_press(each, 2.0) for each in presses])


@pytest.fixture(scope="module")
def models(exact):
    scene, random = load_scene("strip-1x3"), np.random.default_rng(0)
    some = exact.isel(sweep=[0, 0, *range(10)])
    sweeps = concatenate([read_out(some, scene.readout, random, k) for k in range(4)])
    return {
        name: train(sweeps, "column", name, quantities=CHANGE) for name in (MODEL_BASED, "ksvm-ovo")
    }


@pytest.fixture
def run(exact):
    """A function from columns, one a sweep, to noisy sweeps; (a, b): changed in mid-sweep."""
    readout = load_scene("strip-1x3").readout
    places = {0: 0, 1: 2, 2: 5, 3: 8}

    def run(columns, seed=1):
        first, last = (
            [places[each[k] if isinstance(each, tuple) else each] for each in columns]
            for k in (0, 1)
        )
        noisy = read_out(exact.isel(sweep=first), readout, np.random.default_rng(seed), 0)
        later = read_out(exact.isel(sweep=last), readout, np.random.default_rng(seed), 0)
        half = round(noisy.sizes["frequency"] / 2)
        for name in ("Rs", "X", "Cp"):
            noisy[name].values[..., half:] = later[name].values[..., half:]
        return noisy

    return run


@pytest.fixture
def rest(run):
    return run([0] * 5, seed=9)


def labels(followed):
    return [each.label for each in followed]


@pytest.mark.parametrize("name", [MODEL_BASED, "ksvm-ovo"])
def test_touches_that_come_and_go_are_followed(models, run, rest, name):
    columns = [0, 0, 0, 2, 2, 2, 0, 0, 3, 3]
    told = Follower(models[name]).follow_all(run(columns), rest, PACE)
    assert labels(told) == [str(column) for column in columns]
    assert all(each.probabilities.sum() <= 1 + 1e-9 for each in told)


@pytest.mark.parametrize("name", [MODEL_BASED, "ksvm-ovo"])
def test_a_sweep_with_a_reading_that_is_no_number_is_not_answered(models, run, rest, name):
    """Alone, or among others, which are answered as without it."""
    sweeps = run([0, 2, 2, 2])
    sweeps["X"].values[2, 0, 1] = np.nan
    told = Follower(models[name]).follow_all(sweeps, rest, PACE)
    assert labels(told) == ["0", "2", CANNOT_TELL, "2"]
    alone = Follower(models[name]).follow(sweeps.isel(sweep=[2]), rest, PACE, PACE)
    assert alone.label == CANNOT_TELL


@pytest.mark.parametrize(
    ("name", "columns"), [(MODEL_BASED, (0, 2)), (MODEL_BASED, (3, 0)), ("ksvm-ovo", (0, 1))]
)
def test_a_sweep_that_a_touch_changes_midway_is_weighed_and_not_answered(
    models, run, rest, name, columns
):
    before, after = columns
    sweeps = run([before] * 3 + [columns] + [after] * 2)
    told = Follower(models[name]).follow_all(sweeps, rest, PACE)
    assert told[3].label == CANNOT_TELL and told[3].changed > 0.5
    steady = [each for k, each in enumerate(told) if k != 3]
    assert labels(steady) == [str(before)] * 3 + [str(after)] * 2
    assert max(each.changed for each in steady) < 0.5


def test_one_bad_sweep_does_not_end_a_touch(models, run, rest):
    sweeps = run([0, 0, 2, 2, 2, 2])
    sweeps["X"].values[4] *= 1.5
    told = Follower(models["ksvm-ovo"]).follow_all(sweeps, rest, PACE)
    assert models["ksvm-ovo"].answers(sweeps, rest).labels[4] == CANNOT_TELL
    assert labels(told)[2:] == ["2"] * 4


def test_a_session_forgets_the_one_before_and_live_steps_are_the_same(models, run, rest):
    sweeps = concatenate([run([2] * 4), run([0] * 3).assign_coords(session=("sweep", [1] * 3))])
    follower = Follower(models[MODEL_BASED], TouchDynamics(lasts=1e6, every=1e6))
    together = follower.follow_all(sweeps, rest, PACE)
    assert labels(together) == ["2"] * 4 + ["0"] * 3
    alone = Follower(models[MODEL_BASED], TouchDynamics(lasts=1e6, every=1e6))
    one_by_one = [
        alone.follow(sweeps.isel(sweep=[k]), rest, 0.0, PACE).probability for k in range(4)
    ]
    assert one_by_one == pytest.approx([each.probability for each in together[:4]])


def test_sweeps_end_early_and_are_right(models, run, rest):
    model = models[MODEL_BASED]
    columns, asked = [0, 1, 2, 3], 0
    sweeps = run(columns)
    Z = (sweeps["Rs"] + 1j * sweeps["X"]).values[:, 0]
    frequencies = list(model.frequencies)
    for column, own in zip(columns, Z, strict=True):
        questions = AdaptivePolicy(model).begin(rest, 0.0)
        while (wanted := questions.next(np.ones((1, len(frequencies))))) is not None:
            questions.add_reading(*wanted, own[frequencies.index(wanted[1])])
            asked += 1
        told = questions.answer(PACE)
        assert told.label == str(column) and told.probability >= 0.95
    assert asked < len(frequencies) * len(columns) / 2


def test_quick_readings_are_taken_first(models, rest):
    seconds = np.ones((1, len(models[MODEL_BASED].frequencies)))
    first = AdaptivePolicy(models[MODEL_BASED]).begin(rest, 0.0).next(seconds)
    slow = np.where(np.array([models[MODEL_BASED].frequencies]) == first[1], 1e3, 1.0)
    assert AdaptivePolicy(models[MODEL_BASED]).begin(rest, 0.0).next(slow) != first


def test_other_models_do_not_choose_frequencies(models):
    with pytest.raises(
        InputError, match="--adaptive takes models by model-based.*one by ksvm-ovo of"
    ):
        AdaptivePolicy(models["ksvm-ovo"])
