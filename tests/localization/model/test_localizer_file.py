import io
import json
import pickle
from dataclasses import replace
from zipfile import ZipFile

import numpy as np
import pytest
import skops.io
from rcskin.localization.inputs.feature_names import PAPER
from rcskin.localization.inputs.features import features
from rcskin.localization.model.localizer_file import load, save
from rcskin.localization.model.model_fields import fields_of
from rcskin.localization.model.training import train
from rcskin.simulator.sweeps import InputError
from sklearn.pipeline import Pipeline
from sklearn.preprocessing import MinMaxScaler


@pytest.fixture(scope="module")
def model(strip):
    return train(strip)


def rewrite(source, target, change):
    """The archive at `source` with its schema changed by a function of the text."""
    with ZipFile(source) as old, ZipFile(target, "w") as new:
        for name in old.namelist():
            data = old.read(name)
            new.writestr(name, change(data.decode()) if name == "schema.json" else data)


@pytest.mark.parametrize("classifier", ["ksvm-ovo", "ksvm-components", "gaussian"])
@pytest.mark.parametrize("target", ["column", "pixel"])
def test_a_model_read_back_is_the_same_model(sheet, tmp_path, classifier, target):
    model = train(sheet, target, classifier, quantities=PAPER)
    save(tmp_path / "model.npz", model)
    again = load(tmp_path / "model.npz")
    X = features(sheet)
    np.testing.assert_array_equal(again.predict(sheet), model.predict(sheet))
    np.testing.assert_array_equal(
        again.pipeline.decision_function(X), model.pipeline.decision_function(X)
    )
    assert replace(again, learned=model.learned) == model
    np.testing.assert_array_equal(again.fingerprints, model.fingerprints)
    assert (again.learned.sharpness, again.learned.threshold) == (
        model.learned.sharpness,
        model.learned.threshold,
    )


@pytest.mark.parametrize(
    ("scene", "message"),
    [("", "on sweeps without a scene"), ('name = "line"\n', "`skin.length`, .* are missing")],
)
def test_where_a_scene_is_needed_a_file_without_a_whole_one_is_named(
    model, tmp_path, scene, message
):
    other = replace(model, problem=replace(model.problem, scene=scene))
    save(tmp_path / "other.npz", other)
    with pytest.raises(InputError, match=rf"other\.npz: .*{message}"):
        _ = load(tmp_path / "other.npz").known_scene
    assert load(tmp_path / "other.npz").classes == model.classes


def test_a_file_is_read_without_pickle(model, tmp_path, monkeypatch):
    """Whatever it is: a model, a pickle, or a model in which an array is a pickle."""
    save(tmp_path / "good.npz", model)
    with ZipFile(tmp_path / "good.npz") as good, ZipFile(tmp_path / "bad.npz", "w") as bad:
        for name in good.namelist():
            array = io.BytesIO()
            np.save(array, np.array([{}], dtype=object), allow_pickle=True)
            bad.writestr(name, good.read(name) if name == "schema.json" else array.getvalue())
    (tmp_path / "pickle.npz").write_bytes(pickle.dumps(model.classes))
    for name in ("load", "loads", "Unpickler"):
        monkeypatch.setattr(pickle, name, None)
    assert load(tmp_path / "good.npz").classes == model.classes
    for name in ("bad.npz", "pickle.npz"):
        with pytest.raises(InputError, match=name):
            load(tmp_path / name)


def test_a_file_tampered_to_build_another_type_is_refused(model, tmp_path):
    save(tmp_path / "good.npz", model)
    rewrite(
        tmp_path / "good.npz",
        tmp_path / "bad.npz",
        lambda schema: schema.replace("rcskin.localization.learners.ecoc", "os").replace(
            "ECOCClassifier", "system"
        ),
    )
    with pytest.raises(InputError, match=r"bad\.npz: holds the untrusted type os\.system"):
        load(tmp_path / "bad.npz")


def test_a_file_of_a_foreign_type_is_refused(model, tmp_path):
    skops.io.dump({"pipeline": model}, tmp_path / "a.npz")
    with pytest.raises(
        InputError,
        match=r"a\.npz: .*untrusted type rcskin\.localization\.inputs.*\.LocalizationProblem",
    ):
        load(tmp_path / "a.npz")


def test_a_file_of_harmless_types_that_is_no_model_is_refused(model, tmp_path):
    fields = fields_of(model)
    other = Pipeline([("scale", MinMaxScaler())])
    for content in ([1, 2], {"pipeline": 3}, {**fields, "guard": 4}, {**fields, "pipeline": other}):
        skops.io.dump(content, tmp_path / "a.npz")
        with pytest.raises(InputError, match=r"a\.npz: holds no model of rcskin"):
            load(tmp_path / "a.npz")


def earlier(schema):
    """The schema of a file of the layout before, as far as its types tell."""
    return schema.replace("rcskin.localization.trust.kinds", "rcskin.localization.trust.novelty")


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("ksvm-ovo", "a model of another layout .* train it again"),
        ("svc", "its estimator svc was removed, .*: use ksvm-ovo, and train it again"),
        ("knn", "its estimator knn was removed, .*: use ksvm-components, and train it again"),
    ],
)
def test_a_model_of_an_earlier_version_names_what_to_take(model, tmp_path, name, message):
    save(tmp_path / "new.npz", replace(model, estimator=name))
    rewrite(tmp_path / "new.npz", tmp_path / "old.npz", earlier)
    with pytest.raises(InputError, match=rf"old\.npz: {message}$"):
        load(tmp_path / "old.npz")


def test_a_damaged_file_is_refused_in_one_line(model, tmp_path):
    save(tmp_path / "good.npz", model)
    whole = (tmp_path / "good.npz").read_bytes()
    path = tmp_path / "bad.npz"
    for data in (b"", b"target,output,count\n", whole[: len(whole) // 2]):
        path.write_bytes(data)
        with pytest.raises(InputError, match=r"bad\.npz: not a model in the format of skops") as e:
            load(path)
        assert "\n" not in str(e.value)


@pytest.mark.parametrize(("name", "told"), [("my.toml", "is a scene"), ("run.nc", "are sweeps")])
def test_what_is_no_model_is_named_by_what_it_is(name, told, tmp_path):
    (tmp_path / name).write_bytes(b"\x89HDF")
    with pytest.raises(InputError, match=f"{told}, a model is expected here: a .npz"):
        load(tmp_path / name)


@pytest.mark.parametrize("change", [lambda schema: "{}", lambda schema: schema[:-20], json.dumps])
def test_an_archive_without_a_sound_schema_is_refused(model, tmp_path, change):
    save(tmp_path / "good.npz", model)
    rewrite(tmp_path / "good.npz", tmp_path / "bad.npz", change)
    with pytest.raises(InputError, match=r"bad\.npz: not a model in the format of skops"):
        load(tmp_path / "bad.npz")


def test_a_file_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"none\.npz: no such file"):
        load(tmp_path / "none.npz")


@pytest.mark.parametrize(
    ("name", "message"), [("a.pkl", "must end in .npz"), ("no/a.npz", "does not exist")]
)
def test_a_path_that_cannot_be_written_is_refused(model, tmp_path, name, message):
    with pytest.raises(InputError, match=message):
        save(tmp_path / name, model)


@pytest.mark.usefixtures("replacing")
def test_a_save_that_fails_leaves_the_old_file_as_it_was(model, tmp_path):
    path = tmp_path / "model.npz"
    save(path, model)
    before = path.read_bytes()
    with pytest.raises(Exception, match="generator"):
        save(path, replace(model, validation=(letter for letter in "unsaveable")))
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


def test_a_file_of_before_all_had_one_name_must_be_trained_anew(model, tmp_path):
    save(tmp_path / "good.npz", model)
    rewrite(
        tmp_path / "good.npz",
        tmp_path / "old.npz",
        lambda schema: schema.replace("rcskin.localization.", "localization."),
    )
    with pytest.raises(InputError, match=r"old\.npz: a model of another layout .* train it again"):
        load(tmp_path / "old.npz")
