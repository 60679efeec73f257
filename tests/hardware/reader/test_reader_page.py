"""The page on readers: its files describe its lines, and its commands run."""

import re
import shlex
import sys
from pathlib import Path

import numpy as np
import pytest
from rcskin.__main__ import app
from rcskin.hardware.reader.line_format import read_line_format
from rcskin.hardware.reader.sweep_assembly import SweepAssembly
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import read
from typer.testing import CliRunner

PAGE = (Path(__file__).parents[3] / "docs" / "how-to" / "use-a-reader.md").read_text("utf-8")
FILES = re.findall(r"```toml\n(.*?)```", PAGE, flags=re.DOTALL)
COMMANDS = [
    re.split(r" {2,}", line)[0] for line in PAGE.splitlines() if line.startswith("rcskin meter ")
]


@pytest.fixture
def files(tmp_path, monkeypatch):
    """The two files of the page."""
    monkeypatch.chdir(tmp_path)
    for name, text in zip(("reader.toml", "knit.toml"), FILES, strict=True):
        Path(name).write_text(text)


def test_the_firmware_sends_what_the_second_file_describes(files):
    """The lines of one loop, printed as the sketch prints them: count, f, a, b."""
    scene = load_scene("knit-36")
    line_format = read_line_format(Path("knit.toml"))
    assert line_format.kind is scene.parts.setup.kind
    frequencies = dict.fromkeys(("left", "right"), scene.frequencies)
    assembly = SweepAssembly(line_format, frequencies, lambda kind, text: None)
    lines = [f"{k},{2000 + 250 * k:.2f},{1000 + k},{3000 - k}" for k in range(96)]
    found = [assembly.feed(line) for line in [*lines, "96,2000.00,1000,3000"]]
    assert found[:96] == [None] * 96
    for name, bits in (("left", 1000 + np.arange(96)), ("right", 3000 - np.arange(96))):
        np.testing.assert_allclose(found[96][name], bits * 0.8e-3 / 3.3, rtol=1e-12)


def test_the_commands_run_with_a_virtual_reader(files, spawn):
    serve, record, *faults = map(shlex.split, COMMANDS)
    free = ["--port", "0", "--control-port", "0"]
    process = spawn(sys.executable, "-m", "rcskin", *serve[1:], *free)
    resource, _, control = process.stdout.readline().split()
    where = {"tcp:127.0.0.1:3500": resource, "127.0.0.1:3501": control}
    for fault in faults:
        result = CliRunner().invoke(app, [*fault[1:], "--control", control])
        assert result.exit_code == 0, result.output
    Path("order.txt").write_text("none\n2,3\n")  # instead of all pixels
    words = [*(where.get(word, word) for word in record[1:]), "--order", "order.txt"]
    result = CliRunner().invoke(app, words)
    assert result.exit_code == 0, result.output
    assert read("run.nc").sizes["sweep"] == 2 and "0 with remarks" in result.output
    assert "the device restarted: it sent 'READY'" in result.output
