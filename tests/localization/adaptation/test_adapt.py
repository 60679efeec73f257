"""`rcskin adapt`: a few touches of the skin at hand correct a model of other skins."""

from dataclasses import replace

import numpy as np
import pytest
from rcskin.localization.adaptation import adapt_classes, adapt_positions
from rcskin.localization.model.localizer_file import load, save
from rcskin.localization.model.training import train
from rcskin.simulator.scene.scene_files import load_scene, scene_text
from rcskin.simulator.sweeps import InputError, concatenate, write

FREQUENCY = np.geomspace(1e3, 200e3, 20)


@pytest.fixture(scope="module")
def model(make_sweeps):
    """Of columns, by the curves of skins as simulated."""
    known = concatenate([make_sweeps(1, 4, session=k, seed=k, noise=0.01) for k in range(3)])
    return train(known, quantities=("dlnZ", "dphase"), estimator="ksvm-ovo")


@pytest.fixture(scope="module")
def other(make_sweeps):
    """A function: sweeps of a skin on which every press changes more than on those."""

    def other(sessions, repetitions=4, **asked):
        parts = [
            make_sweeps(1, 4, repetitions, session=k, seed=50 + k, noise=0.01, **asked)
            for k in range(sessions)
        ]
        return concatenate([_pressed_elsewhere(each) for each in parts])

    return other


def _pressed_elsewhere(sweeps):
    """Frequencies shifted, as those of a skin of twice the RC are."""
    shifted = sweeps.assign_coords(frequency=FREQUENCY)
    for name in ("Rs", "X", "Cp"):
        values = sweeps[name].values
        moved = np.array([[np.interp(2 * FREQUENCY, FREQUENCY, y) for y in z] for z in values])
        shifted[name] = sweeps[name].dims, moved
    return shifted


def test_touches_of_other_sessions_are_found_better_after_than_before(model, other):
    touches, unseen = other(2), other(4).isel(sweep=slice(40, None))
    found = adapt_classes(model, model.samples(touches))
    asked = model.samples(unseen)
    rates = [(each.predictor.predict(asked.X) == asked.y).mean() for each in (model, found.model)]
    assert rates[1] > rates[0] + 0.1
    assert found.after.right.mean() > found.before.right.mean() + 0.1


def test_before_and_after_are_of_the_same_sweeps_and_no_sweep_teaches_what_it_judges(model, other):
    touches = other(3)
    found = adapt_classes(model, model.samples(touches))
    np.testing.assert_array_equal(found.before.truth, found.after.truth)
    first_of_sessions = 3
    assert len(found.before.truth) == touches.sizes["sweep"] - first_of_sessions
    assert "whole sessions held out" in found.validation
    samples = model.samples(touches)
    nonsense = np.random.default_rng(0).permutation(samples.y)
    lies = adapt_classes(model, replace(samples, y=nonsense))
    assert lies.after.right.mean() < 0.5 < found.after.right.mean()


def test_an_adapted_model_is_read_back_and_taught_only_once(model, other, tmp_path):
    touches = other(2)
    better = adapt_classes(model, model.samples(touches)).model
    save(tmp_path / "m.npz", better)
    again = load(tmp_path / "m.npz")
    told = [each.probabilities(touches)[1] for each in (better, again)]
    np.testing.assert_array_equal(*told)
    with pytest.raises(Exception, match="was adapted before: adapt the original"):
        adapt_classes(again, again.samples(touches))


def test_sweeps_unlike_the_training_are_answered_once_the_skin_is_known(make_sweeps, model, other):
    touches = other(2)
    found = adapt_classes(model, model.samples(touches))
    told = [each.answers(touches).answered.mean() for each in (model, found.model)]
    assert told[0] < told[1] and told[1] > 0.9


@pytest.fixture(scope="module")
def placing(make_sweeps):
    """Of places along the strip, by the curves of skins as simulated."""
    known = concatenate([make_sweeps(1, 4, session=k, seed=k, noise=0.01) for k in range(3)])
    return train(_placed(known), "position", quantities=("dlnZ", "dphase"))


def test_places_on_other_sessions_are_found_better_after_than_before(placing, other):
    touches, unseen = _placed(other(2)), _placed(other(4).isel(sweep=slice(40, None)))
    samples = placing.samples(touches)
    found = adapt_positions(placing, samples, placing.gate.samples(touches))
    (before, _), (after, deviation) = (each.positions(unseen) for each in (placing, found.model))
    truth = placing.samples(unseen)
    off = [np.abs(told[truth.rows, 0] - truth.y[:, 0]).mean() for told in (before, after)]
    assert off[1] < 0.7 * off[0]
    assert np.median(found.after.distance) < 0.8 * np.median(found.before.distance)
    ratio = (after[truth.rows, 0] - truth.y[:, 0]) / deviation[truth.rows, 0]
    assert 0.4 < np.sqrt(np.mean(ratio**2)) < 2.0
    shown = [each.answers(unseen).answered.mean() for each in (placing, found.model)]
    assert shown[0] < 0.5 and shown[1] > 0.7


def test_no_touch_judges_places_that_it_taught(placing, other):
    samples = placing.samples(_placed(other(3)))
    nonsense = replace(samples, y=np.random.default_rng(0).permutation(samples.y))
    lies, found = adapt_positions(placing, nonsense), adapt_positions(placing, samples)
    np.testing.assert_array_equal(found.before.truth, found.after.truth)
    assert np.median(found.after.distance) < 0.5 * np.median(lies.after.distance)
    assert "whole sessions held out" in found.validation


def test_places_given_by_the_simulator_are_not_moved(placing, other):
    inverting = replace(placing, estimator="model-adapted")
    with pytest.raises(InputError, match="by model-adapted cannot be adapted: calibrate its scene"):
        adapt_positions(inverting, placing.samples(_placed(other(1))))


@pytest.fixture(scope="module")
def folder(model, other, make_sweeps, tmp_path_factory):
    folder = tmp_path_factory.mktemp("adapt")
    save(folder / "m.npz", model)
    touches = other(2)
    save(folder / "a.npz", adapt_classes(model, model.samples(touches)).model)
    places = train(_placed(make_sweeps(1, 4)), "position", quantities=("dlnZ",))
    save(folder / "p.npz", places)
    taught = adapt_positions(places, places.samples(_placed(make_sweeps(1, 4)))).model
    save(folder / "q.npz", taught)
    write(_placed(make_sweeps(1, 4, 2)).isel(sweep=slice(6)), folder / "five-places.nc")
    write(touches, folder / "touches.nc")
    write(_placed(make_sweeps(1, 4)), folder / "strip.nc")
    write(touches.isel(sweep=touches["column"].values != 3), folder / "without.nc")
    write(other(1, 1), folder / "few.nc")
    write(concatenate([make_sweeps(1, 5)]), folder / "five.nc")
    return folder


def _placed(sweeps):
    return sweeps.assign_attrs(
        scene=scene_text(load_scene("strip-1x3").with_({"skin.length": 0.03}))
    )


def test_figures_before_and_after_are_reported(run, folder, tmp_path):
    out = tmp_path / "better.npz"
    code, told, err = run("adapt", folder / "m.npz", folder / "touches.nc", "-o", out)
    assert (code, err) == (0, "")
    first, before, after, *_, last = told.splitlines()
    assert "of 38 sweeps of the skin at hand" in first
    assert before.startswith("before: right of all ") and after.startswith("after: right of all ")
    assert last == f"model: adapted by 38 sweeps -> {out}"


@pytest.mark.parametrize("command", ["evaluate", "localize"])
def test_sweeps_that_a_model_was_adapted_on_are_not_taken_for_others(run, folder, other, command):
    out = folder / f"{command}.npz"
    assert run("adapt", folder / "m.npz", folder / "touches.nc", "-o", out)[0] == 0
    _, _, err = run(command, out, folder / "touches.nc")
    assert f"note: {out}: was trained or adapted on 38 of these 40 sweeps" in err
    write(other(4).isel(sweep=slice(40, None)), folder / f"unseen-{command}.nc")
    assert "was trained" not in run(command, out, folder / f"unseen-{command}.nc")[2]


def test_figures_of_places_before_and_after_are_reported_and_the_model_is_read_back(run, folder):
    out = folder / "placed.npz"
    code, told, err = run("adapt", folder / "p.npz", folder / "strip.nc", "-o", out)
    assert (code, err) == (0, "")
    first, before, after, *_ = told.splitlines()
    assert "touches of the skin at hand" in first
    for line, begins in ((before, "before: "), (after, "after: ")):
        assert line.startswith(begins) and "median error, mm " in line and "95 % regions" in line
    assert load(out).adapted


@pytest.mark.parametrize(
    ("file", "touches", "told"),
    [
        ("m.npz", "without.nc", "needs at least 2 sweeps of each column, got 0 of 3"),
        (
            "m.npz",
            "few.nc",
            "needs at least 2 sweeps of each column, got 0 of the unpressed skin (and 4 more)",
        ),
        ("m.npz", "five.nc", "column 5 was touched, but it is no class of the model"),
        ("a.npz", "touches.nc", "was adapted before"),
        ("p.npz", "five-places.nc", "needs at least 6 touches of known place, got 4"),
        ("q.npz", "strip.nc", "was adapted before"),
        ("m.npz", "none.nc", "no such file"),
    ],
)
def test_what_cannot_teach_is_refused_and_nothing_is_written(refused, folder, file, touches, told):
    out = folder / "out.npz"
    assert told in refused("adapt", folder / file, folder / touches, "-o", out)
    assert not out.exists()
