"""One signal ends a command: within a library that does not hear of it, and with its workers."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from rcskin.simulator import processes

pty = pytest.importorskip("pty", reason="Windows has no terminals of Unix")
DEAF = """
import hashlib, sys
from pathlib import Path
from rcskin.simulator.cleanup import temporary_folder
from rcskin.simulator.interrupt import end_on_signals
from rcskin.simulator.sweeps import whole_file

with end_on_signals(), temporary_folder() as folder, whole_file(Path(sys.argv[1])) as unfinished:
    unfinished.write_text("half")
    (folder / "half").touch()
    print("at work", flush=True)
    hashlib.pbkdf2_hmac("sha256", b"", b"", 10**9)
"""
DEAF_WITH_WORKERS = """
import hashlib, time
from rcskin.simulator.interrupt import end_on_signals
from rcskin.simulator.processes import map_in_order, worker_pool

if __name__ == "__main__":
    with end_on_signals(), worker_pool(2, [], "") as pool:
        next(map_in_order(pool, time.sleep, [0, 1000, 1000]))
        print("at work", flush=True)
        hashlib.pbkdf2_hmac("sha256", b"", b"", 10**9)
"""
SLOW_TO_UNWIND = """
import sys, time
from pathlib import Path
from rcskin.simulator.interrupt import end_on_signals
from rcskin.simulator.sweeps import whole_file

with end_on_signals(), whole_file(Path(sys.argv[1])) as unfinished:
    unfinished.write_text("half")
    print("at work", flush=True)
    try:
        time.sleep(1000)
    finally:
        time.sleep(1000)
"""
WAITED_FOR = """
import sys, time
from rcskin.simulator.interrupt import end_on_signals
from rcskin.simulator.cleanup import cleanup_block

with end_on_signals(), cleanup_block():
    print("at work", flush=True)
    try:
        time.sleep(1000)
    finally:
        time.sleep(3)
        print("in order", flush=True)
"""
STUDY = ("study", "strip-1x3", "--vary", "skin.sheet_resistance=1e4:1e5:1000", "--workers", "2")


@pytest.fixture
def start():
    """A function that starts Python in a group of its own, which is killed at the end."""
    started = []

    def start(*arguments, stderr=subprocess.PIPE):
        process = subprocess.Popen(
            [sys.executable, *map(str, arguments)],
            stdout=subprocess.PIPE,
            stderr=stderr,
            text=True,
            start_new_session=True,
        )
        started.append(process)
        return process

    yield start
    for process in started:
        try:
            os.killpg(process.pid, signal.SIGKILL)
        except ProcessLookupError:
            continue
        process.communicate()


def members(group):
    """How many processes are at work in a group."""
    return sum(_works_in(group, int(name)) for name in os.listdir("/proc") if name.isdigit())


def all_end(group, within=10.0):
    """Whether every process of a group ends; its files may be closed a moment before."""
    last = time.monotonic() + within
    while members(group) and time.monotonic() < last:
        time.sleep(0.02)
    return not members(group)


def _works_in(group, process):
    try:
        state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
        return os.getpgid(process) == group and state != "Z"
    except (ProcessLookupError, FileNotFoundError):
        return False


@pytest.mark.parametrize(
    ("work", "number"),
    [
        (DEAF, signal.SIGINT),
        (DEAF, signal.SIGHUP),
        (DEAF_WITH_WORKERS, signal.SIGTERM),
        (SLOW_TO_UNWIND, signal.SIGTERM),
    ],
    ids=["deaf", "deaf to a closed terminal", "deaf with workers", "slow to unwind"],
)
def test_work_that_goes_on_is_ended_and_leaves_nothing_unfinished(
    start, tmp_path, monkeypatch, work, number
):
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    process = start("-c", work, tmp_path / "out.csv")
    assert process.stdout.readline() == "at work\n"
    time.sleep(0.5)
    process.send_signal(number)
    _, err = process.communicate(timeout=30)
    assert (process.returncode, err) == (128 + number, "rcskin: interrupted\n")
    assert not [*tmp_path.iterdir()]


def test_what_must_be_put_in_order_is_waited_for(start):
    process = start("-c", WAITED_FOR)
    assert process.stdout.readline() == "at work\n"
    time.sleep(0.5)
    os.killpg(process.pid, signal.SIGINT)
    out, err = process.communicate(timeout=30)
    assert out == "in order\n" and "KeyboardInterrupt" in err


def test_a_terminal_has_its_cursor_back_even_so(start, tmp_path):
    ours, theirs = pty.openpty()
    process = start("-c", DEAF, tmp_path / "out.csv", stderr=theirs)
    assert process.stdout.readline() == "at work\n"
    time.sleep(0.5)
    os.killpg(process.pid, signal.SIGINT)
    process.communicate(timeout=30)
    assert os.read(ours, 1000).startswith(b"\x1b[?25h")
    os.close(ours)
    os.close(theirs)


@pytest.mark.slow
@pytest.mark.parametrize("to_all", [True, False], ids=["Ctrl-C", "told to end"])
def test_workers_of_a_study_end_with_it(start, tmp_path, to_all):
    process = start("-m", "rcskin", *STUDY, "-o", tmp_path / "study.csv")
    while process.poll() is None and members(process.pid) < 4:
        time.sleep(0.05)
    time.sleep(1)
    if to_all:
        os.killpg(process.pid, signal.SIGINT)
    else:
        process.terminate()
    _, err = process.communicate(timeout=30)
    assert process.returncode == (130 if to_all else 143)
    note, last = err.splitlines()
    assert note.startswith("rcskin: note: ") and last == "rcskin: interrupted"
    assert all_end(process.pid)
    assert not [*tmp_path.iterdir()]


WRITING = """
import sys, time
from pathlib import Path
from rcskin.simulator.interrupt import end_on_signals
from rcskin.simulator.processes import map_in_order, worker_pool
from rcskin.simulator.sweeps import whole_file

def write_half(path):
    with whole_file(Path(path)) as unfinished:
        unfinished.write_text("half")
        time.sleep(1000)

if __name__ == "__main__":
    with end_on_signals(), worker_pool(2, [], "") as pool:
        list(map_in_order(pool, write_half, sys.argv[1:]))
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_workers_leave_nothing_unfinished(start, tmp_path, number):
    script, folder = tmp_path / "writing.py", tmp_path / "written"
    script.write_text(WRITING)
    folder.mkdir()
    process = start(script, folder / "a.csv", folder / "b.csv")
    while process.poll() is None and sum(each.stat().st_size for each in folder.iterdir()) < 8:
        time.sleep(0.02)
    process.send_signal(number)
    process.communicate(timeout=30)
    assert process.returncode and all_end(process.pid)
    assert not [*folder.iterdir()]


HIRED = """
import time
from rcskin.simulator.interrupt import end_on_signals
from rcskin.simulator.processes import worker_pool

if __name__ == "__main__":
    with end_on_signals(), worker_pool(2, ["imported_for_long"], ""):
        time.sleep(20)
"""


@pytest.mark.skipif(processes.sys.platform == "darwin", reason="no process is forked there")
@pytest.mark.parametrize("to_all", [True, False], ids=["Ctrl-C", "told to end"])
def test_what_workers_are_copies_of_ends_while_it_still_imports(
    start, tmp_path, monkeypatch, to_all
):
    """Without a word of its own, whether all are told to end or this process alone."""
    begun = tmp_path / "begun"
    slow = f"import pathlib, time\npathlib.Path({str(begun)!r}).touch()\ntime.sleep(30)\n"
    (tmp_path / "imported_for_long.py").write_text(slow)
    (tmp_path / "worker_pool.py").write_text(HIRED)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path), prepend=os.pathsep)
    process = start(tmp_path / "worker_pool.py")
    while process.poll() is None and not begun.exists():
        time.sleep(0.02)
    (os.killpg if to_all else os.kill)(process.pid, signal.SIGINT)
    _, err = process.communicate(timeout=10)
    assert err.count("Traceback") == 1 and "forkserver" not in err
    assert all_end(process.pid)
