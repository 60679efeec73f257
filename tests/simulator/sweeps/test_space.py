"""What does not fit in memory or on disk is refused before it begins, with how much there is."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from rcskin.hardware.record.operators import standard_order
from rcskin.localization.study.point import EvaluationSettings
from rcskin.simulator import processes
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press
from rcskin.simulator.press.touch import Touch
from rcskin.simulator.scene.scene_files import load_scene, scene_text
from rcskin.simulator.sweeps import InputError, free_space

CORNER = Press((Touch(1, 1, 2.0),))


@pytest.fixture
def machine(monkeypatch):
    """A machine with so many bytes of memory and of disk free, and every byte checked."""
    monkeypatch.setattr(free_space, "ALWAYS_FREE", 0)

    def machine(memory=1e12, disk=1e12):
        usage = type(shutil.disk_usage("."))
        monkeypatch.setattr(free_space, "free_memory", lambda: memory)
        monkeypatch.setattr(free_space.shutil, "disk_usage", lambda _: usage(2 * disk, disk, disk))

    return machine


def test_memory_that_is_free_is_a_number_of_this_machine():
    assert 1e7 < free_space.free_memory() < 1e15


@pytest.mark.skipif(
    processes.sys.platform != "linux", reason="other systems have no control groups"
)
def test_a_container_leaves_what_its_limit_allows(monkeypatch, tmp_path):
    """The cache of files in it is free; groups above it have no limit, as the root has none."""
    monkeypatch.setattr(free_space, "CONTROL_GROUP", tmp_path)
    own = Path("/proc/self/cgroup").read_text().rpartition("0::/")[2].strip()
    stated = {"max": "9000000\n", "current": "8000000\n", "stat": "file 9\ninactive_file 500000\n"}
    (tmp_path / own).mkdir(parents=True, exist_ok=True)
    for name, text in stated.items():
        (tmp_path / own / f"memory.{name}").write_text(text)
    assert free_space.free_memory() == 1.5e6
    (tmp_path / own / "memory.max").write_text("max\n")
    assert free_space.free_memory() > 1e7


LIMITED = """
import resource
from rcskin.simulator.sweeps.free_space import free_memory
free_memory()
used = 4096 * int(open("/proc/self/statm").read().split()[0])
resource.setrlimit(resource.RLIMIT_AS, (used + 2**27, used + 2**27))
print(free_memory() / 2**27)
"""


@pytest.mark.skipif(processes.sys.platform != "linux", reason="of Linux")
def test_a_limit_of_address_space_leaves_what_is_not_taken_yet():
    done = subprocess.run([sys.executable, "-c", LIMITED], capture_output=True, text=True)
    assert float(done.stdout) == pytest.approx(1, abs=0.1), done.stderr


@pytest.mark.parametrize(
    ("size", "told"), [(0, "0 bytes"), (999, "999 bytes"), (4.2e10, "42 GB"), (5e20, "500000 PB")]
)
def test_amounts_are_written_as_people_say_them(size, told):
    assert free_space.amount(size) == told


def test_pixels_that_need_more_than_there_is_are_refused_at_once(machine):
    machine(memory=16e9)
    many = load_scene("glove").with_({"pixels": {"rows": 1000, "columns": 1000}})
    with pytest.raises(InputError, match=r"1000 x 1000 cells would need \d+ GB.*at most 14 GB"):
        Solver(many.parts, 1e-2).solve(CORNER)


def test_what_varies_by_place_is_refused_as_soon(machine):
    machine(memory=16e9)
    varied = {"skin.top.map": {"kind": "gradient", "x": 0.1}}
    many = load_scene("glove").with_({"pixels": {"rows": 1000, "columns": 1000}, **varied})
    with pytest.raises(InputError, match=r"1000 x 1000 cells would need \d+ GB.*at most 14 GB"):
        Solver(many.parts, 1e-2).solve(CORNER)


def test_the_same_pixels_are_solved_where_memory_suffices(machine):
    few = load_scene("sheet-3x3")
    machine(memory=1e5)
    with pytest.raises(InputError, match="of memory"):
        Solver(few.parts, 1e-2).solve(CORNER)
    machine()
    assert Solver(few.parts, 1e-2).solve(CORNER).Z.shape == (1, 20)


def test_commands_say_that_memory_or_disk_are_too_small(run, tmp_path, machine):
    machine(memory=1e3, disk=1e9)
    code, _, err = run("sweep", "strip-1x3", "-o", tmp_path / "out.nc")
    assert code == 2 and "4 sweeps of 3 readings would need 1.4 kB of memory" in err
    machine(disk=1e9)
    out = tmp_path / "data.zarr"
    code, _, err = run("dataset", "glove", "--sweeps", 10**12, "-o", out)
    assert code == 2 and not out.exists() and not list(tmp_path.iterdir())
    last = err.splitlines()[-1]
    assert "1000000000000 sweeps" in last and "at most 900 MB are free" in last


LARGE = {"pixels": {"rows": 1000, "columns": 1000}}


@pytest.mark.parametrize(
    ("command", "told"),
    [
        (["design"], r"all pairs of presses on 1000 x 1000 pixels would need \d+ TB"),
        (["design", "--target", "pair"], r"on 1000 x 1000 pixels would need \d+ PB"),
        (["study", "--vary", "skin.top.sheet_resistance=1e3,2e3"], "at most 100 cells along"),
        (["page"], r"2000 x 2000 cells would need \d+ GB of memory; at most 14 GB"),
        (["dataset", "--sweeps", 10], "at most 100 cells along"),
        (["limits"], r"cells would need \d+ GB of memory"),
    ],
    ids=lambda each: " ".join(map(str, each)) if isinstance(each, list) else "",
)
def test_commands_refuse_a_million_pixels_in_a_line(refused, tmp_path, machine, command, told):
    machine(memory=16e9)
    scene = tmp_path / "large.toml"
    scene.write_text(scene_text(load_scene("glove").with_(LARGE)), encoding="utf-8")
    ending = {"study": ".csv", "page": ".html", "dataset": ".zarr"}.get(command[0], "")
    err = refused(command[0], scene, *command[1:], "-o", tmp_path / f"out{ending}")
    assert re.search(told, err.splitlines()[-1])


def test_repetitions_that_memory_does_not_bear_are_refused(machine):
    machine(memory=1e9)
    often = load_scene("glove").with_({"experiment.repetitions": 10**6})
    with pytest.raises(InputError, match="sweeps of 20 readings would need"):
        EvaluationSettings(repeated=True).check(often.parts)
    with pytest.raises(InputError, match="10000 sweeps of each of 100 x 100 pixels would need"):
        standard_order(100, 100, 10_000)
