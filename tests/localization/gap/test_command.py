"""`rcskin gap` as its user meets it, on skins of the simulator."""

import json
from functools import partial

import numpy as np
import pytest
import rcskin
from rcskin.localization.model.localizer_file import load, save
from rcskin.localization.model.training import train
from rcskin.simulator.measure.experiment import planned_presses
from rcskin.simulator.measure.readout import read_out
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.models.parameters import parts_with
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import every_press
from rcskin.simulator.scene.scene_files import load_scene, scene_text
from rcskin.simulator.sweeps import read, write

ENTRIES = {"about", "accuracy", "calibration", "causes", "causes_together", "compared",
           "discrepancy", "distance", "features", "frequency_Hz", "interfaces", "meter_error",
           "notes", "question", "software"}  # fmt: skip


@pytest.fixture
def gap(run):
    """Runs `rcskin gap ARGUMENTS`, as `run`."""
    return partial(run, "gap")


def recorded(scene, seed, factor=1.0):
    """The scene's experiment with sheets of a factor on their resistance, read by its meter."""
    skin = parts_with(scene.parts, {"sheet_resistance": np.log(factor)}).scene
    presses = planned_presses(scene.parts.skin, scene.parts.plan, np.random.default_rng(seed))
    exact = simulate(Solver(skin.parts), presses)
    return read_out(exact, scene.readout, np.random.default_rng(seed + 1))


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Sweeps simulated of the strip of three pixels, and a twin's of 20 % more resistance."""
    folder, scene = tmp_path_factory.mktemp("sweeps"), load_scene("strip-1x3")
    told = {"scene": scene_text(scene), "model": "measured", "twin": "20 % more resistance"}
    twin = recorded(scene, 5, factor=1.2).drop_attrs().assign_attrs(told)
    paths = folder / "simulated.nc", folder / "twin.nc"
    for sweeps, path in zip((recorded(scene, 1), twin), paths, strict=True):
        write(sweeps, path)
    return paths


@pytest.mark.usefixtures("unpainted")
def test_a_sheet_resistance_is_named_and_calibration_brings_accuracy_up(
    gap, files, tmp_path, earth_alone
):
    code, out, err = gap(*files, "-o", tmp_path / "gap", "--draws", 2)
    assert code == 0 and earth_alone(err), err
    assert "Sheet resistance explains most of the gap" in out
    assert out.endswith(f" twin sweeps -> {tmp_path / 'gap' / 'gap.html'}\n")
    assert {path.name for path in (tmp_path / "gap").iterdir()} == {"gap.html", "gap.json"}
    found = json.loads((tmp_path / "gap" / "gap.json").read_text())
    assert set(found) == ENTRIES
    before, after = (found["accuracy"]["transfer"][name] for name in ("before", "after"))
    assert after["absolute"]["0"]["mean"] > before["absolute"]["0"]["mean"] + 0.2
    sheet = next(each for each in found["calibration"] if each["unit"] == "ohm/sq")
    assert sheet["low"] / sheet["start"] < 1.2 < sheet["high"] / sheet["start"]
    assert sheet["value"] == pytest.approx(1.2 * sheet["start"], rel=0.03)


def test_a_script_finds_the_same_gap(gap, files, tmp_path):
    _, out, _ = gap(*files, "-o", tmp_path / "typed", "--draws", 1)
    found = rcskin.gap(*files, draws=1)
    found.write(tmp_path / "written")
    for name in ("gap.json", "gap.html"):
        written, typed = (tmp_path / folder / name for folder in ("written", "typed"))
        assert written.read_bytes() == typed.read_bytes()
    assert all(sentence in out for sentence in found.summary)
    assert "Sheet resistance explains most" in found.summary[-1]
    shown = found._repr_html_()
    assert shown.count("<svg") == 1 and "after calibration" in shown and "Rs (%)" in shown
    assert repr(found).startswith("Simulation and twin: the gap\n")
    assert "\ntrained on" in repr(found)


@pytest.mark.usefixtures("linear_intervals")
def test_sweeps_without_noise_or_scene_are_served_by_the_scene_named(
    gap, files, tmp_path, monkeypatch
):
    monkeypatch.setattr("rcskin.localization.gap.gap_report.charts_of", lambda *given: [])
    bare = tmp_path / "bare.nc"
    scene = load_scene("strip-1x3")
    exact = simulate(
        Solver(load_scene("strip-1x3").parts),
        every_press(scene.parts.skin, scene.press),
    )
    write(exact.isel(frequency=slice(None, None, 2)).assign_attrs(scene=""), bare)
    code, out, _ = gap(bare, files[1], "-o", tmp_path, "--scene", "strip-1x3", "--draws", 1)
    assert code == 0
    assert "simulated again" in out and "have no noise" in out and "after calibration" in out


@pytest.mark.usefixtures("linear_intervals", "unpainted")
def test_the_users_own_model_is_asked_as_it_is_and_adapted(gap, files, tmp_path, earth_alone):
    model = tmp_path / "m.npz"
    simulated, twin = map(read, files)
    save(model, train(simulated, quantities=("Rs", "Cp")))
    code, out, err = gap(*files, "--model", model, "-o", tmp_path / "gap", "--draws", 2)
    assert code == 0 and earth_alone(err), err
    assert "the model as it is" in out and "the model, adapted by k = 2" in out
    assert (
        "The model on the twin sweeps (columns): right of all" in out
        and "simulation alone" not in out
    )
    found = json.loads((tmp_path / "gap" / "gap.json").read_text())
    by_model, own = found["accuracy"]["model"]["adapted"], load(model)
    assert found["features"] == {"model": ["Rs", "Cp"]}
    assert by_model["2"]["mean"] >= by_model["0"]["mean"]
    calibrating = found["compared"]["other"]["calibrating"]
    assert by_model["0"]["tested"] == twin.sizes["sweep"] - calibrating
    right = (own.answers(twin).labels == twin["column"].values.astype(str)).mean()
    assert by_model["0"]["mean"] == pytest.approx(right, abs=0.15)
    assert 'id="belief"' in (tmp_path / "gap" / "gap.html").read_text()


def test_a_model_leaves_no_choice_of_target(gap, files, tmp_path):
    model = tmp_path / "m.npz"
    save(model, train(read(files[0])))
    code, _, err = gap(*files, "--model", model, "--target", "row", "-o", tmp_path / "gap")
    both = "rcskin: --model already sets target and estimator: leave out --target and --estimator\n"
    assert (code, err) == (2, both)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("absent.nc", 1), "absent.nc: no such file"),
        ((1, 0), "twin.nc: contains twin sweeps; name the simulated sweeps first"),
        ((0, 1, "--target", "position"), "--target must be one of column, row, pixel"),
        ((0, 1, "--estimator", "oracle"), "'oracle'"),
        ((0, 1, "--scene", "no-such-scene"), "no-such-scene: no such file"),
    ],
)
def test_bad_input_is_one_line_and_leaves_nothing(gap, files, tmp_path, arguments, message):
    paths = [files[each] if isinstance(each, int) else each for each in arguments]
    code, out, err = gap(*paths, "-o", tmp_path / "gap")
    assert (code, out) == (2, "")
    assert err.count("\n") == 1 and message in err
    assert not (tmp_path / "gap").exists() or not [*(tmp_path / "gap").iterdir()]


def test_sides_of_other_interfaces_are_refused(gap, files, tmp_path):
    other = tmp_path / "other.nc"
    write(read(files[1]).assign_coords(interface=["elsewhere"]), other)
    code, _, err = gap(files[0], other, "-o", tmp_path / "gap")
    assert code == 2
    assert err == "rcskin: no interface in common: left and elsewhere\n"
