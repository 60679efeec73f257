"""From the simulated skin through the meter's language to the touch, by the command itself."""

import numpy as np
import pytest
from rcskin import __main__ as rcskin
from rcskin.hardware.control_client import send_request
from rcskin.hardware.virtual.served_skin import instrument, simulated
from rcskin.localization.model.localizer_file import save
from rcskin.localization.model.training import train
from rcskin.simulator.measure.readout import read_out
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import parse_press, press_on
from rcskin.simulator.scene.pixel_grid import Pixels
from rcskin.simulator.scene.scene_files import load_scene, scene_text
from rcskin.simulator.sweeps import InputError, concatenate, read
from typer.testing import CliRunner

SCENE = "strip-1x3"
NOTHING = ["none"] * 3


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    """A model of the strip's columns against rest."""
    path = tmp_path_factory.mktemp("model") / "strip.npz"
    save(path, train(sessions(), "column", quantities=("dlnZ", "dphase")))
    return path


def sessions():
    """Four of simulated sweeps of the strip, at rest and pressed at each column."""
    scene, random = load_scene(SCENE), np.random.default_rng(0)
    presses = [*NOTHING, *(f"1,{j}:{f}" for j in (1, 2, 3) for f in (1.8, 2.0, 2.2))]
    exact = simulate(Solver(scene.parts), [parse_press(press, 2.0) for press in presses])
    return concatenate([read_out(exact, scene.readout, random, k) for k in range(4)])


def test_presses_on_the_simulated_strip_are_answered_at_their_columns(model, serve):
    served = load_scene(SCENE)
    meter = instrument(simulated(served.parts, seed=7), pace=0)
    with serve(meter) as ports:
        where = ["--resource", ports.resource, "--model", str(model)]
        for column in (1, 2, 3):
            rest = model.with_name(f"{column}.nc")
            send_request(f"127.0.0.1:{ports.control}", "press", press="none")
            told = live(*where, "--sweeps", "2", "--log", str(rest))
            assert labels(told) == ["nothing pressed"] * 2
            send_request(f"127.0.0.1:{ports.control}", "press", press=f"1,{column}")
            told = live(*where, "--sweeps", "2", "--rest-file", str(rest))
            assert labels(told) == [f"column {column}"] * 2


def test_a_finger_is_answered_at_its_column_whether_it_presses_or_touches(tmp_path, serve):
    """What a meter reads then is lawful, though Rs rises with frequency: its low terminal is a
    virtual earth, and the finger takes a part of the current."""
    scene = load_scene(SCENE).with_({"surroundings": {}, "press.finger": 5e-12})
    presses = [*NOTHING, *(f"1,{j}:{f}" for j in (1, 2, 3) for f in ("1.0", "1.5", "2.0"))]
    exact = simulate(
        Solver(scene.parts, 1e-4),
        [press_on(scene.parts.skin, scene.press, press) for press in presses],
    )
    random = np.random.default_rng(0)
    swept = concatenate([read_out(exact, scene.readout, random, k) for k in range(4)])
    path, rest = tmp_path / "fingers.npz", tmp_path / "rest.nc"
    save(path, train(swept, "column", quantities=("dlnZ", "dphase")))
    with serve(instrument(simulated(scene.parts, seed=7), pace=0)) as ports:
        where = ["--resource", ports.resource, "--model", str(path)]
        told = live(*where, "--sweeps", "1", "--log", str(rest))
        assert labels(told) == ["nothing pressed"]
        for press in ("1,2:touch", "1,2:1.8:4pF", "1,3:1.8"):
            send_request(f"127.0.0.1:{ports.control}", "press", press=press)
            told = live(*where, "--sweeps", "1", "--rest-file", str(rest))
            assert labels(told) == [f"column {press[2]}"]


def test_two_fingers_are_no_column_to_a_model_of_the_papers_readings(tmp_path, serve):
    """It looks at Rs and Cp as they stand; what guards it looks at changes from rest."""
    save(tmp_path / "raw.npz", train(sessions(), "column", quantities=("Rs", "Cp")))
    served = load_scene(SCENE)
    meter = instrument(simulated(served.parts, seed=7), pace=0)
    with serve(meter) as ports:
        where = ["--resource", ports.resource, "--model", str(tmp_path / "raw.npz")]
        rest = tmp_path / "rest.nc"
        live(*where, "--sweeps", "2", "--log", str(rest))
        for press, told in (("1,2", "column 2"), ("1,1+1,3", "cannot tell")):
            send_request(f"127.0.0.1:{ports.control}", "press", press=press)
            answers = live(*where, "--sweeps", "2", "--rest-file", str(rest))
            assert labels(answers) == [told] * 2


def test_touches_are_followed_by_few_frequencies_where_a_model_inverts_the_simulator(model, serve):
    scene, random = load_scene(SCENE), np.random.default_rng(0)
    presses = [*NOTHING, *(f"1,{j}:{f}" for j in (1, 2, 3) for f in (1.8, 2.2))]
    exact = simulate(Solver(scene.parts), [parse_press(press, 2.0) for press in presses])
    sweeps = concatenate([read_out(exact, scene.readout, random, k) for k in range(3)])
    inverting = model.with_name("inverting.npz")
    made = train(sweeps, "column", "model-based", quantities=("dlnZ", "dphase"))
    save(inverting, made)
    served = load_scene(SCENE)
    meter = instrument(simulated(served.parts, seed=7), pace=0)
    with serve(meter) as ports:
        where = ["--resource", ports.resource, "--model", str(inverting), "--filter"]
        rest = model.with_name("rest.nc")
        assert labels(live(*where, "--sweeps", "3", "--log", str(rest))) == ["nothing pressed"] * 3
        send_request(f"127.0.0.1:{ports.control}", "press", press="1,2")
        where += ["--adaptive", "--rest-file", str(rest)]
        assert labels(live(*where, "--sweeps", "4"))[-2:] == ["column 2"] * 2


def test_two_interfaces_are_read_by_choice_and_shown_on_a_page(tmp_path, serve):
    """Of 2x2 pixels: no sweep is whole, both interfaces are asked, and the answers are right."""
    scene = load_scene("sheet-5x5-two-interfaces")
    sweep = scene.sweep.model_copy(update={"frequencies": (1e3, 5e3, 25e3)})
    scene = scene.model_copy(update={"pixels": Pixels(rows=2, columns=2), "sweep": sweep})
    pixels = [f"{i},{j}" for i in (1, 2) for j in (1, 2)]
    presses = [*NOTHING, *(f"{pixel}:{f}" for pixel in pixels for f in (1.8, 2.2))]
    exact = simulate(Solver(scene.parts), [parse_press(press, 2.0) for press in presses])
    random = np.random.default_rng(0)
    sweeps = concatenate([read_out(exact, scene.readout, random, k) for k in range(2)])
    path = tmp_path / "pixels.npz"
    quantities = ("dlnZ", "dphase")
    save(path, train(sweeps, "pixel", "model-based", quantities=quantities))
    (tmp_path / "two.toml").write_text(scene_text(scene))
    served = load_scene(str(tmp_path / "two.toml"))
    exhibit = simulated(served.parts, seed=7)
    with serve(instrument(exhibit, pace=0)) as ports:
        control = f"127.0.0.1:{ports.control}"
        where = ["--resource", ports.resource, "--model", str(path), "--switch", control]
        where += ["--settle", "0"]
        rest = tmp_path / "rest.nc"
        assert labels(live(*where, "--sweeps", "1", "--log", str(rest))) == ["nothing pressed"]
        send_request(control, "press", press="2,1")
        told = live(*where, "--adaptive", "--page", "--rest-file", str(rest), "--sweeps", "3")
        assert labels(told) == ["pixel 2,1"] * 3


def test_interfaces_with_frequencies_of_their_own_are_read_and_logged_at_these(tmp_path, serve):
    scene = load_scene("sheet-5x5-two-interfaces")
    sweep = scene.sweep.model_copy(update={"frequencies": (1e3, 5e3, 25e3)})
    left, bottom = scene.interfaces
    own = (left.model_copy(update={"frequencies": (5e3, 25e3)}), bottom)
    pixels = Pixels(rows=2, columns=2)
    scene = scene.model_copy(update={"pixels": pixels, "sweep": sweep, "interfaces": own})
    presses = [*NOTHING, *(f"{i},{j}:{f}" for i in (1, 2) for j in (1, 2) for f in (1.8, 2, 2.2))]
    exact = simulate(Solver(scene.parts), [parse_press(press, 2.0) for press in presses])
    random = np.random.default_rng(0)
    sweeps = concatenate([read_out(exact, scene.readout, random, k) for k in range(4)])
    save(tmp_path / "own.npz", train(sweeps, "pixel", quantities=("dlnZ", "dphase")))
    (tmp_path / "own.toml").write_text(scene_text(scene))
    served = load_scene(str(tmp_path / "own.toml"))
    exhibit = simulated(served.parts, seed=7)
    with serve(instrument(exhibit, pace=0)) as ports:
        control, rest = f"127.0.0.1:{ports.control}", tmp_path / "rest.nc"
        where = ["--resource", ports.resource, "--model", str(tmp_path / "own.npz")]
        where += ["--switch", control, "--settle", "0"]
        told = live(*where, "--sweeps", "2", "--log", str(rest))
        assert labels(told) == ["nothing pressed"] * 2
        send_request(control, "press", press="2,1")
        assert labels(live(*where, "--sweeps", "2", "--rest-file", str(rest))) == ["pixel 2,1"] * 2
        with pytest.raises(InputError, match="cannot take `interface.frequencies`"):
            live(*where, "--sweeps", "1", "--page")
    logged = read(rest)
    assert logged["taken"].values.tolist() == [[0, 1, 1], [1, 1, 1]]
    assert np.isfinite(logged["Rs"].values[:, logged["taken"].values == 1]).all()


def live(*arguments):
    result = CliRunner().invoke(rcskin.app, ["live", *arguments])
    if result.exception:
        raise result.exception
    return result.stdout


def labels(told):
    return [line.split("\t")[1] for line in told.splitlines()]
