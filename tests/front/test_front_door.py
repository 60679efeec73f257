"""`import rcskin`: light, complete by tab, and the same answers as the command line."""

import inspect
import re
import subprocess
import sys
from functools import partial
from importlib.metadata import version

import numpy as np
import pytest
import rcskin
from rcskin.localization.study.axis import axes_of, scene_table
from rcskin.simulator.sweeps import InputError
from rcskin.tests.refusals import refusal_of


@pytest.fixture(scope="module")
def scene():
    return rcskin.load("sheet-3x3")


@pytest.fixture(scope="module")
def sweeps(scene):
    return rcskin.sweep(scene, rtol=1e-3)


def test_importing_it_imports_nothing_else():
    loaded = "import sys, rcskin; print({'numpy', 'xarray', 'pydantic'} & set(sys.modules))"
    told = subprocess.run(
        [sys.executable, "-c", loaded], capture_output=True, text=True, check=True
    )
    assert told.stdout.strip() == "set()"


def test_tab_completes_every_name_and_each_says_what_it_does():
    assert dir(rcskin) == sorted(rcskin.__all__)
    for name in rcskin.__all__:
        assert inspect.getdoc(getattr(rcskin, name)), name


def test_sweeps_of_texts_and_of_all_pixels(scene, sweeps):
    some = rcskin.sweep(scene, ["none", "1,2"], rtol=1e-3)
    assert sweeps.sizes["sweep"] == 10
    assert list(some["press"].values) == ["none", "1,2:2.0"]
    both = sweeps.set_index(sweep="press").sel(sweep=list(some["press"].values))
    assert np.array_equal(both["Rs"], some["Rs"])


def test_one_press_needs_no_list(scene, sweeps):
    press = rcskin.Press()
    for rest in ("none", press, ["none"], (press,)):
        assert rcskin.sweep(scene, rest, rtol=1e-3).sizes["sweep"] == 1


def test_classes_are_there_and_other_names_are_not(scene):
    assert isinstance(scene, rcskin.Scene) and rcskin.InputError is InputError
    assert issubclass(rcskin.ToleranceError, RuntimeError) and rcskin.Model.__doc__
    with pytest.raises(AttributeError, match="sweeps"):
        _ = rcskin.sweeps


def test_a_scene_by_its_name_is_the_scene(sweeps):
    assert rcskin.sweep("sheet-3x3", rtol=1e-3).identical(sweeps)
    with pytest.raises(InputError, match="sheet-33"):
        rcskin.sweep("sheet-33")


def test_a_changed_scene_is_another_skin(scene, sweeps):
    double = scene.with_({"skin.sheet_resistance": 2 * scene.skin.top.sheet_resistance})
    faster = double.with_({"sweep.frequencies": (scene.frequencies / 2).tolist()})
    scaled = rcskin.sweep(faster, ["none"], rtol=1e-3)
    np.testing.assert_allclose(scaled["Rs"][0], 2 * sweeps["Rs"][0], rtol=2e-3)


@pytest.mark.parametrize(
    "changes, told",
    [
        ({"contact.9.resistance": 1}, "`contact.9.resistance`: there is no '9'"),
        ({"pixels": 0}, "`pixels.rows` must be >= 1, got 0"),
        ({"pixels.rows.x": 1}, "`pixels.rows.x`: there is no 'x'"),
    ],
)
def test_a_change_that_cannot_be_is_reported_in_one_line(scene, changes, told):
    assert told in refusal_of(scene.with_, changes)


def test_parts_of_lists_go_by_number_and_by_name(scene):
    name = scene.contacts[1].name
    by_number = scene.with_({"contact.2.resistance": 0.5})
    assert by_number == scene.with_({f"contact.{name}.resistance": 0.5})
    assert by_number.contacts[1].resistance == 0.5
    assert by_number.with_({"contact.2.resistance": None}) == scene


def test_features_train_and_localize(scene):
    pixels = [f"{row},{column}" for row in (1, 2, 3) for column in (1, 2, 3)]
    known = rcskin.sweep(scene, [f"{p}:{k}" for k in (1.8, 2.0, 2.2) for p in pixels], rtol=1e-3)
    X, y = rcskin.features(known, target="column")
    assert len(X) == len(y) == 27 and set(y) == {1, 2, 3}
    told = rcskin.localize(rcskin.train(known, "column"), known)
    assert np.mean(told.labels.astype(str) == y.astype(str)) > 0.9
    assert repr(told).startswith("Answers to 27 sweeps\n")
    assert repr(told).endswith("  7 more rows")


@pytest.fixture(scope="module")
def skins():
    """Sweeps of two sessions on random skins, to learn from, and of another one."""
    strip = rcskin.load("strip-1x3").with_({"dataset.session.sweeps_per_session": 100})
    return rcskin.dataset(strip, 200, seed=1), rcskin.dataset(strip, 100, seed=2)


def test_a_model_is_trained_in_memory_and_on_disk_and_asked_by_its_path(skins, tmp_path):
    known, unseen = skins
    model = rcskin.train(known)
    assert model.quantities == ("dlnZ", "dphase")
    path = tmp_path / "m.npz"
    rcskin.write(model, path)
    labels = rcskin.localize(path, unseen).labels
    np.testing.assert_array_equal(labels, rcskin.localize(str(path), unseen).labels)
    np.testing.assert_array_equal(labels, rcskin.localize(rcskin.load_model(path), unseen).labels)
    found = rcskin.evaluate(path, unseen)
    assert found.figures == rcskin.evaluate(model, unseen).figures
    assert found["right of all"] == found.accuracy > 0.9 and "calibration error" in repr(found)
    assert {found.answered, found.accuracy_of_answers, found.calibration_error} <= {
        value for value, _ in found.figures.values()
    }
    with pytest.raises(InputError, match="of `target` column has no figure 'median error, mm'"):
        _ = found.median_error
    assert "ksvm-ovo" in repr(model) and len(repr(model).splitlines()) == 3
    assert "guess without a sweep" in model._repr_html_() and "calibration error" in repr(found)
    assert (
        "right of those answered" in found._repr_html_() and found._repr_html_().count("<svg") == 1
    )
    assert rcskin.train(known, estimator="model-based").target == "column"


def test_a_data_set_in_memory_is_the_one_on_disk(run, tmp_path):
    told = ("--sweeps", 40, "--seed", 3, "--workers", 1)
    run("dataset", "strip-1x3", *told, "-o", tmp_path / "a.zarr")
    stored, made = rcskin.read(tmp_path / "a.zarr"), rcskin.dataset("strip-1x3", 40, seed=3)
    np.testing.assert_array_equal(made["press"], stored["press"])
    np.testing.assert_allclose(made["Cp"], stored["Cp"], rtol=1e-6)
    np.testing.assert_allclose(made["touch_x"], stored["touch_x"], rtol=1e-6)


def test_features_are_named_as_on_the_command_line(skins):
    known, _ = skins
    by_default, y = rcskin.features(known)
    for named in ("dlnZ,dphase", ("dlnZ", "dphase")):
        X, again = rcskin.features(known, quantities=named)
        np.testing.assert_array_equal(X, by_default)
        np.testing.assert_array_equal(again, y)
    pressed = known.isel(sweep=known["row"].values > 0)
    as_read = rcskin.features(pressed, quantities="Rs,Cp")[0]
    np.testing.assert_array_equal(rcskin.features(pressed)[0], as_read)


def test_features_number_their_sweeps_and_say_which_are_left_out(scene, caplog):
    mixed = rcskin.sweep(scene, ["2,1", "none", "1,2", "1,1+2,2", "3,3"], rtol=1e-3)
    found = rcskin.features(mixed, "column")
    X, y = found
    assert list(found.index) == [2, 4] and list(y) == [2, 3] and X is found.X
    why = "1 not of a press of one pixel, 2 with no unpressed sweep before them"
    assert found.left_out == f"left out: {why}" and why in repr(found)
    assert [each.getMessage() for each in caplog.records] == [
        f"features of column: left out: {why}"
    ]
    assert rcskin.features(mixed[{"sweep": [2]}], "column", "Rs,Cp").left_out == "none left out"
    assert len(caplog.records) == 1


def test_a_scene_prints_as_the_command_describes_it(run, scene):
    assert f"{scene}\n" == run("describe", "sheet-3x3")[1]


def test_a_data_set_of_one_skin_or_without_noise_says_so(run, tmp_path, caplog):
    told = ("--sweeps", 20, "--workers", 1, "-o", tmp_path / "a.zarr")
    _, out, _ = run("dataset", "strip-1x3", *told)
    exact = rcskin.load("strip-1x3").with_({"readout": {}})
    rcskin.dataset(exact, 20)
    noise, one = (each.getMessage() for each in caplog.records)
    assert "free of noise" in noise
    assert one.startswith("strip-1x3: all sweeps are of one skin, because a session has 500; ")
    assert one.removeprefix("strip-1x3: ").replace("sweeps=", "--sweeps ") in out
    caplog.clear()
    several = {"dataset.session.sweeps_per_session": 10}
    rcskin.dataset(rcskin.load("strip-1x3").with_(several), 20)
    assert not caplog.records


def test_noise_is_the_meters_of_the_scene(scene, sweeps):
    shown = rcskin.measured(sweeps, seed=3)
    off = np.log(np.hypot(shown["Rs"], shown["X"]) / np.hypot(sweeps["Rs"], sweeps["X"]))
    deviation = off.values.std()
    assert deviation == pytest.approx(scene.readout.magnitude_noise, rel=0.3)
    assert rcskin.measured(sweeps, seed=3).identical(shown)
    with pytest.raises(InputError, match="store no scene"):
        rcskin.measured(sweeps.drop_attrs())


def test_the_version_is_that_of_the_package():
    assert rcskin.__version__ == version("rcskin")


def test_files_come_back_as_they_went(scene, sweeps, tmp_path):
    rcskin.write(scene, tmp_path / "own.toml")
    assert rcskin.load(tmp_path / "own.toml") == scene
    rcskin.write(sweeps, tmp_path / "all.nc")
    assert np.array_equal(rcskin.read(tmp_path / "all.nc")["Cp"], sweeps["Cp"])


def test_what_exists_is_replaced_on_demand_only(scene, sweeps, tmp_path):
    study = rcskin.study("strip-1x3", {"pixels.columns": [2, 3]}, repetitions=5)
    writers = {
        "own.toml": partial(rcskin.write, scene),
        "all.csv": partial(rcskin.write, sweeps),
        "all.png": partial(rcskin.plot, sweeps),
        "all.html": partial(rcskin.plot, sweeps),
        "study.csv": study.write,
        "study.png": study.plot,
    }
    for name, write in writers.items():
        path = tmp_path / name
        path.write_text("mine")
        with pytest.raises(InputError, match=f"{name}: already exists; .*overwrite.* replaces it"):
            write(path)
        assert path.read_text() == "mine"
        write(path, overwrite=True)
        assert path.stat().st_size > 100, name
    rcskin.write(sweeps.drop_attrs(), tmp_path / "run.nc")
    with pytest.raises(InputError, match="measured sweeps; `overwrite_measured=True` replaces it"):
        rcskin.write(sweeps, tmp_path / "run.nc", overwrite=True)
    rcskin.write(sweeps, tmp_path / "run.nc", overwrite_measured=True)


def test_a_reduced_model_answers_as_the_sweep(scene):
    reduced = rcskin.reduce(scene, 1e-3)
    exact = rcskin.sweep(scene, "1,2:2", rtol=1e-3)
    Z = reduced.solve("1,2:2", scene.frequencies).Z
    np.testing.assert_allclose(Z.real, exact["Rs"].values[0], rtol=2e-3)
    assert "3 x 3" in repr(reduced) and len(repr(reduced).splitlines()) == 3
    assert all(each in reduced._repr_html_() for each in ("Rs (", "Cp (", "3,3", "unpressed"))


def test_limits_are_a_share(scene):
    limit = rcskin.limits(scene, "column", draws=200)
    assert 1 / 3 < limit.accuracy <= 1 and 0 <= limit.standard_error < 0.1
    assert tuple(limit) == (limit.accuracy, limit.standard_error)
    assert f"{limit.accuracy:.4f}" in repr(limit) and limit._repr_html_().count("<svg") == 1
    given = {"distribution": "uniform", "low": 1.01, "high": 1.02}
    assert rcskin.limits(scene, presses=given, draws=200).accuracy < limit.accuracy


def test_a_study_is_the_one_on_the_command_line(run, tmp_path):
    told = ("--vary", "pixels.columns=2,3", "--repetitions", 5, "--workers", 1)
    run("study", "strip-1x3", *told, "-o", tmp_path / "all.csv")
    study = rcskin.study("strip-1x3", {"pixels.columns": range(2, 4)}, repetitions=5)
    study.write(tmp_path / "again.csv")
    assert (tmp_path / "again.csv").read_bytes() == (tmp_path / "all.csv").read_bytes()
    assert study.findings["accuracy"].shape == (2,) and "accuracy_sd" in repr(study)
    assert study.best[0].startswith("best accuracy ")
    assert "; 5 presses of each pixel" in repr(study).splitlines()[0]


@pytest.mark.parametrize("values, even", [([1e4, 1e5, 1e6], True), ([1e4, 2e4, 3e4], False)])
def test_values_by_ratio_stand_on_a_logarithmic_axis(scene, values, even):
    (axis,) = axes_of({"skin.sheet_resistance": values}, scene_table(scene))
    assert (axis.logarithmic, axis.linear) == (even, not even)


def test_a_skin_is_calibrated_to_its_own_sweeps(scene, sweeps):
    found = rcskin.calibrate(scene, sweeps)
    assert "both in series  " in repr(found) and "loss_tangent" in found._repr_html_()
    assert {"|Z|", "phase", "unpressed"} <= set(
        re.findall("<text[^>]*>([^<]*)", found._repr_html_())
    )
    both = found.scene.skin.top.sheet_resistance + found.scene.skin.bottom.sheet_resistance
    assert both == pytest.approx(2 * scene.skin.top.sheet_resistance, rel=1e-2)


@pytest.mark.parametrize(
    "ending", ["png", *(pytest.param(e, marks=pytest.mark.slow) for e in ("svg", "html"))]
)
def test_sweeps_are_drawn(sweeps, tmp_path, ending):
    assert rcskin.plot(sweeps, tmp_path / f"all.{ending}").stat().st_size > 5_000
