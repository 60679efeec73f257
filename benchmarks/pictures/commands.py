"""Pictures of pages that commands draw, drawn by these commands: the paper's sheet, limits, a
study, and the terminal while `live` answers.

Run: python benchmarks/pictures/commands.py [--quick]
"""

from __future__ import annotations

import codecs
import fcntl
import io
import os
import pty
import re
import shutil
import signal
import struct
import subprocess
import termios
from collections.abc import Generator
from pathlib import Path

from rcskin.benchmarks.bench import Run, launch, rcskin_command, served
from rcskin.hardware.control_client import send_request
from rich.console import Console
from rich.text import Text

STUDY = "rcskin study sheet-5x5 -o study.csv"
FEW_POINTS = "rcskin study strip-1x3 --vary skin.sheet_resistance=2e4,5e4 -o study.csv"
DRAWN = {
    "rcskin reproduce -o paper": {"paper/sheet-5x5.png": "sheet-5x5.png"},
    "rcskin limits sheet-5x5-two-interfaces --against-rest 6 -o limits": {
        "limits/frequencies.png": "limits.png"
    },
}
"""Commands as pages show them: files that each leaves, and what pages call them."""
SCENE, PRESS = "sheet-5x5", "2,3"
UNTOUCHED, TOLD = "nothing pressed", "column 3"
MOST_ANSWERS = 200
WIDTH, HEIGHT = 80, 40
"""Of the terminal, characters and lines."""
DRAWN_ANEW = re.compile(r"\r\x1b\[2K(?:\x1b\[1A\x1b\[2K)+")
"""What takes a picture off the terminal before the next one."""


def draw(command: str, files: dict[str, str], folder: Path, results: Path) -> None:
    """Run a command in a folder and keep files of it. Raises where it fails."""
    words = rcskin_command(*command.split()[1:])
    subprocess.run(words, cwd=folder, check=True, stdout=subprocess.DEVNULL)
    for name, kept in files.items():
        shutil.copyfile(folder / name, results / kept)


def trained(folder: Path) -> Path:
    """A model of columns against rest, made as the page on the meter shows it."""
    made = f"dataset {SCENE} --sweeps 2000 -o skin.zarr"
    learned = "train skin.zarr --features dlnZ,dphase -o column.npz"
    for command in (made, learned):
        draw(f"rcskin {command}", {}, folder, folder)
    return folder / "column.npz"


def on_terminal(words: list[str]) -> Generator[str]:
    """What a command writes on a terminal of its own, as it comes; closing this ends the command.

    Reading fails once the command has ended.
    """
    here, there = pty.openpty()
    fcntl.ioctl(there, termios.TIOCSWINSZ, struct.pack("HHHH", HEIGHT, WIDTH, 0, 0))
    colours = {"TERM": "xterm-256color", "COLORTERM": "truecolor"}
    with subprocess.Popen(
        words, env={**os.environ, **colours}, stdin=there, stdout=there, stderr=there
    ) as command:
        os.close(there)
        decoder = codecs.getincrementaldecoder("utf-8")()
        try:
            while True:
                yield decoder.decode(os.read(here, 1 << 16))
        except OSError:
            return
        finally:
            command.send_signal(signal.SIGINT)
            os.close(here)


def terminal(model: Path) -> str:
    """The picture on the terminal of `live` after a press was told as what it is."""
    told, pressed = "", False
    with served(Path(SCENE)) as (resource, control):
        asked = ["--model", model, "--resource", resource, "--sweeps", MOST_ANSWERS]
        written = on_terminal(rcskin_command("live", *asked))
        for part in written:
            told += part
            *_, picture, _ = ["", *DRAWN_ANEW.split(told)]
            if not pressed and UNTOUCHED in picture:
                send_request(control, "press", press=PRESS)
                pressed = True
            if TOLD in picture:
                written.close()
                return picture.replace("\r\n", "\n")
    raise AssertionError(f"`live` did not tell {TOLD}: {told[-2000:]}")


def draw_terminal(picture: str, path: Path) -> None:
    """As SVG, with its colours."""
    console = Console(width=WIDTH, record=True, file=io.StringIO(), color_system="truecolor")
    console.print(Text.from_ansi(picture))
    console.save_svg(str(path), title="rcskin live")


def main(run: Run) -> None:
    """All of them."""
    study = run.sized(STUDY, FEW_POINTS)
    drawn = run.sized(DRAWN, {})
    with run.kept() as folder:
        draw_terminal(terminal(trained(folder)), run.results / "live.svg")
        for command, files in {study: {n: n for n in ("study.csv", "study.png")}, **drawn}.items():
            draw(command, files, folder, run.results)


if __name__ == "__main__":
    launch(main)
