"""`rcskin train`, `evaluate` and `localize` as their user meets them."""

import numpy as np
import pandas as pd
import pytest
from rcskin.simulator.scene.scene_files import load_scene, scene_text
from rcskin.simulator.sweeps import concatenate, read, write

SCENE = scene_text(load_scene("strip-1x3").with_({"skin.length": 0.03}))


@pytest.fixture(scope="module")
def files(make_sweeps, tmp_path_factory):
    """Sweeps of three mountings, of another one, and of this one at other frequencies."""
    folder = tmp_path_factory.mktemp("files")
    known = concatenate([make_sweeps(session=k, seed=k) for k in range(3)])
    write(known.assign_attrs(scene=SCENE), folder / "known.nc")
    write(make_sweeps(session=5, seed=5).assign_attrs(scene=SCENE), folder / "unseen.nc")
    write(make_sweeps(frequency=np.array([1e3, 1e4])), folder / "other.nc")
    write(known.isel(sweep=known["column"].values > 0), folder / "pressed.nc")
    np.savez(folder / "a.npz", frequency=np.ones(3))
    return folder


@pytest.mark.usefixtures("unpainted")
def test_a_model_is_trained_evaluated_and_asked(run, files, tmp_path):
    model = tmp_path / "m.npz"
    code, out, err = run("train", files / "known.nc", "-o", model)
    assert (code, err) == (0, "")
    assert "column by ksvm-ovo from dlnZ, dphase at left" in out
    assert "whole sessions held out: most probable class right: 100 % (69 of 69)\n" in out
    assert out.endswith(f"model: 40 features, 3 columns -> {model}\n")
    code, out, err = run("evaluate", model, files / "unseen.nc", "-o", tmp_path / "found")
    assert (code, err) == (0, "")
    assert "right of all: 100 % (23 of 23)\n" in out and "too few for a bound on other skins" in out
    assert out.endswith(f"evaluation: 23 sweeps -> {tmp_path / 'found'}\n")
    assert {path.name for path in (tmp_path / "found").iterdir()} == {
        "figures.csv",
        "confusion.csv",
        "confusion.png",
        "belief.png",
    }
    write(read(files / "known.nc").isel(sweep=slice(30, None)), tmp_path / "some.csv")
    code, out, err = run("evaluate", model, tmp_path / "some.csv", "--rest", files / "known.nc")
    assert code == 0 and err.startswith(
        f"rcskin: note: {model}: was trained or adapted on 41 of these 42"
    )
    code, out, err = run("localize", model, files / "unseen.nc")
    assert code == 0 and "note: 1 sweep has no answer: no baseline sweep was measured before" in err
    header, first, second, *_ = out.splitlines()
    assert header == "sweep,press,answer,probability"
    assert first == "0,none,cannot tell,0.2500" and second.startswith('1,"1,1:2.0",1,')


def test_positions_are_trained_and_written(run, files, tmp_path):
    model = tmp_path / "m.npz"
    asked = ("--target", "position", "--estimator", "kernel-ridge", "--features", "dlnZ,dphase")
    assert run("train", files / "known.nc", *asked, "-o", model)[0] == 0
    assert run("localize", model, files / "unseen.nc", "-o", tmp_path / "out.csv")[0] == 0
    lines = (tmp_path / "out.csv").read_text().splitlines()
    assert lines[0].endswith("x_mm,y_mm,factor,x_mm_deviation,y_mm_deviation,factor_deviation")
    assert lines[1].startswith("0,none,cannot tell,") and lines[1].endswith(",,,,,,")
    x = float(lines[2].split(",")[5])
    assert abs(x - 5) < 3
    found = ("-o", tmp_path / "found", "--charts", "pdf")
    code, out, _ = run("evaluate", model, files / "unseen.nc", *found)
    assert code == 0 and "median error, mm" in out and "within 1 deviation" in out
    assert "touches within 95 % regions: " in out and "answered: " in out
    for chart in ("positions", "regions"):
        assert (tmp_path / "found" / f"{chart}.pdf").read_bytes().startswith(b"%PDF")


def test_without_a_model_scores_are_of_outer_folds(run, files):
    code, out, err = run(
        "evaluate", files / "known.nc", "--estimator", "ksvm-ovo", "--tune", "--folds", 3
    )
    assert (code, err) == (0, "")
    assert "3 folds, whole sessions held out" in out
    assert "right of all: " in out and "3 sessions: too few" in out and "±" in out


def test_more_folds_than_sessions_are_reported(run, files):
    code, out, _ = run("evaluate", files / "known.nc", "--folds", 9)
    assert code == 0 and "3 folds (9 requested, but there are no more sessions" in out


def test_a_session_without_rest_is_left_out_and_counted(run, make_sweeps, tmp_path):
    bare = make_sweeps(session=3, seed=3, unpressed=False)
    sweeps = concatenate([*(make_sweeps(session=k, seed=k) for k in range(3)), bare])
    write(sweeps, tmp_path / "some.nc")
    code, out, _ = run("evaluate", tmp_path / "some.nc", "--features", "dlnZ,dphase")
    assert code == 0
    assert (
        "69 sweeps, left out: 18 in 1 session without an unpressed sweep, 3 with no unpressed"
        in out
    )


def test_three_touches_at_once_are_left_out_and_counted(run, make_sweeps, tmp_path):
    sweeps = make_sweeps(session=1)
    press = sweeps["press"].values.astype(object)
    press[5] = "1,1+1,2+1,3"
    three = sweeps.assign_coords(press=("sweep", press)).assign_attrs(scene=SCENE)
    write(three, tmp_path / "three.nc")
    for target in ("touches", "pair", "position"):
        asked = ("--target", target, "--features", "Rs,Cp", "-o", tmp_path / f"{target}.npz")
        code, out, _ = run("train", tmp_path / "three.nc", *asked)
        other = {
            "touches": "1 of more than 2 touches",
            "pair": "1 not of a press of at most 2 whole pixels",
            "position": "7 not of one touch",
        }
        assert code == 0 and f"left out: {other[target]}\n" in out


def test_answers_at_a_rate_are_reported_with_confidence_and_coverage(run, make_sweeps, tmp_path):
    write(make_sweeps(repetitions=40), tmp_path / "many.nc")
    asked = ("--certain", 0.9, "-o", tmp_path / "m.npz")
    code, out, _ = run("train", tmp_path / "many.nc", *asked)
    assert (
        code == 0
        and "at a rate of 0.9 or more, with 95 % confidence in sessions like these; held-out" in out
    )


def test_a_model_never_shown_rest_says_so(run, files, tmp_path):
    code, out, _ = run("train", files / "pressed.nc", "-o", tmp_path / "m.npz")
    assert code == 0 and "never answers 'nothing pressed'" in out


@pytest.mark.parametrize("command", ["train", "evaluate"])
def test_without_the_unpressed_skin_readings_are_taken_as_they_stand(run, files, tmp_path, command):
    output = ("-o", tmp_path / "m.npz") if command == "train" else ()
    code, _, err = run(command, files / "pressed.nc", *output)
    assert code == 0 and err.startswith("rcskin: note: --features Rs,Cp is used because most")
    assert "--features" not in run(command, files / "pressed.nc", "--features", "Rs,Cp", *output)[2]


def test_raw_readings_of_several_skins_are_advised_against(run, files, tmp_path):
    advised = "usually more accurate: --features dlnZ,dphase"
    model = ("-o", tmp_path / "m.npz")
    assert advised in run("train", files / "known.nc", "--features", "Rs,Cp", *model)[1]
    assert advised not in run("train", files / "known.nc", *model)[1]
    assert advised not in run("train", files / "pressed.nc", *model)[1]


def test_raw_readings_without_rest_are_answered_with_a_note(run, files, tmp_path):
    model, sweeps = tmp_path / "m.npz", read(files / "known.nc")
    write(sweeps.isel(sweep=sweeps["row"].values == 0), tmp_path / "rest.nc")
    assert run("train", files / "known.nc", "--features", "Rs,Cp", "-o", model)[0] == 0
    code, out, err = run("localize", model, files / "pressed.nc")
    *_, unguarded, known = err.splitlines(keepends=True)
    assert known.startswith(
        f"rcskin: note: {model}: was trained or adapted on 54 of these 54 sweeps"
    )
    assert code == 0 and unguarded == (
        "rcskin: note: without a baseline sweep before: 54 sweeps, in which two touches may be "
        "taken for one; --rest FILE gives one\n"
    )
    code, guarded, err = run(
        "localize", model, files / "pressed.nc", "--rest", tmp_path / "rest.nc"
    )
    assert (code, err) == (0, known) and "cannot tell" not in out + guarded


def test_only_so_many_sweeps_are_taken_and_whole_sessions_of_them(run, files, tmp_path):
    code, out, _ = run("train", files / "known.nc", "--most", 50, "-o", tmp_path / "m.npz")
    assert code == 0 and "; 46 sweeps" in out


def test_what_scikit_learn_warns_of_is_not_shown(run, make_sweeps, tmp_path):
    write(make_sweeps(rows=4, columns=6, repetitions=2), tmp_path / "few.nc")
    asked = ("--target", "pixel", "--features", "Rs,Cp", "-o", tmp_path / "m.npz")
    code, _, err = run("train", tmp_path / "few.nc", *asked)
    assert (code, err) == (0, "")


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["train", "known.nc", "--estimator", "oracle", "-o", "m.npz"], "--estimator must be"),
        (["train", "known.nc", "-o", "m.pkl"], "must end in .npz"),
        (["train", "known.nc", "--target", "depth", "-o", "m.npz"], "--target must be one of"),
        (["train", "known.nc", "--features", "Z", "-o", "m.npz"], "--features must be of"),
        (["train", "known.nc", "--interface", "up", "-o", "m.npz"], "no interface 'up'"),
        (
            ["train", "pressed.nc", "--features", "dlnZ", "-o", "m.npz"],
            "no sweep of the unpressed skin",
        ),
        (["evaluate", "a.npz", "known.nc"], "not a model of rcskin"),
        (["localize", "none.npz", "known.nc"], "none.npz: no such file"),
        (["localize", "good.npz", "other.nc"], "trained on 20 frequencies, the sweeps have 2"),
        (
            ["train", "pressed.nc", "--estimator", "model-based", "-o", "m.npz"],
            "takes the features dlnZ,dphase",
        ),
    ],
)
def test_bad_input_is_one_line_and_code_2(run, refused, files, monkeypatch, arguments, told):
    monkeypatch.chdir(files)
    if "good.npz" in arguments:
        run("train", "known.nc", "-o", "good.npz")
    assert told in refused(*arguments)


def test_a_localizer_of_the_skin_at_hand_is_given_the_simulator_again(run, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    run("dataset", "sheet-3x3", "--sweeps", 200, "-o", "skin.zarr")
    whole = ["--features", "dlnZ,dphase,lnZ0,phase0"]
    code, out, _ = run("train", "skin.zarr", "--estimator", "model-adapted", *whole, "-o", "m.npz")
    assert code == 0 and "column by model-adapted" in out
    code, out, _ = run("localize", "m.npz", "skin.zarr", "-o", "told.csv")
    assert code == 0
    told = pd.read_csv("told.csv", dtype=str)
    single = told[~told["press"].str.contains(r"\+|none")]
    column = single["press"].str.extract(r",(\d)")[0]
    assert (single["answer"] == column).mean() > 0.95
