import io
import json
import pickle
import subprocess
import sys
import tracemalloc
from dataclasses import replace
from zipfile import ZipFile

import numpy as np
import pytest
from rcskin.localization.inputs.features import PAPER, features
from rcskin.localization.model.localizer_file import load, save
from rcskin.localization.model.training import train
from rcskin.simulator.sweeps import InputError, digests, write
from rcskin.simulator.sweeps.array_files import DESCRIPTION
from rcskin.simulator.sweeps.digests import MEMBER


@pytest.fixture(scope="module")
def model(strip):
    return train(strip)


def rewrite(source, target, change):
    """The archive at `source` with its description changed by a function of the text."""
    with ZipFile(source) as old, ZipFile(target, "w") as new:
        for name in old.namelist():
            data = old.read(name)
            if name == DESCRIPTION:
                data = change(data.decode())
            if name != MEMBER:
                new.writestr(name, data)


def described(change):
    """A function of the text that changes its content."""

    def changed(text):
        content = json.loads(text)
        change(content)
        return json.dumps(content)

    return changed


@pytest.mark.parametrize("classifier", ["ksvm-ovo", "ksvm-components", "gaussian"])
@pytest.mark.parametrize("target", ["column", "pixel"])
def test_a_model_read_back_is_the_same_model(sheet, tmp_path, classifier, target):
    model = train(sheet, target, classifier, quantities=PAPER)
    save(tmp_path / "model.npz", model)
    again = load(tmp_path / "model.npz")
    X = features(sheet)
    np.testing.assert_array_equal(again.predict(sheet), model.predict(sheet))
    np.testing.assert_array_equal(again.predictor.decisions(X), model.predictor.decisions(X))
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
            bad.writestr(name, array.getvalue() if name.endswith(".npy") else good.read(name))
    (tmp_path / "pickle.npz").write_bytes(pickle.dumps(model.classes))
    for name in ("load", "loads", "Unpickler"):
        monkeypatch.setattr(pickle, name, None)
    assert load(tmp_path / "good.npz").classes == model.classes
    for name in ("bad.npz", "pickle.npz"):
        with pytest.raises(InputError, match=name):
            load(tmp_path / name)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda own: own["learned"]["predictor"].update(kind="system"), "is of another kind"),
        (lambda own: own["learned"]["predictor"].update(kind="KindGuard"), "is of another kind"),
        (lambda own: own["learned"].update(more=1), "`learned` has other fields than its kind"),
        (lambda own: own["learned"].pop("threshold"), "`learned` has other fields than its kind"),
        (
            lambda own: own["learned"].update(sharpness="1"),
            "`learned.sharpness` is of another type",
        ),
        (lambda own: own["learned"].update(sharpness=-1), "`learned.sharpness` must be >0"),
        (lambda own: own["learned"].update(sharpness=10**400), "sharpness` must be finite"),
        (lambda own: own["learned"].update(held_out=True), "`learned.held_out` is of another type"),
        (lambda own: own["problem"].update(target="depth"), "`problem.target` must be one of"),
        (lambda own: own["problem"].update(features=39), "`problem.features` must be 40"),
        (lambda own: own["problem"].update(quantities=["Rs", "me"]), "must be of features"),
        (lambda own: own.update(fingerprints="none"), "`fingerprints` is missing"),
        (lambda own: own.update(fingerprints="learned.predictor.classes"), "without a place"),
        (lambda own: own["versions"].update(rcskin=1), "`versions.rcskin` is of another type"),
        (lambda own: own.update(gate=own | {"gate": None}), "`gate` is for positions"),
    ],
)
def test_a_forged_description_is_refused_by_what_is_wrong(model, tmp_path, change, message):
    save(tmp_path / "good.npz", model)
    forged = described(lambda content: change(content["model"]))
    rewrite(tmp_path / "good.npz", tmp_path / "bad.npz", forged)
    with pytest.raises(InputError, match=rf"^[^\n]*bad\.npz: [^\n]*{message}"):
        load(tmp_path / "bad.npz")


def test_a_file_of_an_older_version_says_to_train_again(model, tmp_path):
    save(tmp_path / "new.npz", model)
    older = described(lambda content: content.update(layout=10))
    rewrite(tmp_path / "new.npz", tmp_path / "old.npz", older)
    (tmp_path / "m.skops").write_bytes(b"PK")
    for name in ("old.npz", "m.skops"):
        expected = rf"{name}: a model of another version of rcskin: train it again \(rcskin train"
        with pytest.raises(InputError, match=expected):
            load(tmp_path / name)


@pytest.mark.parametrize("nested", [1, 3, 1000])
def test_a_model_within_models_is_refused(model, tmp_path, nested):
    def nest(content):
        for _ in range(nested):
            content["model"] = {**content["model"], "gate": content["model"]}

    save(tmp_path / "good.npz", model)
    changed = described(nest) if nested < 100 else lambda text: '{"a":' * 10**5
    rewrite(tmp_path / "good.npz", tmp_path / "bad.npz", changed)
    with pytest.raises(InputError, match=r"^[^\n]*bad\.npz: [^\n]*$"):
        load(tmp_path / "bad.npz")


@pytest.mark.parametrize(
    ("shape", "kind"), [((10**12,), "<f8"), ((2**31, 2**31, 2**31), "<f8"), ((3,), "O")]
)
def test_a_size_that_a_file_does_not_have_takes_no_memory(model, tmp_path, shape, kind):
    save(tmp_path / "good.npz", model)
    array = io.BytesIO()
    header = {"descr": kind, "fortran_order": False, "shape": shape}
    np.lib.format.write_array_header_1_0(array, header)
    with ZipFile(tmp_path / "good.npz") as good, ZipFile(tmp_path / "bad.npz", "w") as bad:
        bad.writestr(DESCRIPTION, good.read(DESCRIPTION))
        bad.writestr("fingerprints.npy", array.getvalue() + 24 * b"0")
    tracemalloc.start()
    with pytest.raises(InputError, match=r"bad\.npz: not a model of rcskin: an array of"):
        load(tmp_path / "bad.npz")
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 10**7


def test_a_model_is_read_and_answers_without_scikit_learn(model, strip, tmp_path):
    save(tmp_path / "m.npz", model)
    write(strip, tmp_path / "strip.nc")
    code = (
        "import sys; sys.modules.update(dict.fromkeys(['sklearn', 'torch', 'skops']))\n"
        "import rcskin\n"
        "print(*rcskin.localize(sys.argv[1], sys.argv[2]).labels, sep=',')\n"
        "rcskin.evaluate(sys.argv[1], sys.argv[2])"
    )
    files = [tmp_path / "m.npz", tmp_path / "strip.nc"]
    command = [sys.executable, "-c", code, *files]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert not done.returncode, done.stderr
    assert done.stdout.strip().split(",") == model.answers(strip).labels.tolist()


def test_a_damaged_file_is_refused_in_one_line(model, tmp_path):
    save(tmp_path / "good.npz", model)
    whole = (tmp_path / "good.npz").read_bytes()
    path = tmp_path / "bad.npz"
    for data in (b"", b"target,output,count\n", whole[: len(whole) // 2]):
        path.write_bytes(data)
        with pytest.raises(InputError, match=r"bad\.npz: not a model of rcskin") as e:
            load(path)
        assert "\n" not in str(e.value)


@pytest.mark.parametrize(("name", "told"), [("my.toml", "is a scene"), ("run.nc", "are sweeps")])
def test_what_is_no_model_is_named_by_what_it_is(name, told, tmp_path):
    (tmp_path / name).write_bytes(b"\x89HDF")
    with pytest.raises(InputError, match=f"{told}, a model is expected here: a .npz"):
        load(tmp_path / name)


@pytest.mark.parametrize("change", [lambda text: "{}", lambda text: text[:-20], json.dumps])
def test_an_archive_without_a_sound_description_is_refused(model, tmp_path, change):
    save(tmp_path / "good.npz", model)
    rewrite(tmp_path / "good.npz", tmp_path / "bad.npz", change)
    with pytest.raises(InputError, match=r"bad\.npz: not a model of rcskin"):
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
def test_a_save_that_fails_leaves_the_old_file_as_it_was(model, tmp_path, monkeypatch):
    path = tmp_path / "model.npz"
    save(path, model)
    before = path.read_bytes()
    monkeypatch.setattr(digests, "seal_archive", None)
    with pytest.raises(TypeError):
        save(path, replace(model, validation="another"))
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]
