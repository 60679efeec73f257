"""A terminal that is closed ends a command, and the meter is as it was found."""

import copy
import os
import select
import signal
import sys
import time
from pathlib import Path

import pytest
from rcskin.hardware.virtual.virtual_device import Fault
from rcskin.simulator.sweeps import read

pty = pytest.importorskip("pty", reason="Windows has no terminals of Unix")
pytestmark = pytest.mark.posix("there is no SIGHUP")
SOON = 30
"""Seconds that the end may take on a very busy machine; alone it takes half a second."""
FOLDER = Path(__file__).parent
OWN_TERMINAL = """
import fcntl, os, signal, sys, termios
os.setsid()
terminal = os.open(sys.argv[1], os.O_RDWR)
fcntl.ioctl(terminal, termios.TIOCSCTTY, 0)
for number in range(3):
    os.dup2(terminal, number)
for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT"):
    ignored = name in sys.argv[2].split(",")
    signal.signal(getattr(signal, name), signal.SIG_IGN if ignored else signal.SIG_DFL)
os.execv(sys.argv[3], sys.argv[3:])
"""
"""Starts a program in a session of its own, with the terminal as its controlling one."""
RECORDING = ["rig.py", "record", "pillow", "--order", "order.txt", "-o", "run.nc"]
LIVE = ["live/live_rig.py", "live", "--model", "m.npz"]
COMMANDS = {
    "recording": [*RECORDING, "--unattended"],
    "prompt for a press": RECORDING,
    "prompt for a reconnection": [*RECORDING, "--switch", "ask", "--interface", "left"],
    "live": [*LIVE, "--log", "run.nc"],
    "live in lines": [*LIVE, "--plain"],
    "live with a page": [*LIVE, "--page"],
    "correction": ["rig.py", "correct", "open"],
}
AWAITED = {
    "prompt for a press": "then Enter",
    "prompt for a reconnection": "then Enter",
    "live": "nothing pressed",
    "live in lines": "nothing pressed",
}
"""What a command shows before its terminal is closed; the others have changed the meter by then."""


class OnTerminal:
    """A command of the rig that runs on a terminal of its own."""

    def __init__(self, process, ours, theirs):
        self.process, self.shown, self.ends = process, "", [ours, theirs]

    def until(self, true):
        """Wait for something, and take what is shown meanwhile."""
        end = time.monotonic() + 2 * SOON
        while not true():
            assert time.monotonic() < end, self.shown
            if select.select(self.ends[:1], [], [], 0.01)[0]:
                self.shown += os.read(self.ends[0], 65536).decode(errors="replace")

    def close(self):
        """Close the terminal."""
        while self.ends:
            os.close(self.ends.pop(0))

    def code(self):
        """Exit code."""
        self.until(lambda: self.process.poll() is not None)
        return self.process.returncode


@pytest.fixture
def instrument(make_instrument, as_found):
    return make_instrument(settings=copy.deepcopy(as_found))


@pytest.fixture
def on_terminal(spawn, ports, tmp_path, monkeypatch):
    """A function that starts one of COMMANDS on a terminal. sweeps: of a recording."""
    monkeypatch.chdir(tmp_path)
    opened = []

    def on_terminal(command, *more, sweeps=5000, ignored="none"):
        (tmp_path / "order.txt").write_text("none\n" * sweeps)
        ours, theirs = pty.openpty()
        script, *words = COMMANDS[command]
        start = [sys.executable, "-c", OWN_TERMINAL, os.ttyname(theirs), ignored]
        rig = [sys.executable, FOLDER / script, *words, "--resource", ports.resource, *more]
        process = spawn(*start, *rig, stdin=None)
        opened.append(OnTerminal(process, ours, theirs))
        return opened[-1]

    yield on_terminal
    for each in opened:
        each.close()


@pytest.fixture
def at_work(on_terminal, instrument, as_found):
    """A function that gives a command on its terminal once it has changed the meter."""

    def at_work(command, *more, **options):
        instrument.pace = 1.0 if command == "correction" else 0.2
        running = on_terminal(command, *more, **options)
        awaited = AWAITED.get(command, "")
        running.until(lambda: instrument.settings != as_found and awaited in running.shown)
        return running

    return at_work


@pytest.mark.parametrize("command", COMMANDS)
def test_a_command_whose_terminal_is_closed_leaves_the_meter_as_found(
    at_work, instrument, as_found, command
):
    running = at_work(command)
    running.close()
    assert running.code() == 128 + signal.SIGHUP
    assert instrument.settings == as_found


@pytest.mark.parametrize(
    ("command", "signals", "code"),
    [
        ("recording", ["SIGHUP", "SIGTERM"], 129),
        ("prompt for a press", ["SIGQUIT"], 131),
        ("prompt for a reconnection", ["SIGINT", None], 130),
        ("live", ["SIGTERM", None, "SIGHUP"], 143),
        ("correction", [None, "SIGTERM", "SIGINT"], 129),
    ],
    ids=str,
)
def test_the_first_of_several_signals_decides(
    at_work, instrument, as_found, command, signals, code
):
    """Such as of a desktop session that ends. None: the terminal is closed."""
    running = at_work(command)
    instrument.faults.add(Fault("late", times=10**6, seconds=0.02))
    for name in signals:
        if name is None:
            running.close()
        else:
            running.process.send_signal(getattr(signal, name))
        time.sleep(0.1)
    assert running.code() == code
    assert instrument.settings == as_found


def test_a_recording_that_ignores_its_terminal_goes_on(at_work, instrument, as_found, tmp_path):
    running = at_work("recording", sweeps=4, ignored="SIGHUP")
    running.close()
    assert running.code() == 0
    assert instrument.settings == as_found and read(tmp_path / "run.nc").sizes["sweep"] == 4


def test_a_live_session_that_ignores_its_terminal_goes_on(at_work, instrument, as_found, tmp_path):
    running = at_work("live", "--sweeps", 3, ignored="SIGHUP")
    running.close()
    assert running.code() == 0
    assert instrument.settings == as_found and read(tmp_path / "run.nc").sizes["sweep"] == 3 + 3


def test_a_prompt_that_nobody_can_answer_ends_the_recording(at_work, instrument, as_found):
    running = at_work("prompt for a press", ignored="SIGHUP")
    running.close()
    assert running.code() == 130
    assert instrument.settings == as_found
