"""Every command that a page shows, in its order, in a folder of its own, then the slow ones that no
block of the top README shows: how long each takes.

Commands that wait for somebody (the meter, `live`) are left out. Times of the processor do not
change with what else the machine does, those of the clock do.

Run: python benchmarks/commands.py [--quick] [--into FOLDER] [PAGE ...]    README.md by default
"""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pandas as pd
from rcskin.benchmarks.all import Times, timed
from rcskin.benchmarks.bench import HERE, Run, launch, rcskin_command

ROOT = HERE.parent
TITLE = "Run time of every command of the pages"
WAITING = re.compile(r"^rcskin (meter|live)\b|run\.nc|&$")
"""Commands that wait, and those that take what a meter recorded."""
FAILED = "failed with code {}"
README = "README.md"
BESIDES = (
    "rcskin reproduce",
    "rcskin dataset sheet-5x5 --sweeps 150 --workers 1 -o recorded.zarr",
    "rcskin calibrate sheet-5x5 recorded.zarr -o found-there",
    "rcskin design sheet-5x5-two-interfaces --casts 3 --draws 1000 -o designed",
    "rcskin dataset sheet-5x5 --sweeps 6000 -o places.zarr",
    "rcskin train places.zarr --target position -o places.npz",
    "rcskin evaluate places.npz recorded.zarr -o places-found",
)
"""Measured with the top README's: the paper, a calibration of 150 sweeps, a design, positions."""


def shown(page: Path) -> list[str]:
    """The lines of its blocks that call rcskin, without what is said of them."""
    blocks = re.findall(r"^```\n(.*?)^```$", page.read_text(encoding="utf-8"), re.DOTALL | re.M)
    lines = [line for block in blocks for line in block.splitlines()]
    return [re.split(r" {2,}| +#", line)[0] for line in lines if line.startswith("rcskin ")]


def measured(command: str, folder: Path) -> Times:
    """Its times, run in a folder."""
    return timed(rcskin_command(*shlex.split(command)[1:]), folder)


def main(run: Run) -> int:
    """The table; returns 1 where a command fails."""
    rows = []
    for page in run.asked.pages:
        asked = [line for line in shown(ROOT / page) if not WAITING.search(line)]
        with run.kept() as folder:
            besides = BESIDES if page == README else ()
            for command in run.sized([*asked, *besides], asked[:1]):
                times = measured(command, folder)
                told = f"{times.processor:.1f}" if times.code == 0 else FAILED.format(times.code)
                rows.append((page, f"`{command}`", told, f"{times.clock:.1f}"))
                print(rows[-1], flush=True)
    columns = ["page", "command", "processor (s)", "clock (s)"]
    run.publish("commands", TITLE, pd.DataFrame(rows, columns=columns))
    return int(any("failed" in row[2] for row in rows))


if __name__ == "__main__":
    launch(main, {"pages": {"nargs": "*", "default": [README], "metavar": "PAGE"}})
