"""One Ctrl-C ends a command: within a library that does not hear of it, and with its workers."""

import os
import pty
import signal
import subprocess
import sys
import time

import pytest

DEAF = """
import hashlib, sys
from pathlib import Path
from rcskin.simulator.interrupt import ending_soon
from rcskin.simulator.sweeps import whole_file

with ending_soon(), whole_file(Path(sys.argv[1])) as unfinished:
    unfinished.write_text("half")
    print("at work", flush=True)
    hashlib.pbkdf2_hmac("sha256", b"", b"", 10**9)
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
    """How many processes are in a group."""
    return sum(_group_of(int(name)) == group for name in os.listdir("/proc") if name.isdigit())


def _group_of(process):
    try:
        return os.getpgid(process)
    except ProcessLookupError:
        return None


def test_work_in_c_is_ended_and_leaves_nothing_unfinished(start, tmp_path):
    process = start("-c", DEAF, tmp_path / "out.csv")
    assert process.stdout.readline() == "at work\n"
    time.sleep(0.5)
    os.killpg(process.pid, signal.SIGINT)
    _, err = process.communicate(timeout=30)
    assert (process.returncode, err) == (130, "rcskin: interrupted\n")
    assert not [*tmp_path.iterdir()]


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
def test_workers_of_a_study_end_with_it(start, tmp_path):
    process = start("-m", "rcskin", *STUDY, "-o", tmp_path / "study.csv")
    while process.poll() is None and members(process.pid) < 4:
        time.sleep(0.05)
    time.sleep(1)
    os.killpg(process.pid, signal.SIGINT)
    _, err = process.communicate(timeout=30)
    assert process.returncode == 130 and err.splitlines()[-1] == "rcskin: interrupted"
    assert not [*tmp_path.iterdir()]
