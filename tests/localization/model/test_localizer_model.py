"""

Localizers of interfaces that are read at frequencies of their own.
"""

from dataclasses import replace
from importlib.metadata import version

import numpy as np
import pytest
import rcskin
from rcskin.localization.inputs.features import features
from rcskin.localization.inputs.targets import labels
from rcskin.localization.model.localizer_file import load, save
from rcskin.localization.model.training import train
from rcskin.localization.trust.answers import CANNOT_TELL
from rcskin.simulator.sweeps import InputError, check


@pytest.mark.parametrize("target", ["column", "pixel"])
def test_a_model_finds_where_sweeps_it_never_saw_were_pressed(strip, make_sweeps, target):
    unseen = make_sweeps(seed=3)
    np.testing.assert_array_equal(
        train(strip, target, quantities="Rs,Cp").predict(unseen), labels(unseen, target)
    )


def test_a_model_knows_what_it_was_trained_on(sheet):
    model = train(sheet, "row", "ksvm-components", quantities=["X", "Rs"])
    assert (model.target, model.quantities) == ("row", ("X", "Rs"))
    assert model.interfaces == ("left", "right")
    assert model.frequencies == tuple(sheet["frequency"].values)
    assert model.problem.scene == sheet.attrs["scene"]
    assert model.versions == {name: version(name) for name in ("rcskin", "scikit-learn")}
    other = replace(model, versions={**model.versions, "rcskin": "0.1"})
    here = f"rcskin 0.1 (here {version('rcskin')})"
    assert (model.version_difference, other.version_difference) == ("", here)


def test_sweeps_without_a_scene_train_a_model_without_one(strip):
    assert train(strip.drop_attrs()).scene is None


def test_the_answer_does_not_depend_on_the_labels_of_the_question(strip):
    unknown = strip.assign_coords(row=strip["row"] * 0 - 1, column=strip["column"] * 0 - 1)
    model = train(strip, quantities="Rs,Cp")
    np.testing.assert_array_equal(model.predict(unknown), model.predict(strip))


def test_a_frequency_off_by_rounding_is_the_same_frequency(strip):
    model = train(strip, quantities="Rs,Cp")
    nearly = strip.assign_coords(frequency=strip["frequency"] * (1 + 1e-12))
    np.testing.assert_array_equal(model.predict(nearly), model.predict(strip))


@pytest.mark.parametrize(
    ("other", "message"),
    [
        (
            {"frequency": np.geomspace(1e3, 100e3, 20)},
            "at 1321.62072943 Hz, the sweeps have 1274.2749857 Hz",
        ),
        ({"frequency": np.geomspace(1e3, 200e3, 10)}, "20 frequencies, the sweeps have 10"),
        ({"interfaces": ("right",)}, "interfaces left, the sweeps have right"),
        ({"interfaces": ("right",), "rows": 2}, "interfaces left, the sweeps have right"),
    ],
)
def test_sweeps_unlike_those_of_the_training_are_refused(strip, make_sweeps, other, message):
    with pytest.raises(InputError, match=message):
        train(strip).predict(make_sweeps(repetitions=1, **other))


def test_one_class_alone_trains_no_model(strip):
    with pytest.raises(InputError, match="at least 2 classes, got 1"):
        train(strip.isel(sweep=strip["column"] == 1))


READINGS = [("Rs", np.nan), ("X", np.inf), ("X", -np.inf), ("Cp", np.nan)]


def with_reading(sweeps, sweep, name, value):
    """The sweeps with another value of one reading of a sweep."""
    values = sweeps[name].values.copy()
    values[sweep, 0, 1] = value
    return sweeps.assign({name: (sweeps[name].dims, values)})


@pytest.mark.parametrize(("name", "value"), READINGS)
@pytest.mark.parametrize("quantities", ["Rs,Cp", "dlnZ,dphase"])
@pytest.mark.parametrize("estimator", [None, "gaussian"])
def test_a_reading_that_is_no_number_costs_its_sweep_alone(
    strip, make_sweeps, estimator, quantities, name, value
):
    model = train(strip, "column", estimator, quantities=quantities)
    sweeps = make_sweeps(seed=3)
    k = len(sweeps["sweep"]) - 2
    spoilt, sound = with_reading(sweeps, k, name, value), model.answers(sweeps)
    answers = model.answers(spoilt)
    others = np.arange(sound.labels.size) != k
    assert answers.labels[k] == CANNOT_TELL
    np.testing.assert_array_equal(answers.labels[others], sound.labels[others])
    found, before = (rcskin.evaluate(model, each) for each in (spoilt, sweeps))
    count = before.score.right.size
    assert found.answered * count == pytest.approx(sound.answered[others].sum())
    assert found.score.rates()["right of all"].total == count
    assert "1 with a reading that is no finite number" in found.left_out
    rest = sweeps.isel(sweep=[0])
    assert model.answers(spoilt.isel(sweep=[k]), rest).labels.tolist() == [CANNOT_TELL]
    with pytest.raises(InputError, match=f"sweep {k}: a reading is no finite number"):
        model.predict(spoilt)


@pytest.mark.parametrize(("name", "value"), READINGS)
def test_a_baseline_with_a_reading_that_is_no_number_is_none(strip, make_sweeps, name, value):
    model = train(strip, "column", quantities="dlnZ,dphase")
    sweeps = make_sweeps(seed=3)
    spoilt = with_reading(sweeps, 4, name, value)
    assert sweeps["row"].values[4] == 0
    answers, sound = model.answers(spoilt), model.answers(sweeps)
    np.testing.assert_array_equal(answers.labels == sound.labels, np.arange(24) != 4)
    of_rest = model.answers(sweeps.isel(sweep=slice(5, 8)), spoilt.isel(sweep=[0, 4]))
    np.testing.assert_array_equal(of_rest.labels, sound.labels[5:8])


def test_a_model_learns_from_the_sweeps_that_have_all_readings(strip):
    model = train(with_reading(strip, 3, "Rs", np.nan), quantities="Rs,Cp")
    assert model.trained_on == train(strip, quantities="Rs,Cp").trained_on - 1
    assert "left out: 1 with a reading that is no finite number" in model.left_out


@pytest.fixture(scope="module")
def thinned(sheet):
    """A function that leaves out the readings of a sheet that a mask leaves out."""

    def thin(taken):
        part = sheet.where(np.broadcast_to(taken, sheet["Rs"].shape))
        told = part.assign_coords(taken=(("interface", "frequency"), taken.astype(np.int8)))
        return check(told.assign_coords({name: sheet[name] for name in ("row", "column")}))

    return thin


@pytest.fixture(scope="module")
def taken(sheet):
    taken = np.ones((sheet.sizes["interface"], sheet.sizes["frequency"]), dtype=bool)
    taken[0, 0] = taken[-1, -1] = False
    return taken


@pytest.mark.parametrize("quantities", [("Rs", "Cp"), ("lnZ", "phase")])
def test_features_are_those_of_what_was_read(sheet, thinned, taken, quantities):
    whole = features(sheet, quantities).reshape(-1, 2, *taken.shape)
    found = features(thinned(taken), quantities)
    np.testing.assert_array_equal(found, whole[:, :, taken].reshape(len(whole), -1))


@pytest.mark.parametrize("estimator", ["ksvm-ovo", "gaussian"])
def test_a_model_of_them_is_kept_and_takes_no_others(sheet, thinned, taken, estimator, tmp_path):
    sweeps = thinned(taken)
    model = train(sweeps, "column", estimator, quantities="Rs,Cp")
    save(tmp_path / "own.npz", model)
    again = load(tmp_path / "own.npz")
    assert again.problem == model.problem and again.problem.taken
    np.testing.assert_array_equal(again.predict(sweeps), model.predict(sweeps))
    for other in (sheet, thinned(np.roll(taken, 1, axis=1))):
        with pytest.raises(InputError, match="read at other `frequencies` of their own"):
            again.predict(other)


def test_a_model_without_takes_none(sheet, thinned, taken):
    model = train(sheet, "column", "ksvm-ovo")
    assert model.problem.taken == ()
    with pytest.raises(InputError, match="read at other `frequencies` of their own"):
        model.predict(thinned(taken))
