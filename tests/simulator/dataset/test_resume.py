"""Killed at any point and started again, a data set ends with the same bytes."""

import os
import re
import signal
import subprocess
import sys
import time
from dataclasses import replace

import pytest
from rcskin.simulator.dataset.generation import generate
from rcskin.simulator.models.reduced.model_file import load
from rcskin.simulator.sweeps import InputError, read
from rcskin.simulator.sweeps.output_files import replacing

RUN = [sys.executable, "-c", "import toy_family; toy_family.main()"]
SWEEPS = 400


@pytest.fixture
def tokens(tmp_path_factory):
    """A folder of tokens, as `ToyFamily` takes them."""
    return tmp_path_factory.mktemp("tokens")


def started(output, processes, tokens):
    return subprocess.Popen([*RUN, output, str(SWEEPS), str(processes), tokens])


def finished_blocks(output):
    return len(list(output.parent.glob(f".{output.name}.unfinished/finished/[0-9]*.json")))


def killed_after(sessions, tokens, process):
    """Killed within a block, or soon after its start where it may begin no session."""
    for number in range(sessions):
        (tokens / str(number)).touch()
    while any(tokens.iterdir()):
        time.sleep(0.01)
    time.sleep(0.1)
    assert process.poll() is None
    process.send_signal(signal.SIGKILL)
    process.wait()


@pytest.mark.parametrize(
    ("processes", "kills"), [pytest.param(1, [0, 7, 1], marks=pytest.mark.slow), (2, [9])]
)
def test_killed_several_times_it_ends_with_the_same_bytes(
    make, toy, tmp_path, tokens, processes, kills
):
    whole = toy.bytes_of(make("whole", toy.small_plan(SWEEPS, block=2)))
    output = tmp_path / "out.zarr"
    for sessions in kills:
        killed_after(sessions, tokens, started(output, processes, tokens))
        assert not output.exists()
    assert 0 < finished_blocks(output) < SWEEPS // 20
    tokens.rmdir()
    assert started(output, processes, tokens).wait() == 0
    assert toy.bytes_of(output) == whole
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out.zarr", "whole.zarr"]


KILLED_WHILE_WRITING = """
import os, pathlib, signal
import toy_family

def killed(path, target, rename=pathlib.Path.replace):
    if path.parent.name == "Rs" and path.name.startswith("c.") and target.name == "c.1.0.0":
        os.kill(os.getpid(), signal.SIGKILL)
    return rename(path, target)

pathlib.Path.replace = killed
toy_family.main()
"""


def test_a_chunk_that_was_being_written_is_no_chunk(make, toy, tmp_path):
    """As Zarr writes it: its name is given to it last."""
    output = tmp_path / "out.zarr"
    command = [sys.executable, "-c", KILLED_WHILE_WRITING, output, "100", "1", tmp_path / "none"]
    assert subprocess.run(command).returncode == -signal.SIGKILL
    chunks = {path.name for path in tmp_path.glob(".out.zarr.unfinished/data.zarr/Rs/c.*")}
    assert "c.0.0.0" in chunks and "c.1.0.0" not in chunks and len(chunks) == 2
    plan = toy.small_plan(100, block=2)
    assert toy.bytes_of(make("out", plan)) == toy.bytes_of(make("whole", plan))


def test_two_processes_do_not_write_one_output(make, toy, tmp_path, tokens):
    first = started(tmp_path / "out.zarr", 1, tokens)
    (tokens / "0").touch()
    while any(tokens.iterdir()):
        time.sleep(0.01)
    with pytest.raises(InputError, match=r"out\.zarr: another process is writing it"):
        make("out", toy.small_plan(SWEEPS, block=2))
    tokens.rmdir()
    assert first.wait() == 0


def interrupted(toy, output, plan):
    """A run that ends after its first block."""

    def stop(work, done, total):
        if done:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        generate(plan, output, progress=stop, training=toy.training())


@pytest.mark.parametrize(
    ("other", "told"),
    [
        ({"seed": 2}, "seed 1 where 2 is requested"),
        ({"sweeps": 90}, "sweeps 100 where 90 is requested"),
        ({"foam_spread": 0.0}, "another scene"),
    ],
)
def test_another_plan_is_refused_unfinished_or_whole(make, toy, tmp_path, other, told):
    plan = toy.small_plan(100, block=2)
    changed = toy.small_plan(**{"sweeps": 100, "block": 2, **other})
    interrupted(toy, tmp_path / "out.zarr", plan)
    with pytest.raises(InputError, match=f"an unfinished data set has {told}"):
        make("out", changed)
    make("out", plan)
    with pytest.raises(InputError, match=f"exists with {told}"):
        make("out", changed)


def test_a_whole_data_set_is_left_alone_unless_it_is_to_be_replaced(make, toy):
    before = os.stat(make("out", toy.small_plan(50))).st_mtime_ns
    assert os.stat(make("out", toy.small_plan(50))).st_mtime_ns == before
    with replacing():
        assert os.stat(make("out", toy.small_plan(50))).st_mtime_ns > before
        assert read(make("out", toy.small_plan(60))).sizes["sweep"] == 60


def test_other_files_are_never_replaced(make, toy, tmp_path):
    (tmp_path / "out.zarr").mkdir()
    (tmp_path / "out.zarr" / "kept.txt").write_text("mine")
    with pytest.raises(InputError, match="already exists with no data set .*; --overwrite repl"):
        make("out", toy.small_plan(10))
    assert (tmp_path / "out.zarr" / "kept.txt").read_text() == "mine"
    assert [path.name for path in tmp_path.iterdir()] == ["out.zarr"]


@pytest.mark.parametrize("lost", ["zarr.json", "Rs/zarr.json", "*/zarr.json"])
def test_a_store_that_was_not_yet_made_is_made(make, toy, tmp_path, lost):
    plan = toy.small_plan(100, block=2)
    interrupted(toy, tmp_path / "out.zarr", plan)
    for each in (tmp_path / ".out.zarr.unfinished" / "data.zarr").glob(lost):
        each.unlink()
    assert toy.bytes_of(make("out", plan)) == toy.bytes_of(make("whole", plan))


def test_remains_of_interrupted_writes_are_removed(make, toy, tmp_path):
    plan = toy.small_plan(100, block=2)
    interrupted(toy, tmp_path / "out.zarr", plan)
    chunks = tmp_path / ".out.zarr.unfinished" / "data.zarr" / "Rs" / "c" / "3" / "0"
    chunks.mkdir(parents=True, exist_ok=True)
    (chunks / "0.6f1.partial").write_bytes(b"half")
    assert toy.bytes_of(make("out", plan)) == toy.bytes_of(make("whole", plan))


def emptied(path):
    path.write_bytes(b"")


def flipped(path):
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


@pytest.mark.parametrize(
    "spoils",
    [
        {"data.zarr/Rs/c.0.0.0": emptied},
        {"data.zarr/touch_x/c.0.0": os.unlink},
        {"data.zarr/press/c.0": flipped, "data.zarr/zarr.json": flipped},
        {"finished/0.json": flipped, "data.zarr/Cp/zarr.json": emptied},
    ],
)
def test_damaged_blocks_are_made_again(make, toy, tmp_path, spoils):
    plan = toy.small_plan(60, block=2)
    interrupted(toy, tmp_path / "out.zarr", plan)
    for path, spoil in spoils.items():
        spoil(tmp_path / ".out.zarr.unfinished" / path)
    assert toy.bytes_of(make("out", plan)) == toy.bytes_of(make("whole", plan))


def test_damaged_work_files_are_refused_with_advice(make, toy, tmp_path):
    plan = toy.small_plan(60, block=2)
    interrupted(toy, tmp_path / "out.zarr", plan)
    folder = tmp_path / ".out.zarr.unfinished"
    sound = (folder / "plan.json").read_bytes()
    for content in (b"", b"\xff", b"[1, 2]", sound[:-20]):
        (folder / "plan.json").write_bytes(content)
        with pytest.raises(InputError, match=r"plan\.json: .*; remove the folder \S+ to start"):
            make("out", plan)
    (folder / "plan.json").write_bytes(sound)
    (folder / "model.npz").write_bytes(b"")
    training = replace(toy.training(), load=load)
    with pytest.raises(InputError, match=r"model\.npz: not a reduced model: .*; remove the folder"):
        generate(plan, tmp_path / "out.zarr", training=training)
    (folder / "lock").unlink(missing_ok=True)
    (folder / "lock").mkdir()
    with pytest.raises(InputError, match=r"lock: cannot be used as a lock: .*; remove it"):
        make("out", plan)
    assert (folder / "data.zarr").exists()


def test_a_finished_data_set_with_a_flipped_bit_is_refused(make, toy):
    data = make("out", toy.small_plan(20))
    for name in ("Rs/c.0.0.0", "press/c.0", "drawn_top/c.0.0", "zarr.json", "zarr.json.sha256"):
        whole = (data / name).read_bytes()
        flipped(data / name)
        with pytest.raises(InputError, match=f"^{re.escape(str(data))}: "):
            read(data)
        (data / name).write_bytes(whole)
    flipped(data / "Rs" / "zarr.json")  # gathered in that of the whole
    assert read(data).sizes["sweep"] == 20
