"""The command line as its user meets it: exit codes, one clear line, nothing half-written."""

import io
import os
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pytest
from numpy.linalg import LinAlgError
from rcskin.simulator import sweeps
from rcskin.simulator.scene.scene_files import BUILTIN, builtin_names, load_scene
from rcskin.simulator.scene.surroundings import Surroundings


@pytest.fixture
def scene_with(tmp_path):
    """A file with the 3x3 sheet in which one piece of text is replaced by another."""

    def scene_with(old, new):
        text = (BUILTIN / "sheet-3x3.toml").read_text()
        assert old in text
        path = tmp_path / "mine.toml"
        path.write_text(text.replace(old, new, 1))
        return path

    return scene_with


def test_help_lists_the_commands_without_loading_the_solver():
    heavy = "{'scipy', 'numba', 'sklearn', 'numpy', 'pydantic'}"
    loaded = f"import sys, rcskin.__main__; sys.exit(bool({heavy} & set(sys.modules)))"
    assert subprocess.run([sys.executable, "-c", loaded], check=False).returncode == 0
    shown = subprocess.run(
        [sys.executable, "-m", "rcskin", "--help"], capture_output=True, text=True, check=True
    )
    assert all(command in shown.stdout for command in ("reproduce", "scenes", "sweep"))
    assert shown.stderr == ""


def test_scenes_names_every_built_in_scene(run):
    code, out, _ = run("scenes")
    assert code == 0
    assert all(name in out for name in builtin_names())


def test_scenes_shows_the_file_of_one(run, refused):
    """In plain ASCII, so that a console of any code page writes a file that is read again."""
    texts = {name: (BUILTIN / f"{name}.toml").read_text("ascii") for name in builtin_names()}
    assert run("scenes", "strip-1x3")[1] == texts["strip-1x3"]
    assert "did you mean strip-1x5? there are foam, glove, knit-36, l-shape" in refused(
        "scenes", "strip-1x9"
    )


@pytest.mark.parametrize("like", [None, "sheet-3x3"])
def test_a_new_scene_is_that_of_an_example_under_its_own_name(run, tmp_path, like):
    path = tmp_path / "my patch.toml"
    code, out, _ = run("new", path, *(["--from", like] if like else []))
    assert code == 0 and str(path) in out
    like = like or "glove"
    own = {"name": "my patch", "description": f"started from {like}"}
    own["surroundings"] = Surroundings()
    found, example = load_scene(path), load_scene(like)
    assert found.model_copy(update={"sweep": example.sweep}) == example.model_copy(update=own)
    four_digits = [float(f"{f:.3e}") for f in example.frequencies]
    assert found.frequencies.tolist() == four_digits != example.frequencies.tolist()
    assert path.read_text().count("#") >= 8


@pytest.mark.parametrize(
    ("given", "low"),
    [("floating", "floating"), ("virtual-earth", "virtual earth"), (None, "virtual earth")],
)
def test_a_new_scene_says_what_meter_it_is_for(run, tmp_path, given, low):
    path = tmp_path / "new.toml"
    assert run("new", path, *(["--low", given] if given else []))[0] == 0
    assert load_scene(path).surroundings == Surroundings(low=low)


def test_the_low_terminal_is_asked_for_on_a_terminal(monkeypatch, run, tmp_path):
    monkeypatch.setattr("sys.stdin", Typed("floating\n"))
    assert run("new", tmp_path / "new.toml")[0] == 0
    assert load_scene(tmp_path / "new.toml").surroundings == Surroundings(low="floating")


def test_another_low_terminal_is_refused(refused, tmp_path):
    err = refused("new", tmp_path / "new.toml", "--low", "ground")
    assert "must be 'virtual earth' or 'floating', got 'ground'" in err
    assert not (tmp_path / "new.toml").exists()


class Typed(io.StringIO):
    """What someone types at a terminal."""

    def isatty(self):
        return True


def test_a_new_scene_overwrites_nothing(refused, scene_with):
    path = scene_with("name", "name")
    before = path.read_text()
    assert "already exists" in refused("new", path)
    assert path.read_text() == before


def test_the_version_is_reported(run):
    assert run("--version")[:2] == (0, f"rcskin {version('rcskin')}\n")


@pytest.mark.parametrize("ending", ["csv", "nc"])
def test_a_sweep_without_a_press_holds_rest_and_every_pixel(run, tmp_path, ending):
    path = tmp_path / f"out.{ending}"
    code, out, err = run("sweep", "sheet-3x3", "-o", path)
    assert (code, out, err) == (0, f"10 sweeps x 20 frequencies -> {path}\n", "")
    written = sweeps.read(path)
    pixels = list(zip(written["row"].values, written["column"].values, strict=True))
    assert pixels == [(0, 0), *((i, j) for i in (1, 2, 3) for j in (1, 2, 3))]
    np.testing.assert_allclose(written["frequency"], load_scene("sheet-3x3").frequencies)


def test_presses_are_written_as_they_were_asked(run, tmp_path):
    path = tmp_path / "out.nc"
    run("sweep", "sheet-5x5", "--press", "4,4:1.5+1,1", "--press", "none", "-o", path)
    written = sweeps.read(path)
    assert list(written["press"].values) == ["1,1:2.0+4,4:1.5", "none"]
    assert list(written["row"].values) == [-1, 0]
    assert (written["Rs_error"] <= 1e-4 * written["Rs"]).all()
    assert (written["Cp_error"] <= 1e-4 * written["Cp"]).all()
    assert written.attrs["rtol"] == 1e-4
    assert 'name = "sheet-5x5"' in written.attrs["scene"]


def test_explain_states_what_was_chosen_and_what_was_rejected(run, tmp_path):
    _, out, _ = run("sweep", "strip-1x3", "--press", "1,2", "--explain", "-o", tmp_path / "a.csv")
    assert "chosen    exact line" in out and "\\n" not in out
    assert len([each for each in out.splitlines() if "estimated error" in each]) == 3
    _, out, _ = run("sweep", "sheet-3x3", "--press", "1,2", "--explain", "-o", tmp_path / "b.csv")
    assert "rejected  line" in out
    assert "rejected  one R and one C: error of the unpressed skin is" in out
    assert "2-D elements, one field" in out


def test_line_and_sheet_agree_on_the_strip(run, tmp_path):
    for model in ("line", "sheet"):
        run(
            "sweep", "strip-1x5", "--model", model, "--rtol", "1e-6", "-o", tmp_path / f"{model}.nc"
        )
    line, sheet = (sweeps.read(tmp_path / f"{model}.nc") for model in ("line", "sheet"))
    for quantity in ("Rs", "Cp"):
        np.testing.assert_allclose(sheet[quantity], line[quantity], rtol=1e-6)


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["sweep", "no-such-scene"], "no-such-scene: no such file, and no built-in scene"),
        (["sweep", "sheet-3x3", "--press", "4,1"], "row must be in 1..3 on sheet-3x3, got 4"),
        (["sweep", "sheet-3x3", "--press", "1;2"], "press '1;2': must be ROW,COLUMN, rect("),
        (["sweep", "sheet-3x3", "--press", "1,1:-2"], "FACTOR must be finite and > 0, got -2"),
        (["sweep", "sheet-3x3", "--rtol", "0.02"], "must be from 1e-08 to 0.01, got 0.02"),
        (["sweep", "sheet-3x3", "--press", "0,0"], "press '0,0': rows and columns count from 1"),
        (["sweep", "sheet-3x3", "--model", "cubic"], "must be one of auto, lumped, line, sheet"),
        (["sweep", "sheet-3x3", "--press", "1,1", "--model", "line"], "varies across sheet-3x3"),
    ],
)
def test_bad_input_ends_with_one_line_and_code_2(refused, tmp_path, arguments, told):
    path = tmp_path / "out.csv"
    assert told in refused(*arguments, "-o", path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        (
            "sheet_resistance = 50e3",
            "sheet_resistance = -5",
            "must be from 1e-6 to 1e12 ohm/sq, got -5",
        ),
        ("[skin]", "[skin", "not valid TOML"),
    ],
)
def test_a_bad_scene_file_is_named_with_key_value_and_range(refused, scene_with, old, new, told):
    path = scene_with(old, new)
    err = refused("sweep", path, "-o", path.with_suffix(".csv"))
    assert err.startswith(f"rcskin: {path}: ")
    assert told in err
    assert not path.with_suffix(".csv").exists()


def test_an_absent_output_folder_is_found_out_before_any_work(refused, tmp_path):
    assert f"the folder {tmp_path / 'absent'} does not exist" in refused(
        "sweep", "no-such-scene", "-o", tmp_path / "absent" / "out.csv"
    )


def test_another_ending_is_refused(refused, tmp_path):
    assert "must end in .nc or .csv or .zarr, got '.xlsx'" in refused(
        "sweep", "sheet-3x3", "-o", tmp_path / "out.xlsx"
    )


def test_a_tolerance_out_of_reach_ends_with_code_1_and_no_file(run, tmp_path):
    path = tmp_path / "out.csv"
    code, _, err = run("sweep", "sheet-3x3", "--model", "lumped", "-o", path)
    assert code == 1
    assert "estimated error" in err
    assert err.count("\n") == 1
    assert not path.exists()


@pytest.mark.parametrize("command", [["sweep"], ["meter", "serve"], ["calibrate"]])
def test_help_of_a_command_is_what_its_option_shows(run, command):
    code, shown, err = run("help", *command)
    assert (code, err) == (0, "") and f"rcskin {' '.join(command)} [OPTIONS]" in shown
    assert shown == run(*command, "--help")[1]
    assert "Example: rcskin" in shown


def test_help_of_nothing_lists_the_commands_and_of_no_command_is_refused(run, refused):
    assert run("help")[1] == run("--help")[1]
    assert "No such command 'swep'" in refused("help", "swep")


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["sweep"], "Missing argument 'scene'. Example: rcskin sweep sheet-5x5 -o all.nc"),
        (["sweep", "strip-1x3"], "Missing option '--output' / '-o'. Example: rcskin sweep"),
        (["meter", "correct"], "Example: rcskin meter correct open --resource"),
        (["meter", "serve", "glove"], "(glove). Example: rcskin meter serve --scene sheet-5x5"),
    ],
)
def test_what_is_missing_or_too_much_is_reported_with_an_example(refused, arguments, told):
    assert told in refused(*arguments)


def test_shells_complete_commands():
    asked = {"_RCSKIN_COMPLETE": "complete_bash", "COMP_WORDS": "rcskin swe", "COMP_CWORD": "1"}
    told = subprocess.run(
        [Path(sys.executable).with_name("rcskin")],
        env={**os.environ, **asked},
        capture_output=True,
        text=True,
        check=False,
    )
    assert told.stdout.split() == ["sweep"]


@pytest.mark.parametrize("arguments", [["sweep"], ["nonsense"], ["sweep", "strip-1x3"]])
def test_wrong_use_ends_with_one_line_and_code_2(refused, arguments):
    refused(*arguments)


@pytest.mark.parametrize(
    ("failure", "told"),
    [
        (RuntimeError("the sheet does not fit"), "the sheet does not fit (RuntimeError;"),
        (MemoryError(), "this machine has too little memory"),
        (ZeroDivisionError("division by zero"), "the numbers of the scene or of the options lie"),
        (OverflowError("cannot convert"), "the numbers of the scene or of the options lie"),
        (LinAlgError("Singular matrix"), "the numbers of the scene or of the options lie"),
        (ValueError("math domain error"), "the numbers of the scene or of the options lie"),
    ],
)
def test_an_unexpected_failure_is_one_line_and_code_1(run, monkeypatch, tmp_path, failure, told):
    def fail(*_):
        raise failure

    monkeypatch.setattr("rcskin.simulator.models.solver.Solver.solve", fail)
    code, _, err = run("sweep", "strip-1x3", "-o", tmp_path / "out.csv")
    assert code == 1
    assert err.startswith(f"rcskin: {told}")
    assert err.count("\n") == 1


def test_any_terminal_and_any_matplotlib_backend_will_do(tmp_path):
    """An ascii terminal has no m², and charts go to files whatever draws on the screen."""
    poor = {"PYTHONIOENCODING": "ascii", "MPLBACKEND": "nonsense", "LC_ALL": "C"}
    told = subprocess.run(
        [sys.executable, "-m", "rcskin", "describe", "glove", "-o", tmp_path / "glove.png"],
        env={**os.environ, **poor},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (told.returncode, told.stderr) == (0, "")
    assert "nF/m" in told.stdout and (tmp_path / "glove.png").exists()
