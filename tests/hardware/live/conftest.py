"""`rcskin live` at a virtual meter: as a process of its own, or within this one."""

import runpy
import subprocess
import sys
from pathlib import Path

import pytest
import typer
from typer.testing import CliRunner

RIG = Path(__file__).with_name("live_rig.py")
_rig = runpy.run_path(str(RIG))


@pytest.fixture
def instrument(make_instrument, cushion):
    return make_instrument(cushion)


@pytest.fixture
def cushion():
    return _rig["Cushion"]()


@pytest.fixture
def start(ports):
    """A function that starts the command at the virtual meter, killed at the end if need be."""
    started = []

    def start(*arguments, resource=ports.resource, **pipes):
        words = [sys.executable, RIG, "live", "--model", "m.skops", "--resource", resource]
        pipes = pipes or {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
        words = [*map(str, [*words, *arguments])]
        started.append(subprocess.Popen(words, text=True, **pipes))
        return started[-1]

    yield start
    for process in started:
        process.kill()
        process.wait()


@pytest.fixture
def live(ports):
    """A function that runs the command in this process; gives the typer result."""
    app = typer.Typer()
    app.command("live")(_rig["command"])

    def live(*arguments):
        words = ["--resource", ports.resource, "--model", "m.skops"]
        return CliRunner().invoke(app, [*words, *map(str, arguments)])

    return live


@pytest.fixture
def gather(command):
    """A function that has a log written whose session was cut off; gives the typer result."""
    return lambda log: command("gather", log)
