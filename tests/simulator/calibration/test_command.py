"""`rcskin calibrate` as its user meets it."""

import json

import pytest
import rcskin
from rcskin.simulator.models.parameters import parts_with
from rcskin.simulator.scene.scene_files import read_scene, scene_text
from rcskin.simulator.sweeps import read as read_sweeps
from rcskin.simulator.sweeps import write

TRUTH = {"sheet_resistance": 0.25, "capacitance": -0.3}
PRESSES = ("none", "none", "1,2:1.9", "1,3:2.1")
SOFT = {"thickness": 2e-3, "relative_permittivity": 2.0, "mechanics": {"modulus": 60e3}}
TWO = ("--fit", "sheet_resistance", "--fit", "capacitance")
FILES = [
    "calibrated.toml",
    "calibration.json",
    "correlation.csv",
    "parameters.csv",
    "quantities.csv",
    "residuals-meter.png",
]


@pytest.fixture
def files(tmp_path, line, read):
    (tmp_path / "skin.toml").write_text(scene_text(line))
    write(read(line, TRUTH, PRESSES), tmp_path / "run.nc")
    return tmp_path / "skin.toml", tmp_path / "run.nc", tmp_path / "found"


@pytest.mark.usefixtures("unpainted")
def test_a_scene_is_calibrated(run, files, line, earth_alone):
    scene, measured, folder = files
    code, out, err = run("calibrate", scene, measured, "-o", folder)
    assert code == 0 and earth_alone(err), err
    assert "foam capacitance" in out
    assert "chi-squared per degree of freedom" in out
    assert "the data identify only both sheets in series; top over bottom is assumed" in out
    assert sorted(path.name for path in folder.iterdir()) == FILES
    assert sorted(path.name for path in folder.parent.iterdir()) == ["found", "run.nc", "skin.toml"]


@pytest.mark.usefixtures("linear_intervals")
def test_the_answer_is_written_before_anything_is_tried(run, files, monkeypatch):
    scene, measured, folder = files
    monkeypatch.setattr("rcskin.simulator.calibration.run.tried", _interrupted)
    code, out, _ = run("calibrate", scene, measured, "-o", folder, *TWO)
    assert code and "foam capacitance" in out
    assert sorted(path.name for path in folder.iterdir()) == FILES


def _interrupted(*_):
    raise KeyboardInterrupt


@pytest.mark.usefixtures("linear_intervals", "unpainted")
def test_a_matrix_too_wide_for_the_terminal_is_left_to_its_file(run, files, monkeypatch):
    scene, measured, folder = files
    assert "correlation    " in run("calibrate", scene, measured, "-o", folder)[1]
    monkeypatch.setenv("COLUMNS", "60")
    out = run("calibrate", scene, measured, "--overwrite", "-o", folder)[1]
    assert (
        "correlations of 8 parameters are in correlation.csv" in out and "correlation  " not in out
    )


@pytest.mark.usefixtures("unpainted")
def test_an_ideal_capacitance_that_fits_is_not_called_the_wrong_curve(run, tmp_path):
    measured = tmp_path / "exact.nc"
    assert run("sweep", "strip-1x5", "-o", measured)[0] == 0
    code, out, _ = run("calibrate", "strip-1x5", measured, "-o", tmp_path / "found")
    assert code == 0 and "phase_exponent" in out
    assert "wrong curve" not in out and "the best fit with an ideal" not in out


def test_the_calibrated_scene_says_from_what_and_is_the_same_bytes_again(run, files, line):
    scene, measured, folder = files
    run("calibrate", scene, measured, "-o", folder, *TWO)
    text = (folder / "calibrated.toml").read_text()
    assert text.startswith(
        "# Calibrated to run.nc by rcskin calibrate.\n# Fitted quantities with marginal 95 %"
    )
    calibrated, truth = read_scene(folder / "calibrated.toml"), parts_with(line.parts, TRUTH).scene
    assert calibrated.description == "calibrated to run.nc"
    assert calibrated.skin.foam.unpressed_capacitance_per_area == pytest.approx(
        truth.skin.foam.unpressed_capacitance_per_area, rel=0.02
    )
    assert "not fitted; scene's values kept, uncertain within their priors: loss_tangent" in text
    assert "both in series: " in text
    assert "not identified by the data; assumed from the scene, within its prior" in text
    code, _, err = run("sweep", folder / "calibrated.toml", "-o", folder.parent / "again.nc")
    assert (code, err) == (0, "")
    assert read_sweeps(folder.parent / "again.nc").sizes["frequency"] == 12
    run("calibrate", scene, measured, "-o", folder.parent / "second", *TWO)
    for path in folder.iterdir():
        assert path.read_bytes() == (folder.parent / "second" / path.name).read_bytes()


def test_numbers_are_written_for_machines(run, files):
    scene, measured, folder = files
    run("calibrate", scene, measured, "-o", folder, *TWO, "--fix", "others")
    told = json.loads((folder / "calibration.json").read_text())
    low, high = told["intervals_95"]["capacitance"]
    assert low < told["values"]["capacitance"] < high
    assert told["correlation"]["capacitance"][1] == pytest.approx(1)
    assert [each["press"] for each in told["strengths"]] == ["1,2:1.9", "1,3:2.1"]
    lines = (folder / "quantities.csv").read_text().splitlines()
    assert lines[0] == "quantity,unit,scene,fitted,low_95,high_95,source"
    assert len(lines) == 5
    assert (folder / "residuals-meter.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (("--fit", "bulk"), "got 'bulk'"),
        (("--band", "high"), "--band must be LOW:HIGH in Hz, got 'high'"),
        (("--band", "5:1"), "--band must be LOW:HIGH in Hz with 0 <= LOW < HIGH, got 5:1"),
        (("--band", "1e9:"), "got 1e+09 to inf Hz"),
        (("--prior", "none"), "--prior must be one of wide, session, got 'none'"),
        (("--session", "9"), "--session must be one of 0, got 9"),
        (("--also", "bodies"), "--also must be one of body, rim, finger, leak, source_scale, "),
    ],
)
def test_bad_input_is_one_line_and_nothing_is_written(refused, files, more, message):
    scene, measured, folder = files
    assert message in refused("calibrate", scene, measured, "-o", folder, *more)
    assert not folder.exists()


def test_sweeps_of_another_skin_are_refused(refused, files):
    _, measured, folder = files
    err = refused("calibrate", "strip-1x3", measured, "-o", folder)
    assert err.startswith(
        "rcskin: run.nc: recorded for scene, but used for strip-1x3: width 0.08 m, "
    )
    assert err.endswith("; --anyway ignores this\n")
    assert not folder.exists()


@pytest.mark.usefixtures("linear_intervals", "unpainted")
def test_sweeps_of_another_skin_are_taken_where_one_insists(run, files, line, earth_alone):
    scene, measured, folder = files
    scene.write_text(scene_text(line.with_({"skin.length": 0.11, "name": "longer"})))
    code, _, err = run("calibrate", scene, measured, "-o", folder)
    assert code == 2
    assert "recorded for scene, but used for longer: length 0.1 m, not 0.11 m" in err
    code, _, err = run("calibrate", scene, measured, "-o", folder, *TWO, "--anyway")
    assert code == 0 and earth_alone(err), err


@pytest.mark.usefixtures("unpainted")
def test_a_skin_of_other_materials_is_the_same_skin_and_other_files_of_the_folder_stay(
    run, files, line
):
    scene, measured, folder = files
    folder.mkdir()
    (folder / "notes.txt").write_text("mine")
    changes = {"name": "other", "skin.sheet_resistance": 6e4, "leads": {"resistance": 5.0}}
    scene.write_text(scene_text(line.with_(changes)))
    assert run("calibrate", scene, measured, "-o", folder, *TWO, "--charts", "svg")[0] == 0
    files = [*FILES[:-1], "residuals-meter.svg", "notes.txt"]
    assert sorted(path.name for path in folder.iterdir()) == sorted(files)


def test_a_file_is_no_folder(refused, files):
    scene, measured, _ = files
    assert "is a file, not a folder" in refused("calibrate", scene, measured, "-o", measured)


def test_nothing_is_left_where_writing_fails(run, files, monkeypatch):
    scene, measured, folder = files

    def broken(*_):
        raise OSError("no space left")

    monkeypatch.setattr("rcskin.simulator.calibration.report.draw_residuals", broken)
    code, _, err = run("calibrate", scene, measured, "-o", folder, *TWO)
    assert code == 1
    assert "no space left" in err
    assert sorted(path.name for path in folder.parent.iterdir()) == ["run.nc", "skin.toml"]


@pytest.mark.usefixtures("linear_intervals")
@pytest.mark.parametrize("strength", [{"depth": 0.5e-3}, {"force": 5.0}])
def test_presses_by_depth_or_force_are_fitted_and_stay_in_the_scene(run, tmp_path, line, strength):
    soft = line.with_({"skin.foam": SOFT, "press": strength})
    scene, measured, found = tmp_path / "skin.toml", tmp_path / "run.nc", tmp_path / "found"
    scene.write_text(scene_text(soft))
    run("sweep", scene, "-o", measured)
    code, out, err = run("calibrate", scene, measured, "-o", found, *TWO)
    assert code == 0 and "left out" not in out + err, err
    assert read_scene(found / "calibrated.toml").press == soft.press
    in_python = rcskin.calibrate(scene, measured, fit=["sheet_resistance", "capacitance"])
    assert in_python.scene.press == soft.press and not in_python.remarks
