"""A skin of one's own from the first file to live answers, at the command line, figures judged."""

import csv
import json
import socket
import subprocess
import sys
import time
import tomllib

import numpy as np
import pytest
from rcskin.__main__ import app
from rcskin.simulator.sweeps import read
from typer.testing import CliRunner

pytestmark = pytest.mark.slow

HIDDEN = {"top": 26e3, "bottom": 33e3, "permittivity": 2.2}
"""Of the skin on the meter: ohm/sq and of the foam; its user measured 20e3, 35e3 and 2."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Where the user works."""
    return tmp_path_factory.mktemp("glove")


@pytest.fixture(scope="module")
def rcskin(folder):
    """A command that has to end well; gives what it printed."""

    def rcskin(line, **more):
        with pytest.MonkeyPatch.context() as inside:
            inside.chdir(folder)
            done = CliRunner().invoke(app, line.split(), **more)
        assert done.exit_code == 0, f"{line}: {done.output} {done.exception!r}"
        return done.stdout

    return rcskin


@pytest.fixture(scope="module")
def scene(rcskin, folder):
    """The user's file, and one of the skin as it really is."""
    rcskin("new glove.toml")
    text = (folder / "glove.toml").read_text()
    for measured, hidden in (
        ("top.sheet_resistance = 20e3", f"top.sheet_resistance = {HIDDEN['top']}"),
        ("bottom.sheet_resistance = 35e3", f"bottom.sheet_resistance = {HIDDEN['bottom']}"),
        ("relative_permittivity = 2.0", f"relative_permittivity = {HIDDEN['permittivity']}"),
    ):
        assert measured in text
        text = text.replace(measured, hidden)
    (folder / "hidden.toml").write_text(text)
    return folder / "glove.toml"


@pytest.fixture(scope="module")
def ports(scene, folder):
    """Of the meter with the hidden skin, and of the hand that presses it."""
    ports = [_free_port() for _ in range(2)]
    words = f"meter serve --scene hidden.toml --port {ports[0]} --control-port {ports[1]} --pace 0"
    served = subprocess.Popen([sys.executable, "-m", "rcskin", *words.split()], cwd=folder)
    for port in ports:
        _wait_for(port, served)
    yield ports
    served.terminate()
    served.wait(10)


def _free_port():
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return free.getsockname()[1]


def _wait_for(port, served, patience=60.0):
    until = time.monotonic() + patience
    while time.monotonic() < until and served.poll() is None:
        try:
            socket.create_connection(("127.0.0.1", port), timeout=1).close()
            return
        except OSError:
            time.sleep(0.1)
    raise AssertionError(f"nothing listens at {port}")


@pytest.fixture(scope="module")
def resource(ports):
    return f"TCPIP0::127.0.0.1::{ports[0]}::SOCKET"


@pytest.fixture(scope="module")
def recorded(rcskin, scene, resource, ports, folder):
    rcskin(
        f"meter record glove.toml --resource {resource} --control 127.0.0.1:{ports[1]} "
        "--repetitions 4 --unattended -o run.nc"
    )
    return folder / "run.nc"


@pytest.fixture(scope="module")
def model(rcskin, scene, folder):
    rcskin("dataset glove.toml --sweeps 3000 --seed 1 --workers 1 -o train.zarr")
    rcskin("train train.zarr --target column --features dlnZ,dphase -o columns.npz")
    return folder / "columns.npz"


def test_what_the_scene_says_is_described(rcskin, scene, folder):
    told = rcskin("describe glove.toml -o glove.svg")
    assert "90 x 60 mm" in told.replace("×", "x") and "give the same sweeps" in told
    assert "left" in (folder / "glove.svg").read_text()


def test_the_simulated_sweeps_are_seen(rcskin, scene, folder):
    rcskin("sweep glove.toml -o exact.nc")
    rcskin("plot exact.nc -o exact.svg")
    picture = (folder / "exact.svg").read_text()
    assert all(f"column {n}" in picture or f"1,{n}" in picture for n in (1, 2, 3, 4))
    assert read(folder / "exact.nc").sizes["sweep"] == 13


def test_the_recording_is_of_the_hidden_skin(recorded, rcskin, scene, folder):
    rcskin("sweep hidden.toml -o truth.nc")
    measured, truth = read(recorded), read(folder / "truth.nc")
    for pixel in ((0, 0), (2, 3)):
        mean, true = (_mean_Cp(each, pixel) for each in (measured, truth))
        np.testing.assert_allclose(mean, true, rtol=0.02)


def _mean_Cp(sweeps, pixel):
    """Of all sweeps with this pixel pressed; (0, 0) at rest."""
    where = (sweeps["row"] == pixel[0]) & (sweeps["column"] == pixel[1])
    assert where.any()
    return sweeps["Cp"].values[where].mean(axis=0)


@pytest.fixture(scope="module")
def accuracy(rcskin, model, recorded, folder):
    """Of the columns of the recorded sweeps."""
    rcskin("evaluate columns.npz run.nc -o judged")
    with (folder / "judged" / "figures.csv").open(newline="") as file:
        figures = {row["figure"]: row["value"] for row in csv.DictReader(file)}
    return float(figures["right of all"])


def test_columns_are_found_on_a_skin_never_seen(rcskin, recorded, accuracy):
    answers = rcskin("localize columns.npz run.nc").splitlines()
    assert len(answers) == 1 + read(recorded).sizes["sweep"]
    assert accuracy >= 0.85


@pytest.mark.parametrize("pixel", ["2,1", "3,4"])
def test_live_answers_for_the_pixel_that_is_pressed(
    rcskin, model, recorded, resource, ports, pixel
):
    rcskin(f"meter press {pixel} --control 127.0.0.1:{ports[1]}")
    told = rcskin(f"live --model columns.npz --resource {resource} --rest-file run.nc --sweeps 3")
    assert f"column {pixel[-1]}\t" in told


@pytest.fixture(scope="module")
def calibrated(rcskin, recorded, folder):
    rcskin("calibrate glove.toml run.nc -o found")
    return folder / "found" / "calibrated.toml"


def test_calibration_finds_what_was_hidden(calibrated):
    with calibrated.open("rb") as file:
        skin = tomllib.load(file)["skin"]
    total = sum(skin[sheet]["sheet_resistance"] for sheet in ("top", "bottom"))
    assert total == pytest.approx(HIDDEN["top"] + HIDDEN["bottom"], rel=0.02)


def test_the_calibrated_scene_is_nearer_to_the_skin(rcskin, calibrated, recorded, folder):
    rcskin("sweep found/calibrated.toml -o after.nc")
    rcskin("sweep glove.toml -o before.nc")
    before, after = (_distance(folder / f"{each}.nc", recorded) for each in ("before", "after"))
    assert after < 0.2 * before
    assert "%" in rcskin("gap after.nc run.nc -o gap")


def _distance(simulated, recorded):
    """Root mean square of the relative difference of Cp at rest."""
    both = (read(file) for file in (simulated, recorded))
    one, other = (_mean_Cp(each, (0, 0)) for each in both)
    return float(np.sqrt(((one / other - 1) ** 2).mean()))


def test_no_localizer_surpasses_the_limits(rcskin, accuracy, folder):
    rcskin("limits glove.toml -o limits")
    possible = json.loads((folder / "limits" / "limits.json").read_text())["accuracy"]
    assert accuracy <= possible["column"]["best_possible"]
    assert possible["row"]["best_possible"] < 0.6, "rows that mirror each other cannot be told"
