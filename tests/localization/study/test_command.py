"""`rcskin study` as its user meets it: table, chart, answers, and one line for bad input."""

import subprocess
import sys

import pandas as pd
import pytest
import xarray as xr
from matplotlib.image import imread
from rcskin.localization.study.axis import scene_table
from rcskin.localization.study.study import with_study_settings
from rcskin.simulator.scene.scene_files import BUILTIN

FAST = ("--repetitions", "8", "--workers", "1", "--rtol", "1e-2")
COLUMNS = [
    "accuracy",
    "accuracy_sd",
    "least_separation",
    "median_separation",
    "band_start_Hz",
    "band_stop_Hz",
    "band_separation",
]

pytestmark = pytest.mark.usefixtures("short_studies")


def test_two_axes_make_a_table_a_map_and_an_answer_for_each_second_value(run, tmp_path):
    code, out, err = run(
        *("study", "strip-1x3", "--vary", "readout.phase_noise=1e-3:1e-1:2:log"),
        *("--vary", "pixels.columns=2:3", *FAST, "-o", tmp_path / "out.csv"),
    )
    assert (code, err) == (0, "")
    *answers, meaning, spaced, end = out.splitlines()
    assert meaning == (
        "accuracy means: share of the sweeps of skins outside the training whose column was found, "
        "from changes from the unpressed skin, with the meter's noise; rcskin limits strip-1x3 "
        "computes the bound for a known skin"
    )
    assert [line.split(":")[0] for line in answers] == [f"pixels.columns = {n}" for n in (2, 3)]
    assert spaced == (
        "readout.phase_noise: 2 values from 0.001 to 0.1, logarithmic; "
        "pixels.columns: 2 values from 2 to 3, linear"
    )
    assert end == f"4 points -> {tmp_path / 'out.csv'}, {tmp_path / 'out.png'}"
    table = pd.read_csv(tmp_path / "out.csv")
    assert list(table) == ["readout.phase_noise", "pixels.columns", *COLUMNS]
    assert len(table) == 4
    assert table["accuracy"].between(0, 1).all() and table.notna().all().all()
    assert (table["band_start_Hz"] <= table["band_stop_Hz"]).all()
    assert imread(tmp_path / "out.png")[..., :3].std() > 0.1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out.csv", "out.png"]


@pytest.mark.usefixtures("unlearned")
def test_one_axis_makes_curves_and_netcdf_with_units(run, tmp_path):
    code, out, _ = run(
        *("study", "strip-1x4", "--vary", "contact.top-left.resistance=0:100:3:linear", *FAST),
        *("--chart", tmp_path / "curves.pdf", "-o", tmp_path / "out.nc"),
    )
    assert code == 0
    assert out.startswith("best accuracy ")
    spaced, end = out.splitlines()[-2:]
    assert spaced == "contact.top-left.resistance: 3 values from 0 to 100, linear"
    assert end.startswith("3 points -> ")
    found = xr.load_dataset(tmp_path / "out.nc")
    resistance = found["contact.top-left.resistance"]
    assert resistance.values.tolist() == [0, 50, 100]
    assert (resistance.units, found["band_start"].units) == ("ohm m", "Hz")
    assert 'name = "strip-1x4"' in found.attrs["scene"]
    assert (tmp_path / "curves.pdf").read_bytes().startswith(b"%PDF")


@pytest.mark.usefixtures("unpainted", "unlearned")
def test_a_grid_is_logarithmic_unless_asked_otherwise(run, tmp_path):
    asked = ("study", "strip-1x3", "--vary", "press.factor_spread=0.1:0.4:3", *FAST)
    code, out, _ = run(*asked, "-o", tmp_path / "out.csv")
    assert code == 0
    assert pd.read_csv(tmp_path / "out.csv")["press.factor_spread"].tolist() == pytest.approx(
        [0.1, 0.2, 0.4]
    )
    assert out.splitlines()[-2] == "press.factor_spread: 3 values from 0.1 to 0.4, logarithmic"
    told = " ".join(run("study", "--help")[1].replace("│", " ").split())
    assert "spaced logarithmically unless :linear is given" in told


@pytest.mark.usefixtures("unlearned")
def test_one_value_of_a_key_makes_curves_and_no_map(run, tmp_path):
    vary, one = ("--vary", "press.factor_spread=0.1:0.4:2"), ("--vary", "pixels.columns=3")
    for name, more in (("alone", vary), ("first", (*one, *vary)), ("second", (*vary, *one))):
        code, _, err = run("study", "strip-1x3", *more, *FAST, "-o", tmp_path / f"{name}.csv")
        assert (code, err) == (0, "")
    alone, first, second = (
        imread(tmp_path / f"{name}.png") for name in ("alone", "first", "second")
    )
    assert alone.shape == first.shape == second.shape
    assert abs(first - second).max() == 0


@pytest.mark.usefixtures("unpainted", "unlearned")
def test_a_screenful_is_printed_and_every_point_is_written(run, tmp_path):
    many = ",".join(f"{0.01 * k:g}" for k in range(1, 31))
    code, out, _ = run(
        *(
            "study",
            "strip-1x3",
            "--vary",
            "pixels.columns=3",
            "--vary",
            f"press.factor_spread={many}",
        ),
        *(*FAST, "-o", tmp_path / "out.csv"),
    )
    assert code == 0
    assert len(out.splitlines()) == 24
    assert f"10 more lines left out: all points are in {tmp_path / 'out.csv'}" in out
    assert len(pd.read_csv(tmp_path / "out.csv")) == 30


@pytest.mark.usefixtures("unpainted")
def test_the_same_command_writes_the_same_bytes(run, tmp_path):
    command = ("study", "strip-1x3", "--vary", "readout.phase_noise=0.3", *FAST)
    command = (*command, "--vary", "readout.magnitude_noise=0.3")
    for name in ("one", "two"):
        run(*command, "--seed", 5, "-o", tmp_path / f"{name}.csv")
    run(*command, "--seed", 6, "-o", tmp_path / "other.csv")
    one, two, other = ((tmp_path / f"{name}.csv").read_bytes() for name in ("one", "two", "other"))
    assert one == two != other


def test_the_limit_of_the_meter_ends_a_grid_and_cuts_a_list():
    grid, listed = (
        with_study_settings(scene_table(name), 5e3, None, None)["sweep"]["frequencies"]
        for name in ("sheet-3x3", "strip-1x4")
    )
    assert grid | {"start": 1e3, "stop": 5e3, "points": 20, "spacing": "log"} == grid
    assert listed == [707, 1258, 2830]


@pytest.mark.parametrize(
    ("vary", "told"),
    [
        ("skin.thickness=1:2:3", "`skin.thickness` is not a numeric key of the scene; there are"),
        ("experiment.unpressed=0:1", "`experiment.unpressed` is not a numeric key"),
        ("skin.length", "must be KEY=START:STOP:POINTS[:log|linear]"),
        ("skin.length=0.1:0.2", "skin.length is a real number: skin.length=START:STOP:POINTS"),
        ("skin.length=0.1:0.2:1", "POINTS must be from 2 to 1000, got '1'"),
        ("skin.length=0.2:0.1:3", "START must be < STOP, got 0.2 and 0.1"),
        ("skin.length=0.1:0.2:3:cubic", "START:STOP:POINTS[:log|linear]"),
        ("skin.length=a:0.2:3", "skin.length takes finite numbers, got 'a'"),
        ("skin.length=0.1,nan", "skin.length takes finite numbers, got 'nan'"),
        ("skin.length=0.1,0.1", "a value is given twice"),
        (
            "skin.length=-1:1:3:linear",
            "skin.length = -1: `skin.length` must be from 1e-5 to 1000 m",
        ),
        ("skin.foam.loss_tangent=0:0.1:3", "START must be > 0 for log spacing, got 0"),
        ("pixels=2:5:3", "pixels is a whole number: pixels=START:STOP"),
        ("pixels=2.5", "pixels takes whole numbers, got '2.5'"),
        ("pixels=1", "need at least 2 classes of --target column, got 1"),
        ("pixels.rows=1:2000", "at most 1000 values, got 2000"),
        ("readout.phase_noise=0,1e-3", "`readout.phase_noise` must be > 0 for a study, got 0"),
        ("experiment.repetitions=1:6", "must give at least 5 presses of each class"),
        ("press.factor_spread=0.9", "`press.factor_spread` must be < 0.667 where factors about 2"),
        ("contact.3.resistance=0:1:2:linear", "`contact.3.resistance` is not a numeric key"),
    ],
)
def test_what_cannot_be_varied_is_reported_in_one_line(refused, tmp_path, vary, told):
    assert told in refused("study", "sheet-4x4", "--vary", vary, "-o", tmp_path / "out.csv")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (["--vary", "pixels=2", "--vary", "pixels.rows=2"], "set the same number of the scene"),
        (["--vary", "pixels=2"] * 3, "--vary must be given once or twice, got 3 times"),
        (["--target", "corner"], "--target must be one of column, row, pixel, got 'corner'"),
        (["--max-frequency", "500"], "--max-frequency must be finite and > 1000 Hz"),
        (["--chart", "chart.jpg"], "must end in .png or .svg or .pdf, got '.jpg'"),
        (["-o", "out.xlsx"], "must end in .csv or .nc, got '.xlsx'"),
    ],
)
def test_bad_options_are_reported_in_one_line(refused, tmp_path, monkeypatch, options, told):
    monkeypatch.chdir(tmp_path)
    assert told in refused("study", "sheet-4x4", "-o", "out.csv", *options)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.usefixtures("unpainted", "unlearned")
def test_a_scene_of_ones_own_keeps_its_grid_of_frequencies(run, tmp_path):
    mine = tmp_path / "mine.toml"
    mine.write_text((BUILTIN / "sheet-3x3.toml").read_text())
    code, _, err = run(
        *("study", mine, "--vary", "sweep.frequencies.points=4", *FAST),
        *("-o", tmp_path / "out.csv"),
    )
    assert (code, err) == (0, "")


@pytest.mark.slow
def test_any_number_of_workers_finds_the_same(run, tmp_path):
    """Processes import what they need by its name, also where the command is `python -m rcskin`."""
    asked = ("study", "strip-1x3", "--vary", "pixels.columns=2:3", *FAST[:2], *FAST[4:])
    one, two = ((*asked, "--workers", n, "-o", tmp_path / f"{n}.csv") for n in "12")
    assert run(*one)[0] == 0
    subprocess.run([sys.executable, "-m", "rcskin", *two], check=True)
    assert one[-1].read_bytes() == two[-1].read_bytes()
