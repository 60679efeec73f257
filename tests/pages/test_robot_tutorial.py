"""The tutorial of a robot that feels: its scene and its robot are read, and all of it runs."""

import re
import sys
from pathlib import Path

import pytest
from rcskin.simulator.scene.scene_files import load_scene

from .reading import ROOT, blocks, commands
from .test_commands_of_pages import missing_inputs, run

PAGE = "docs/tutorials/a-robot-that-feels.md"
FILM_BYTES = 1e6
mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed: pip install '.[mujoco]'")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with the files that the page has one save."""
    monkeypatch.chdir(tmp_path)
    for name, language in (("strip.toml", "toml"), ("feel.py", "py")):
        (block,) = blocks(PAGE, language)
        (tmp_path / name).write_text(block, encoding="utf-8")
    return tmp_path


def test_the_scene_is_one_and_the_robot_has_the_site_that_carries_it(folder):
    assert load_scene("strip.toml").readout.multisine is not None
    robot = re.search(r'ROBOT = """(.*?)"""', (folder / "feel.py").read_text("utf-8"), re.DOTALL)
    model = mujoco.MjModel.from_xml_string(robot[1])
    assert mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, "skin") == 0 and model.nu == 2
    compile((folder / "feel.py").read_text("utf-8"), "feel.py", "exec")


def test_commands_take_what_was_made_before():
    made = {"strip.toml", "felt.nc"}
    assert {line: missing_inputs(line, made) for line in commands(PAGE)} == dict.fromkeys(
        commands(PAGE), set()
    )


def test_the_film_is_small():
    assert (ROOT / PAGE).with_suffix(".gif").stat().st_size < FILM_BYTES


@pytest.mark.slow
def test_the_tutorial_runs_in_its_order(folder, monkeypatch, capsys):
    pytest.importorskip("onnx", reason="ONNX is not installed: pip install '.[onnx]'")
    monkeypatch.setattr(sys, "path", [str(folder), *sys.path])
    before, after = commands(PAGE)[:3], commands(PAGE)[3:]
    for line in before:
        run(monkeypatch, line)
    exec(compile(Path("feel.py").read_text("utf-8"), "feel.py", "exec"), {})
    error = float(re.search(r"median error ([\d.]+) mm", capsys.readouterr().out)[1])
    assert error < 4
    for line in after:
        run(monkeypatch, line)
    assert all(Path(name).exists() for name in ("film.gif", "felt-lerobot", "touch.onnx"))
