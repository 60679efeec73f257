"""`rcskin dataset` as its user meets it, with the reduced model."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.scene_files import BUILTIN, read_scene
from rcskin.simulator.sweeps import impedance, parallel_capacitance, read

ALIKE = """
[dataset.session]
sweeps_per_session = 20
sheet_resistance = 1.0
sheet_mismatch = 1.0
unevenness = 0.0
capacitance = 1.0
foam_spread = 0.0
loss_tangent = 0.0
stray_capacitance = 0.0
lead_resistance = 0.0
"""
SYSTEMS = Path(__file__).parents[2] / "systems"
READOUT = "[readout]\ndisplay_digits = 12\n"
LOOSE = ("--rtol", 1e-2)


@pytest.fixture
def scene_file(tmp_path):
    """sheet-3x3 at three frequencies, every skin alike, an ideal meter of many digits."""
    text = (BUILTIN / "sheet-3x3.toml").read_text(encoding="utf-8")
    head, _, _ = text.partition("[sweep]")
    path = tmp_path / "alike.toml"
    sweep = "[sweep]\nfrequencies = [1e3, 2e4, 2e5]\n"
    path.write_text(f"{head}{sweep}{READOUT}{ALIKE}", encoding="utf-8")
    return path


def test_sweeps_are_those_of_the_full_model_within_the_tolerance(run, scene_file, tmp_path):
    output = tmp_path / "out.zarr"
    code, out, err = run(
        "dataset", scene_file, "--sweeps", 40, "--workers", 1, "--rtol", 1e-4, "-o", output
    )
    assert code == 0 and err.startswith(f"rcskin: note: {scene_file}: the readout is free of noise")
    assert err.count("\n") == 1
    assert out.endswith(f"40 sweeps x 3 frequencies -> {output}\n")
    assert (
        " sweeps of whole sessions were bounded" in out and "; 0 sweeps were solved without" in out
    )
    sweeps = read(output)
    assert 0 < sweeps.attrs["audit_bound"] <= 1e-4
    scene = read_scene(scene_file)
    solver = Solver(scene.parts, 1e-6)
    for k in range(0, 40, 5):
        Z = solver.solve(parse_press(sweeps["press"].values[k], np.nan)).Z
        np.testing.assert_allclose(impedance(sweeps)[k].real, Z.real, rtol=1e-4)
        Cp = parallel_capacitance(Z, scene.frequencies)
        np.testing.assert_allclose(sweeps["Cp"][k], Cp, rtol=1e-4)


def test_a_complete_data_set_is_made_anew_on_demand_only(run, scene_file, tmp_path):
    output = tmp_path / "few.zarr"
    words = ("dataset", scene_file, "--sweeps", 10, "--workers", 1, *LOOSE, "-o", output)
    assert run(*words)[0] == 0
    begun = (output / "zarr.json").stat()
    code, out, _ = run(*words)
    assert (code, out) == (
        0,
        f"{output}: is complete, nothing was computed; --overwrite makes it anew\n",
    )
    assert os.path.samestat((output / "zarr.json").stat(), begun)
    code, out, _ = run(*words, "--overwrite")
    assert code == 0 and "10 sweeps x 3 frequencies" in out
    assert not os.path.samestat((output / "zarr.json").stat(), begun)
    assert sorted(each.name for each in tmp_path.iterdir()) == [scene_file.name, output.name]


def test_the_audit_states_its_sample_and_sweeps(run, scene_file, tmp_path):
    code, out, _ = run("dataset", scene_file, "--sweeps", 10, *LOOSE, "-o", tmp_path / "few.zarr")
    assert (
        code == 0
        and "errors of 20 of the 20 sweeps of whole sessions were bounded, the largest by " in out
    )
    assert (
        "all sweeps are of one skin, because a session has 20; --sweeps 400 draws 20 skins" in out
    )


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (
            ["sheet-3x3", "--sweeps", 0, "-o", "out.zarr"],
            "--sweeps must be from 1 to 1000",
        ),
        (["sheet-3x3", "--sweeps", 5, "-o", "out.nc"], "out.nc: must end in .zarr, got '.nc'"),
        (["sheet-9x9", "--sweeps", 5, "-o", "out.zarr"], "sheet-9x9: no such file"),
        (
            ["sheet-3x3", "--sweeps", 5, "--rtol", 0.1, "-o", "out.zarr"],
            "--rtol must be from 1e-08",
        ),
        (
            ["sheet-3x3", "--sweeps", 5, "--workers", 0, "-o", "out.zarr"],
            "--workers must be from 1 to 256, got 0",
        ),
    ],
)
def test_bad_input_ends_with_one_line_and_code_2(refused, tmp_path, monkeypatch, arguments, told):
    monkeypatch.chdir(tmp_path)
    assert told in refused("dataset", *arguments)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.posix("there one process ends another without a word to it")
@pytest.mark.parametrize(
    ("workers", "number"),
    [(1, signal.SIGTERM), pytest.param(2, signal.SIGINT, marks=pytest.mark.slow)],
)
def test_a_signal_ends_with_one_line_and_leaves_a_data_set_that_goes_on(
    scene_file, tmp_path, workers, number
):
    work = tmp_path / ".out.zarr.unfinished"
    dataset = ["dataset", scene_file, "--sweeps", "9000000", "--workers", str(workers)]
    long_sessions = scene_file.read_text().replace("session = 20", "session = 2000")
    scene_file.write_text(f"readout = 'IM3523'\n{long_sessions}".replace(READOUT, ""))
    process = subprocess.Popen(
        [sys.executable, "-m", "rcskin", *dataset, "-o", tmp_path / "out.zarr"],
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    while process.poll() is None and not list(work.glob("finished/*.json")):
        time.sleep(0.02)
    os.killpg(process.pid, number)
    _, err = process.communicate()
    assert process.returncode == 128 + number
    assert err == "rcskin: interrupted; the same command continues from here\n"
    assert (work / "plan.json").exists() and (work / "model.npz").exists()


@pytest.mark.slow
def test_workers_make_the_same_data_set_on_windows(scene_file, tmp_path):
    """Where each process begins anew, and a folder with an open file stays."""
    made = []
    windows = {"PYTHONPATH": str(SYSTEMS), "RCSKIN_TEST_SYSTEM": "windows"}
    for name, more in {"unix": {}, "windows": windows}.items():
        output = tmp_path / f"{name}.zarr"
        dataset = ["dataset", scene_file, "--sweeps", "10000", "--workers", "2", "-o", output]
        command = [sys.executable, "-m", "rcskin", *dataset]
        subprocess.run(command, check=True, env={**os.environ, **more})
        made.append(read(output)["Cp"])
    np.testing.assert_array_equal(*made)
    assert {path.suffix for path in tmp_path.iterdir()} == {".toml", ".zarr"}
