"""Two interfaces, and five readings of the same wires, from the skin to the answer.

What a switch recorded is as good as simulated.
"""

import numpy as np
import pytest
import rcskin
from rcskin import __main__ as front
from rcskin.hardware.virtual.meter_server import run_in_thread
from rcskin.hardware.virtual.served_skin import instrument, simulated
from rcskin.localization.model.localizer_file import save
from rcskin.simulator.measure.readout import read_out
from rcskin.simulator.scene.scene_files import scene_text
from rcskin.simulator.sweeps import concatenate, impedance, read
from typer.testing import CliRunner

PIXELS = [f"{row},{column}" for row in "12" for column in "12"]
BOTH = ["left", "bottom"]
FIVE = [
    {"name": "left", "high": ["top-left"], "low": ["bottom-left"]},
    {"name": "bottom", "high": ["top-bottom"], "low": ["bottom-bottom"]},
    {"name": "crossed", "high": ["top-left"], "low": ["bottom-bottom"]},
    {"name": "back", "high": ["top-bottom"], "low": ["bottom-left"]},
    {
        "name": "tied",
        "high": ["top-left", "top-bottom"],
        "low": ["bottom-left", "bottom-bottom"],
    },
]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("two")


@pytest.fixture(scope="module", params=[pytest.param("two", marks=pytest.mark.slow), "five"])
def scene(request, folder):
    """The path of a 2x2 sheet with two interfaces, or five readings, at few frequencies."""
    frequencies = np.geomspace(1e3, 1e5, 4).tolist()
    scene = rcskin.load("sheet-5x5-two-interfaces").with_(
        {"pixels": 2, "sweep.frequencies": frequencies}
    )
    if request.param == "five":
        scene = scene.with_({"interface": FIVE})
    path = folder / f"{request.param}.toml"
    path.write_text(scene_text(scene), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def ports(scene):
    """A virtual meter on that sheet."""
    exhibit = simulated(rcskin.load(str(scene)).parts, seed=7)
    with run_in_thread(instrument(exhibit, pace=0)) as ports:
        yield ports


@pytest.fixture(scope="module")
def switch(ports):
    return ["--switch", f"127.0.0.1:{ports.control}", "--settle", "0"]


@pytest.fixture(scope="module")
def recorded(scene, ports, switch, folder):
    """The path of a recording of every pixel at both interfaces."""
    path = folder / f"{scene.stem}-run.nc"
    where = ["--resource", ports.resource, "--control", f"127.0.0.1:{ports.control}"]
    told("meter", "record", scene, *where, *switch, "--repetitions", 1, "--retries", 0, "-o", path)
    return path


@pytest.fixture(scope="module")
def exact(scene):
    """Sweeps without noise: at rest, and every pixel at three strengths."""
    presses = ["none"] * 3 + [f"{pixel}:{k}" for pixel in PIXELS for k in (1.9, 2.0, 2.1)]
    return rcskin.sweep(rcskin.load(scene), presses, rtol=1e-3)


@pytest.fixture(scope="module")
def model(scene, exact, folder):
    """The path of a model of pixels against rest, trained on four simulated sessions."""
    readout, random = rcskin.load(scene).readout, np.random.default_rng(0)
    sweeps = concatenate([read_out(exact, readout, random, k) for k in range(4)])
    path = folder / f"{scene.stem}-pixels.npz"
    save(path, rcskin.train(sweeps, "pixel", quantities=("dlnZ", "dphase")))
    return path


def told(*words):
    result = CliRunner().invoke(front.app, [*map(str, words)])
    if result.exception and not isinstance(result.exception, SystemExit):
        raise result.exception
    assert result.exit_code == 0, result.output
    return result.stdout


def test_what_is_recorded_is_what_is_simulated(recorded, exact):
    sweeps = read(recorded)
    names = list(exact["interface"].values)
    assert list(sweeps["interface"].values) == names
    assert names == BOTH or len(names) == len(FIVE)
    assert set(exact.variables) - set(sweeps.variables) <= {"Rs_error", "Cp_error"}
    simulated = {press: Z for press, Z in zip(exact["press"].values, impedance(exact), strict=True)}
    for press, Z in zip(sweeps["press"].values, impedance(sweeps), strict=True):
        truth = simulated[press if press == "none" else f"{press}:2.0"]
        assert Z == pytest.approx(truth, rel=0.03)


def test_what_is_recorded_is_localized_by_what_is_simulated(recorded, model, folder):
    told("localize", model, recorded, "-o", folder / "told.csv")
    sweeps = read(recorded)
    lines = (folder / "told.csv").read_text().splitlines()[1:]
    right = [
        f'"{row},{column}"' in line
        for line, row, column in zip(
            lines, sweeps["row"].values, sweeps["column"].values, strict=True
        )
        if row > 0
    ]
    assert np.mean(right) >= 8 / 9


@pytest.mark.usefixtures("unpainted")
def test_what_is_recorded_is_evaluated(recorded, model, folder):
    assert "%" in told("evaluate", model, recorded, "-o", folder / "evaluated")


def test_what_is_recorded_trains(recorded, folder):
    told("train", recorded, recorded, "--target", "column", "-o", folder / "own.npz")
    assert (folder / "own.npz").exists()


@pytest.mark.slow
def test_what_is_recorded_calibrates(scene, recorded, folder):
    told("calibrate", scene, recorded, "--fit", "sheet_resistance", "-o", folder / "found")
    found = rcskin.load(folder / "found" / "calibrated.toml")
    true = rcskin.load(scene)
    assert found.skin.top.sheet_resistance == pytest.approx(true.skin.top.sheet_resistance, rel=0.1)


def test_live_finds_pixels_from_all(model, ports, switch):
    from rcskin.hardware.control_client import send_request

    control, where = f"127.0.0.1:{ports.control}", ["--resource", ports.resource]
    send_request(control, "press", press="none")
    log = model.with_suffix(".rest.nc")
    told("live", "--model", model, *where, *switch, "--sweeps", 1, "--log", log)
    for press in ("2,1", "1,2"):
        send_request(control, "press", press=press)
        line = told("live", "--model", model, *where, *switch, "--sweeps", 1, "--rest-file", log)
        assert line.split("\t")[1] == f"pixel {press}"
