"""The commands `rcskin limits` and `rcskin frequencies`."""

import csv
import json

import pytest
from matplotlib.image import imread
from rcskin.simulator.limits import survey_results
from rcskin.simulator.limits.survey import with_sheets
from rcskin.simulator.scene.scene_files import load_scene, scene_text

QUICK = ("--draws", "50", "-n", "2")


@pytest.fixture
def scene_file(tmp_path, noisy):
    def write(**more):
        scene = noisy(length=0.1, width=0.1, rows=2, columns=2, **more)
        path = tmp_path / "scene.toml"
        path.write_text(scene_text(scene))
        return path

    return write


def test_maps_tables_and_a_summary_are_written(run, tmp_path, scene_file):
    names = ["frequencies.png", "limits.csv", "limits.json", "pixels.csv", "pixels.png"]
    folder = tmp_path / "new" / "folder"
    code, out, err = run(
        *("limits", scene_file(), "--sheet-resistance", "1e4", *QUICK), *("-o", folder)
    )
    assert (code, err) == (0, "")
    assert "accuracy of columns: at most" in out and "not resolved" in out and "nan" not in out
    assert sorted(path.name for path in folder.iterdir()) == [*names, "sheets.png"]
    for name in ("limits.csv", "limits.json", "pixels.csv"):
        assert "nan" not in (folder / name).read_text().lower()
    rows = list(csv.DictReader((folder / "limits.csv").read_text().splitlines()))
    assert {row["comparison"] for row in rows} == {"frequencies", "sheets"}
    assert all(float(row["deviation_x_mm"]) > 0 for row in rows if row["x_mm"] == "25.0")
    summary = json.loads((folder / "limits.json").read_text())
    assert summary["accuracy"]["pixel"]["best_possible"] == pytest.approx(0.5, abs=1e-3)
    assert imread(folder / "frequencies.png")[..., :3].std() > 0.05


def test_a_terminal_shows_a_table_of_frequency_sets(run, scene_file, coarse, monkeypatch):
    monkeypatch.setenv("FORCE_COLOR", "1")
    code, out, err = run("frequencies", scene_file(), "-n", "2", "--grid", "8")
    assert (code, err) == (0, "")
    assert "frequencies (Hz)" in out and "over the best" in out


def test_the_most_pixels_for_an_accuracy_are_printed(run, coarse):
    code, out, err = run("limits", "strip-1x3", "--accuracy", "0.99", "--draws", "100")
    assert (code, err) == (0, "")
    column, pixel = out.splitlines()
    possible = "an accuracy of 99 % is possible with at most 1x"
    assert column.startswith(f"column: {possible}") and pixel.startswith(f"pixel: {possible}")


def accuracies(folder):
    told = json.loads((folder / "limits.json").read_text())["accuracy"]
    return {target: told[target]["best_possible"] for target in ("column", "pixel")}


@pytest.mark.slow
def test_factor_and_size_reach_the_accuracies_too(run, tmp_path, scene_file):
    path, found = scene_file(frequencies=[1e4, 1e5]), {}
    for name, options in {
        "weak": ("--factor", "1.01"),
        "strong": ("--factor", "1.05"),
        "whole": ("--factor", "1.01", "--size", "50"),
        "small": ("--factor", "1.01", "--size", "20"),
    }.items():
        code, _, err = run("limits", path, *QUICK, *options, "-o", tmp_path / name)
        assert (code, err) == (0, "")
        found[name] = accuracies(tmp_path / name)["column"]
    assert found["weak"] < 0.95 < found["strong"]
    assert found["whole"] == pytest.approx(found["weak"], abs=0.01)
    assert found["small"] < found["whole"] - 0.1


def test_size_and_factor_apply_to_counts_of_pixels(run, coarse):
    asked = ("limits", "strip-1x3", "--accuracy", "0.99", "--draws", "50")
    whole, small, weak = (
        run(*asked, *more)[1] for more in ((), ("--size", "3"), ("--factor", "1.05"))
    )
    assert len({whole, small, weak}) == 3


def test_each_figure_states_its_assumptions(run, tmp_path, scene_file, undrawn):
    out = run("limits", scene_file(), *QUICK, "-o", tmp_path / "found")[1]
    position, accuracy = (
        out.index(f"for a {what}") for what in ("touch: the estimator", "press: the classifier")
    )
    assert position < out.index("x (mm)") < accuracy < out.index("accuracy of columns")
    assert "it estimates x, y and strength" in out and "give or take 10 % of the rise" in out
    told = json.loads((tmp_path / "found" / "limits.json").read_text())
    assert told["assumptions"] in out and told["accuracy"]["assumptions"] in out
    out = run("limits", scene_file(), *QUICK, "--unknown-skin", "-o", tmp_path / "other")[1]
    assert "x, y, strength and the skin as dataset.session draws it from the sweep" in out


def test_long_tables_are_cut_on_the_terminal_only(run, tmp_path, scene_file, monkeypatch, undrawn):
    others, few = 24 - survey_results.MAX_ROWS, 4
    monkeypatch.setattr(survey_results, "MAX_ROWS", few)
    many = "1e4,2e4"
    asked = (*QUICK, "--sheet-resistance", many, "-o", tmp_path / "found")
    code, out, _ = run("limits", scene_file(frequencies=[1e4, 1e5]), *asked)
    assert code == 0
    assert len(out.splitlines()) <= others + few
    told = json.loads((tmp_path / "found" / "limits.json").read_text())
    assert len(told["position"]) > few
    assert f"{len(told['position']) - few} more rows in" in out


def test_a_pipe_gets_one_frequency_per_line(run, scene_file):
    path = scene_file()
    code, out, err = run("frequencies", path, "-n", "3", "--grid", "12")
    assert code == 0
    chosen = [float(line) for line in out.splitlines()]
    band = load_scene(path).frequencies
    assert len(set(chosen)) == 3 and chosen == sorted(chosen)
    assert band[0] <= chosen[0] and chosen[-1] <= band[-1]
    assert "Eq. 6" in err and "log spacing" in err
    narrow = run("frequencies", path, "-n", "2", "--grid", "9", "--band", "2e3:3e3")[1]
    assert all(2e3 <= float(line) <= 3e3 for line in narrow.splitlines())


def test_columns_and_pixels_are_criteria_too(run, scene_file):
    for criterion in ("column", "pixel"):
        code, out, _ = run(
            *("frequencies", scene_file(), "-n", "2", "--grid", "9"), "--criterion", criterion
        )
        assert code == 0 and len(out.splitlines()) == 2


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("limits", "strip-1x3", "--size", "99"), "--size must be"),
        (("limits", "strip-1x3", "--factor", "1"), "--factor must be"),
        (("limits", "strip-1x3", "--charts", "jpg"), "--charts must be png or svg or pdf"),
        (("limits", "strip-1x3", "--interface", "up"), "--interface must be one of left"),
        (("limits", "strip-1x3", "--sheet-resistance", "1e3,x"), "--sheet-resistance must be"),
        (("limits", "strip-1x3", "--sheet-resistance", "-1"), "--sheet-resistance must be"),
        (("frequencies", "strip-1x3", "-n", "2", "--criterion", "x"), "--criterion must be"),
        (("frequencies", "strip-1x3", "-n", "2", "--band", "9:1"), "--band must be"),
        (("frequencies", "strip-1x3", "-n", "2", "--grid", "1"), "--grid must be"),
    ],
)
def test_bad_input_is_one_line_and_code_2(refused, tmp_path, monkeypatch, arguments, told):
    monkeypatch.chdir(tmp_path)
    err = refused(*arguments)
    assert len(err.splitlines()) == 1
    assert told in err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("command", [("limits",), ("frequencies", "-n", "2")])
def test_a_meter_without_noise_is_refused(refused, tmp_path, monkeypatch, scene_file, command):
    monkeypatch.chdir(tmp_path)
    name, *options = command
    err = refused(name, scene_file(readout={}), *options)
    assert "readout.magnitude_noise" in err
    assert len(err.splitlines()) == 1


def test_another_sheet_resistance_is_not_that_of_earth():
    skin = load_scene("knit-36").skin
    changed = with_sheets(load_scene("knit-36").parts, 2e3).skin
    assert changed.bottom == skin.bottom and changed.top.sheet_resistance == 2e3
    assert with_sheets(load_scene("sheet-3x3").parts, 2e3).skin.sheet_resistances == (2e3, 2e3)
