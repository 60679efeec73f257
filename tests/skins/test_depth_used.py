"""Skins pressed by depth or force at the command line: trained on, evaluated, told live."""

import logging
import re

import numpy as np
import pytest
from rcskin import __main__ as rcskin
from rcskin.hardware.control_client import send_request
from rcskin.hardware.virtual.meter_server import ControlPort, run_in_thread
from rcskin.hardware.virtual.served_skin import instrument, simulated
from rcskin.simulator.measure.readout import read_out
from rcskin.simulator.measure.sweep_touches import factors_under
from rcskin.simulator.models.mechanics.force_depths import depths_in_words, forces_as_depths
from rcskin.simulator.models.mechanics.indentation import deformation
from rcskin.simulator.press.press import press_on
from rcskin.simulator.scene.scene_files import scene_text
from rcskin.simulator.sweeps import InputError, concatenate, read, write
from rcskin.tests.library.scenes import foam_strip
from typer.testing import CliRunner


def strip(tension=20.0, **press):
    return foam_strip(tension, 50e3, press=press or {"depth": 2e-3})


def run(*arguments):
    done = CliRunner().invoke(rcskin.app, [str(each) for each in arguments])
    assert done.exit_code == 0, done.exception
    return done


@pytest.fixture(scope="module")
def swept(tmp_path_factory):
    """Noise-free sweeps of each pixel by depths and forces, and of the skin at rest."""
    folder = tmp_path_factory.mktemp("strip")
    (folder / "strip.toml").write_text(scene_text(strip()), encoding="utf-8")
    strengths = (":1mm", "", ":2.2mm", ":3N")
    presses = ["none"] * 6 + [f"1,{j}{by}" for j in (1, 2, 3) for by in strengths]
    asked = [part for press in presses for part in ("--press", press)]
    output = folder / "swept.nc"
    run("sweep", folder / "strip.toml", *asked, "--model", "reduced", "--rtol", 1e-3, "-o", output)
    return output


def test_positions_are_learned_from_presses_by_depth_and_force(swept):
    model, answers = swept.with_name("places.npz"), swept.with_name("answers.csv")
    seen = ("--features", "dlnZ,dphase", "--target", "position")
    run("train", swept, *seen, "-o", model)
    assert "median error, mm" in run("evaluate", model, swept).stdout
    run("localize", model, swept, "-o", answers)
    rows = [line.split(",")[-6:] for line in answers.read_text().splitlines()[1:]]
    told = np.array([[float(x), float(factor)] for x, _, factor, *_ in rows[6:]])
    scene = strip()
    depths = np.array([1e-3, 2e-3, 2.2e-3])
    factors = told[:, 1].reshape(3, 4)
    np.testing.assert_allclose(
        factors[:, :3], [scene.parts.skin.pressed_factors(depths)] * 3, rtol=0.2
    )
    assert (np.abs(told[:, 0].reshape(3, 4) - [[15], [45], [75]]) < 15).all()


def test_live_finds_columns_of_a_skin_pressed_by_depth(swept):
    model, random = swept.with_name("columns.npz"), np.random.default_rng(0)
    several = [read_out(read(swept), strip().readout, random, k) for k in range(4)]
    write(concatenate(several), swept.with_name("several.nc"))
    run("train", swept.with_name("several.nc"), "--features", "dlnZ,dphase", "-o", model)
    meter = instrument(simulated(strip().parts, seed=7), pace=0)
    with run_in_thread(meter, ControlPort(meter, ())) as ports:
        where = ["--resource", ports.resource, "--model", model, "--sweeps", 2]
        rest = swept.with_name("rest.nc")
        run("live", *where, "--log", rest)
        for column, by in ((1, ""), (3, ":1.5mm")):
            send_request(f"127.0.0.1:{ports.control}", "press", press=f"1,{column}{by}")
            told = run("live", *where, "--rest-file", rest).stdout
            assert told.count(f"column {column}") == 2


def test_forces_stand_for_the_depths_that_they_take(caplog):
    """Without tension of the foam's own law; with it of what the membrane adds."""
    scene = strip(tension=0.0, force=4.0)
    foam, area = scene.skin.foam.mechanics, 0.03 * 0.03
    (factor,) = factors_under(scene.parts.skin, scene.press, "1,1:4N")
    strain = foam.strain_at(np.array(factor))
    assert foam.elastic.stress(strain) * area == pytest.approx(4.0, rel=1e-6)
    with caplog.at_level(logging.INFO):
        depth = forces_as_depths(scene.parts).plan.press.depth
    assert depth == pytest.approx(strain * 4e-3, rel=1e-6)
    assert "4 N press pixels" in caplog.text
    assert forces_as_depths(strip(tension=20.0, force=4.0).parts).plan.press.depth < depth


@pytest.mark.slow
def test_scenes_pressed_by_force_are_drawn_and_calibrated(tmp_path):
    even = {"unevenness": 0.0, "foam_spread": 0.0, "sweeps_per_session": 20}
    scene = strip(force=4.0).with_({"dataset.session": even})
    (tmp_path / "strip.toml").write_text(scene_text(scene), encoding="utf-8")
    paths = [tmp_path / name for name in ("strip.toml", "swept.nc", "set.zarr", "found")]
    run("sweep", paths[0], "--rtol", 1e-3, "-o", paths[1])
    run("calibrate", paths[0], paths[1], "--fit", "sheet_resistance", "-o", paths[3])
    found = (paths[3] / "parameters.csv").read_text()
    value = float(found.splitlines()[1].split(",")[2])
    assert value == pytest.approx(0.0, abs=0.01)
    run("dataset", paths[0], "--sweeps", 5, "--rtol", 1e-3, "--workers", 1, "-o", paths[2])


def test_a_force_that_closes_the_cells_is_refused_in_a_line():
    with pytest.raises(InputError, match="force must leave the depth"):
        forces_as_depths(strip(force=1e4).parts)


@pytest.mark.parametrize(("tension", "force"), [(0.0, 4.0), (20.0, 4.0), (20.0, 1.5)])
def test_every_command_says_how_deep_a_force_goes(tmp_path, tension, force):
    """As deep as the press that takes this force."""
    scene, path = strip(tension, force=force), tmp_path / "strip.toml"
    path.write_text(scene_text(scene), encoding="utf-8")
    done = run("sweep", path, "--press", "1,2", "--press", "none", "-o", tmp_path / "a.nc")
    (depth,) = re.findall(rf"note: press 1,2:{force:g}N: ([\d.]+) mm deep", done.stderr)
    back = deformation(
        scene.parts.skin, press_on(scene.parts.skin, scene.press, f"1,2:{depth}mm"), 1e-2
    ).force
    assert back == pytest.approx([force], rel=0.02)
    assert len(re.findall(r" mm deep", done.stderr)) == 1
    shown = re.search(rf"by {force:g} N, ([\d. to]+) mm deep", run("describe", path).stdout)[1]
    ends = shown.split(" to ")
    assert float(ends[0]) <= float(depth) <= float(ends[-1])
    assert len({*ends}) == len(ends) and (tension or ends == [depth])
    meter = instrument(simulated(scene.parts, seed=7), pace=0)
    with run_in_thread(meter, ControlPort(meter, ())) as ports:
        control = f"127.0.0.1:{ports.control}"
        assert f"{depth} mm deep" in run("meter", "press", "1,2", "--control", control).stderr
        assert run("meter", "press", "1,2:1mm", "--control", control).stderr == ""


def test_many_presses_by_a_force_are_summarized_in_one_line():
    scene = strip(0.0, force=4.0)
    presses = [
        press_on(scene.parts.skin, scene.press, f"1,1:{force}N") for force in np.linspace(1, 5, 40)
    ]
    (line,) = depths_in_words(scene.parts.skin, presses)
    assert re.fullmatch(r"40 presses by force are [\d.]+ to [\d.]+ mm deep .*", line)
    assert (
        depths_in_words(
            scene.parts.skin,
            [
                press_on(scene.parts.skin, scene.press, "none"),
                press_on(scene.parts.skin, scene.press, "1,1:1mm"),
            ],
        )
        == []
    )
