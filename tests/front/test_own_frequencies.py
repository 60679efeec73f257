"""A scene whose interfaces have frequencies of their own, through every command that takes one."""

import csv
import json

import numpy as np
import pandas as pd
import pytest
import rcskin
from rcskin import __main__ as front
from rcskin.localization.inputs.baselines import read_first
from rcskin.simulator.scene.scene_files import scene_text
from rcskin.simulator.sweeps import read
from typer.testing import CliRunner

FREQUENCIES = [1e3, 3e3, 1e4, 1e5]
TAKEN = np.array([[True, True, True, False], [False, True, True, True]])
READINGS = int(TAKEN.sum())
READOUT = {
    "magnitude_accuracy": 2e-3,
    "phase_accuracy": 2e-3,
    "magnitude_noise": 2e-3,
    "phase_noise": 2e-3,
}


def command(*arguments):
    done = CliRunner().invoke(front.app, [*map(str, arguments)])
    assert done.exit_code == 0, (arguments, done.output, done.exception)
    return done.output


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("own")


@pytest.fixture(scope="module")
def scene(folder):
    changes = {
        "pixels": 2,
        "sweep.frequencies": FREQUENCIES,
        "interface.1.frequencies": FREQUENCIES[:3],
        "interface.2.frequencies": FREQUENCIES[1:],
        "readout": READOUT,
        "press.factor_spread": 0.05,
        "dataset.session": {"sweeps_per_session": 60, "unevenness": 0.0},
        "experiment": {"repetitions": 5, "unpressed": True},
    }
    path = folder / "own.toml"
    changed = rcskin.load("sheet-5x5-two-interfaces").with_(changes)
    path.write_text(scene_text(changed), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def data(scene, folder):
    path = folder / "skins.zarr"
    command("dataset", scene, "--sweeps", 240, "--rtol", 1e-2, "--workers", 1, "-o", path)
    return path


@pytest.fixture(scope="module")
def model(data, folder):
    path = folder / "m.npz"
    asked = ("--estimator", "model-based", "--target", "pixel", "--features", "dlnZ,dphase")
    command("train", data, *asked, "-o", path)
    return path


def test_a_data_set_is_exported_as_what_was_read(data, folder):
    for ending in ("nc", "csv", "parquet"):
        command("export", data, "-o", folder / f"out.{ending}")
    whole, long, wide = read(data), read(folder / "out.csv"), folder / "out.parquet"
    np.testing.assert_array_equal(long["taken"].values, TAKEN)
    for name in ("Rs", "X", "Cp"):
        np.testing.assert_array_equal(whole[name].values, long[name].values.astype("f4"))
        np.testing.assert_array_equal(whole[name].values, read(folder / "out.nc")[name].values)
    table = pd.read_parquet(wide)
    spectra = [name for name in table.columns if name.startswith(("Rs_", "X_", "Cp_"))]
    assert len(spectra) == 3 * READINGS and np.isfinite(table[spectra].to_numpy()).all()
    text = (folder / "out.csv").read_text()
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    assert len(lines) == 1 + READINGS * whole.sizes["sweep"]


def test_data_sets_are_joined_by_what_was_read(data):
    joined = read_first([data, data], 1000)
    assert joined.sizes["sweep"] == 480
    np.testing.assert_array_equal(joined["taken"].values, TAKEN)


@pytest.mark.usefixtures("unpainted")
def test_a_localizer_that_inverts_the_simulator_is_trained_asked_and_adapted(
    scene, data, model, folder
):
    command("evaluate", model, data, "-o", folder / "found")
    figures = (folder / "found" / "figures.csv").read_text().splitlines()
    assert float(next(row for row in csv.reader(figures) if row[0] == "right of all")[1]) > 0.5
    out = command("adapt", model, data, "-o", folder / "better.npz")
    assert "after:" in out and "model: adapted by" in out
    command("localize", folder / "better.npz", data, "-o", folder / "told.csv")


@pytest.mark.slow
def test_a_gap_is_reported_for_what_both_sides_read(scene, folder, monkeypatch):
    monkeypatch.setattr("rcskin.localization.gap.gap_report.charts_of", lambda *given: [])
    presses = [each for k in range(4) for each in ("none", "1,1", "1,2", "2,1", "2,2")]
    asked = [part for press in presses for part in ("--press", press)]
    command("sweep", scene, *asked, "--rtol", "1e-3", "-o", folder / "sim.nc")
    other = rcskin.load(scene).with_({"skin.sheet_resistance": 55e3})
    sweeps = rcskin.sweep(other, presses, rtol=1e-3)
    noisy = sweeps.copy(deep=True)
    random = np.random.default_rng(1)
    for name in ("Rs", "X", "Cp"):
        noisy[name] = noisy[name] * (1 + 2e-3 * random.standard_normal(noisy[name].shape))
    rcskin.write(noisy.drop_vars(["Rs_error", "Cp_error"]), folder / "other.nc")
    command("gap", folder / "sim.nc", folder / "other.nc", "--draws", 1, "-o", folder / "gap")
    told = next((folder / "gap").glob("*.json"))
    numbers = json.loads(told.read_text(), parse_constant=pytest.fail)
    mean = numbers["distance"]["before"]["pressed"]["Rs"]["mean"]
    assert [[each is not None for each in line] for line in mean] == TAKEN.tolist()


def test_a_field_is_shown_at_the_frequencies_of_its_interface(scene, folder):
    out = command("view", scene, "--interface", "bottom", "-o", folder / "field.xdmf")
    assert "at 3 frequencies" in out


@pytest.mark.usefixtures("unpainted", "short_studies")
def test_a_study_counts_what_is_read(scene, folder):
    asked = (
        "--vary",
        "skin.sheet_resistance=5e4",
        "--draws",
        "1",
        "--workers",
        "1",
        "--rtol",
        "1e-2",
    )
    tables = []
    for name, more in (("whole", ()), ("low", ("--max-frequency", "1e4"))):
        command("study", scene, *asked, *more, "-o", folder / f"{name}.csv")
        tables.append(pd.read_csv(folder / f"{name}.csv", comment="#"))
    name = next(each for each in tables[0].columns if "median" in each)
    assert (tables[0][name] > tables[1][name]).all()
    done = CliRunner().invoke(
        front.app,
        ["study", str(scene), "--max-frequency", "2e3", "-o", str(folder / "none.csv")],
    )
    assert "below all `frequencies` of interface bottom" in str(done.exception or done.output)


def test_a_page_states_which_readings_are_taken(scene, folder):
    command("page", scene, "-o", folder / "page.html")
    assert '"taken"' in (folder / "page.html").read_text(encoding="utf-8")


def test_python_takes_them_too(scene, folder):
    command("sweep", scene, "-o", folder / "all.nc")
    sweeps = rcskin.read(folder / "all.nc")
    assert rcskin.features(sweeps, target="column")[0].shape[1] == 2 * READINGS
    accuracy, error = rcskin.limits(scene, "column", draws=200)
    assert 0 < accuracy <= 1 and error < 0.1
