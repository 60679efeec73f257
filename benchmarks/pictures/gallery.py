"""The gallery: every picture of results/gallery.md, made by the command that stands beneath it.

Run: python benchmarks/pictures/gallery.py [--quick] [PICTURE ...]
"""

from __future__ import annotations

import argparse
import shlex
from pathlib import Path
from typing import NamedTuple

from rcskin.benchmarks.bench import HERE, Run, launch
from rcskin.simulator.cli import app

SHEET = "sheet-5x5-two-interfaces"


class Picture(NamedTuple):
    """A file, what `rcskin view` is told to make it, and what is to be seen.

    quick: what it is told besides in a quick pass; None where that leaves the picture out.
    """

    file: str
    arguments: str
    caption: str
    quick: str | None = "--rtol 1e-2"


PICTURES = (
    Picture(
        "potential.png",
        f"{SHEET} --press 4,3 --frequency 2e4 --frequency 6e4 --frequency 2e5",
        "At 20 kHz the foam is charged nearly alike everywhere and every pixel counts; at 200 kHz "
        "the potential between the sheets falls towards the far corner. The bottom foils float "
        "and carry charge along their edge.",
    ),
    Picture(
        "current.png",
        f"{SHEET} --press 4,3 --frequency 2e4 --what current",
        "The current at 20 kHz: in at the driven foil; near the corner a part takes the floating "
        "foil and leaves it farther along. The scale leaves out the peak at the foils' ends.",
    ),
    Picture(
        "sensitivity-Rs.png",
        f"{SHEET} --what sensitivity-Rs --frequency 2e3 --frequency 2e4 --frequency 2e5",
        "What a press at each place does to Rs, from one solution: blue places lower it, red ones "
        "raise it, white ones leave it. At 200 kHz far places count for little.",
        None,
    ),
    Picture(
        "sensitivity-Cp.png",
        f"{SHEET} --what sensitivity-Cp --frequency 2e3 --frequency 2e4 --frequency 2e5",
        "The same for Cp: all places count alike at 2 kHz, and far presses lower it at 200 kHz.",
    ),
    Picture(
        "outline.png",
        "l-shape --press 'disc(0.09,0.025,0.012):3' --frequency 5e4 --what current",
        "A skin cut to an L with a hole, fed at one end and from the hole's rim; the sheets carry "
        "different currents, and that of the top crowds at the inner corner.",
    ),
    Picture(
        "mug.png",
        "mug --press 2,4:2mm --frequency 2e4 --what current",
        "A skin around a mug: bending leaves the electrical problem alone.",
    ),
    Picture(
        "deformation.png",
        "mug --press 2,4:2mm --what deformation --flat",
        "A pixel pressed 2 mm into 4 mm of foam, laid flat: the skins' tension spreads the press.",
    ),
    Picture(
        "frequency.gif",
        f"{SHEET} --press 4,3 --what phase",
        "The phase between the sheets from 1 to 200 kHz, with lines of equal phase. From less than "
        "one degree to more than a hundred: each frame has a colour scale of its own.",
        "--rtol 1e-2 --frequency 1e3 --frequency 2e5",
    ),
    Picture(
        "period.gif",
        f"{SHEET} --press 4,3 --frequency 2e5 --what current --animate phase",
        "One period of the current at 200 kHz: it turns first at the foil and later far off.",
        None,
    ),
)


def command(picture: Picture) -> str:
    """What a user types at the root of the repository."""
    return f"rcskin view {picture.arguments} -o {picture.file}"


def make(picture: Picture, output: Path, more: str) -> None:
    """Draw one picture."""
    arguments = [
        str(HERE.parent / each) if each.startswith("benchmarks/") else each
        for each in shlex.split(f"{picture.arguments} {more}")
    ]
    app(["view", *arguments, "-o", str(output)], standalone_mode=False)


def page() -> str:
    """The page with all pictures, captions and commands."""
    parts = [
        f"![{picture.file}](gallery/{picture.file})\n\n{picture.caption}\n\n"
        f"```\n{command(picture)}\n```\n"
        for picture in PICTURES
    ]
    head = (
        "# Gallery\n\nEvery picture is made by the command beneath it, typed at the root of this "
        "repository, and all of them by `.venv/bin/python benchmarks/pictures/gallery.py`. "
        "Potentials, currents and power are those of 1 V at the terminals.\n"
    )
    return "\n".join([head, *parts])


def main(run: Run) -> None:
    """Make the pictures that are named, or all, and the page."""
    folder = run.results / "gallery"
    folder.mkdir(parents=True, exist_ok=True)
    for picture in PICTURES:
        more = run.sized("", picture.quick)
        if more is not None and picture.file in (run.asked.pictures or [picture.file]):
            print(picture.file, flush=True)
            make(picture, folder / picture.file, more)
    (run.results / "gallery.md").write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("pictures", nargs="*", metavar="PICTURE")
    launch(main, parser)
