"""Standard output or standard error that is closed, full or without a reader."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.posix("shells there close no stream, and there is no /dev/full")
if not Path("/dev/full").exists():
    pytest.skip("this system has no /dev/full", allow_module_level=True)

COMMANDS = {
    "version": ["--version"],
    "help": ["--help"],
    "help of a command": ["help", "sweep"],
    "scenes": ["scenes"],
    "a scene": ["scenes", "sheet-3x3"],
    "keys": ["keys"],
    "description": ["describe", "sheet-3x3"],
    "sweep": ["sweep", "sheet-3x3", "--press", "none", "-o", "out.csv"],
    "identify": ["meter", "identify", "TCPIP0::127.0.0.1::1::SOCKET"],
}
REFUSED = ["sweep", "absent.toml", "-o", "out.csv"]
FULL, CLOSED = "rcskin: standard output: cannot be written: the disk is full", "it is closed"


@pytest.fixture
def run_with(tmp_path):
    """A function that runs a command with redirections of a shell; gives code, output, errors."""

    def run_with(words, redirections, unbuffered=False, program=("-m", "rcskin"), before=""):
        environment = {**os.environ, "PYTHONUNBUFFERED": "1" if unbuffered else ""}
        command = f'{before}"$0" "$@" {redirections}'
        done = subprocess.run(
            ["sh", "-c", command, sys.executable, *program, *words],
            capture_output=True,
            text=True,
            cwd=tmp_path,
            env=environment,
        )
        assert "Traceback" not in done.stderr and "Exception ignored" not in done.stderr
        return done.returncode, done.stdout, done.stderr

    return run_with


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize(
    ("redirection", "reason"), [(">/dev/full", FULL), (">&-", CLOSED)], ids=["full", "closed"]
)
def test_output_that_is_lost_is_one_line_and_a_code(run_with, command, redirection, reason):
    code, _, errors = run_with(COMMANDS[command], redirection, unbuffered=command == "help")
    assert code == 1
    assert reason in errors.splitlines()[-1]


@pytest.mark.parametrize("command", ["keys", "sweep", "version"])
@pytest.mark.parametrize("redirections", [">/dev/full 2>&1", ">&- 2>&-", "<&- >&- 2>&-"])
def test_where_no_line_can_be_written_the_code_remains(run_with, command, redirections):
    assert run_with(COMMANDS[command], redirections) == (1, "", "")


@pytest.mark.parametrize("redirections", ["2>&-", "2>/dev/full", ">/dev/full 2>&1", "2>&- >&-"])
def test_a_refusal_has_its_code_without_any_stream(run_with, redirections):
    assert run_with(REFUSED, redirections) == (2, "", "")


def test_without_standard_error_the_work_is_done(run_with, tmp_path):
    code, output, _ = run_with(COMMANDS["sweep"], "2>&-")
    assert code == 0 and output.endswith("-> out.csv\n")
    assert (tmp_path / "out.csv").read_text().startswith("#")


NOTING = """
import typer
from rcskin.simulator.command_line import run
from rcskin.simulator.requests.console import note

app = typer.Typer()

@app.command()
def noting() -> None:
    note("a note")
    print("done")

run(app)
"""


@pytest.mark.parametrize(
    ("redirection", "end"),
    [("2>/dev/full", (1, "done\n")), ("2>&-", (0, "done\n")), (">/dev/null 2>/dev/full", (1, ""))],
)
def test_a_note_that_is_lost_on_a_full_device_is_in_the_code(run_with, redirection, end):
    assert run_with([], redirection, program=("-c", NOTING)) == (*end, "")


@pytest.mark.parametrize("command", ["help", "keys", "sweep", "identify"])
def test_where_the_reader_of_a_pipe_ended_there_is_no_line(run_with, command, tmp_path):
    """Its code is 1; the shell's is that of `true`."""
    reading = "; echo $? > code; } 2> errors | true"
    program = ["-c", "import time; time.sleep(0.5); from rcskin.__main__ import main; main()"]
    run_with(COMMANDS[command], reading, program=program, before="{ ")
    assert (tmp_path / "code").read_text() == "1\n"
    assert (tmp_path / "errors").read_text() == ""
