"""Models with a flipped bit, cut short, or with arrays that do not fit each other are refused."""

import copy
import io
import zipfile
from dataclasses import replace

import numpy as np
import pytest
from rcskin.localization.learners import classifiers, regressors
from rcskin.localization.model.localizer_file import load, save
from rcskin.localization.model.soundness import UnsoundError, check_estimator, check_sound
from rcskin.localization.model.training import train
from rcskin.simulator.sweeps import InputError
from rcskin.tests.spoiling import share_refused

FLIPS, CUTS = 60, 10
FEATURES, SWEEPS = 40, 60


@pytest.fixture(scope="module")
def model(sheet):
    return train(sheet, "pixel", "ksvm-components", quantities=("Rs", "Cp"))


def test_a_model_with_a_flipped_bit_or_cut_is_refused_or_the_same(model, sheet, tmp_path):
    path = tmp_path / "model.npz"
    save(path, model)
    expected = model.pipeline.decision_function(model.features(sheet))

    def same(again):
        return np.array_equal(again.pipeline.decision_function(again.features(sheet)), expected)

    assert share_refused(path, load, same, FLIPS, CUTS) > 0.8


def test_an_array_put_in_the_place_of_another_is_noticed_by_the_digest(model, tmp_path):
    save(tmp_path / "model.npz", model)
    with (
        zipfile.ZipFile(tmp_path / "model.npz") as old,
        zipfile.ZipFile(tmp_path / "other.npz", "w") as new,
    ):
        for name in old.namelist():
            content = old.read(name)
            if name.endswith(".npy"):
                array = np.load(io.BytesIO(content))
                changed = io.BytesIO()
                np.save(changed, array + 1 if array.dtype.kind == "f" else array)
                content = changed.getvalue()
            new.writestr(name, content)
    with pytest.raises(InputError, match=r"other\.npz: spoilt: its contents are not what"):
        load(tmp_path / "other.npz")


def fitted(name):
    """A pipeline of that name, fitted to noise of a few classes or places."""
    random = np.random.default_rng(0)
    X = random.normal(size=(SWEEPS, FEATURES))
    places, classes = random.normal(size=(SWEEPS, 3)), np.repeat(["a", "b", "c"], SWEEPS // 3)
    few = ((2e-3, 2),)
    made = {
        "pairs": (classifiers.reference(FEATURES), classes),
        "pairs of two": (classifiers.reference(FEATURES), classes == "a"),
        "components": (classifiers.components_svm(), classes),
        "components of two": (classifiers.components_svm(), classes == "a"),
        "network": (classifiers.network().set_params(classify__stages=few), classes),
        "network of two": (classifiers.network().set_params(classify__stages=few), classes == "a"),
        "ridge": (regressors.kernel_ridge(), places),
        "places": (regressors.network().set_params(regress__regressor__stages=few), places),
    }
    pipeline, y = made[name]
    return pipeline.fit(X, y)


KINDS = [
    "pairs",
    "pairs of two",
    "components",
    "components of two",
    "network",
    "network of two",
    "ridge",
    "places",
]


def arrays_of(value, path=()):
    """Paths of all arrays of a fitted estimator."""
    if isinstance(value, np.ndarray):
        yield path
    elif isinstance(value, list | tuple):
        for number, part in enumerate(value):
            yield from arrays_of(part, (*path, number))
    elif hasattr(value, "__dict__") and not isinstance(value, type):
        for name, part in vars(value).items():
            yield from arrays_of(part, (*path, name))


def held_by(value, path):
    for part in path:
        value = value[part] if isinstance(part, int) else getattr(value, part)
    return value


UNUSED = {"_best_coefs", "_best_intercepts", "n_iter_", "_num_iter"}
"""Arrays that no answer depends on."""


def put(value, path, part):
    """A copy with another part at the path."""
    changed = copy.deepcopy(value)
    holder = held_by(changed, path[:-1])
    if isinstance(path[-1], int):
        holder[path[-1]] = part
    else:
        object.__setattr__(holder, path[-1], part)
    return changed


def used(value):
    """Paths of the arrays that an answer depends on."""
    for path in arrays_of(value):
        if not {*path[-2:]} & UNUSED and held_by(value, path).size:
            yield path


@pytest.mark.parametrize("name", KINDS)
def test_no_array_of_an_estimator_may_be_of_another_size_or_type(name):
    whole = fitted(name)
    check_estimator(whole, FEATURES, "pipeline")
    for path in used(whole):
        array = held_by(whole, path)
        for changed in (array[:-1], np.concatenate([array, array[:1]]), array[None], str(array)):
            with pytest.raises(UnsoundError):
                check_estimator(put(whole, path, changed), FEATURES, "pipeline")


def spoilt_arrays(array):
    """The same array in ways that no fit leaves it."""
    flat = np.arange(array.size).reshape(array.shape) == array.size - 1
    yield from (array[..., None], np.full(array.shape, "a"), array[:0])
    if array.dtype.kind == "f":
        yield from (np.where(flat, x, array) for x in (np.nan, np.inf, -np.inf))
    elif array.dtype.kind == "i":
        yield from (array - 1000, array + 10**6)


def test_no_array_of_a_model_may_be_spoilt(model):
    check_sound(model.learned, model.problem.features)
    for place in used(model.learned):
        for changed in spoilt_arrays(held_by(model.learned, place)):
            with pytest.raises(UnsoundError):
                check_sound(put(model.learned, place, changed), model.problem.features)


def test_what_does_not_fit_is_reported_where_the_digest_is_right(model, tmp_path):
    place = "pipeline", "steps", 2, 1, "_n_support"
    array = held_by(model.learned, place)
    path = tmp_path / "model.npz"
    save(path, replace(model, learned=put(model.learned, place, array + 1)))
    with pytest.raises(
        InputError, match=r"model\.npz: damaged or forged: `pipeline\.classify` must"
    ):
        load(path)
