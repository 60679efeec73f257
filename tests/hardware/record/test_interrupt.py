"""Ctrl-C during a recording says how to go on."""

import pytest
import typer
from rcskin.__main__ import _scene_data
from rcskin.hardware.record.command import record_command
from rcskin.simulator.sweeps.errors import InterruptedWorkError
from typer.testing import CliRunner


def test_the_same_command_goes_on(monkeypatch, tmp_path):
    def interrupted(task, operator):
        raise KeyboardInterrupt

    monkeypatch.setattr("rcskin.hardware.record.recorder.record", interrupted)
    app = typer.Typer()
    app.command()(record_command(_scene_data))
    where = ["--resource", "TCPIP0::127.0.0.1::1::SOCKET", "--unattended"]
    pressed = ["--control", "127.0.0.1:1"]
    asked = ["strip-1x3", "-o", str(tmp_path / "run.nc"), *where, *pressed]
    found = CliRunner().invoke(app, asked)
    assert isinstance(found.exception, InterruptedWorkError), found.output
    with pytest.raises(InterruptedWorkError, match="goes on from here"):
        raise found.exception
