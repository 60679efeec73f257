"""Localizers trained on rcskin's model, asked about skins that it did not make.

Twins are skins of a three-dimensional solve of foam, air, sheets and earth: see
`benchmarks/accuracy/three_dimensions.py`. A meter's low terminal is at earth's potential, fingers
of 0 to 10 pF press, presses have edges, the foam creeps, a body is near. The sheets and the foam
are uneven, presses miss and are of unequal strength, skins drift: all as in `twin.py`. The virtual
meter reads them over TCP. Localizers are trained on the model as it was, without earth; with the
terms of `[surroundings]`; with these, drawn wider than twins need; adapted by two touches of each
class; and with the terms, by the unpressed curve, too: the paper's SVM and `gaussian`. None of this
is measured.

With a folder that is kept a run that was stopped goes on.

Run: python benchmarks/localization/foreign_twin.py [--skins 8] [--found FOLDER] [--quick]
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

from rcskin.benchmarks.bench import Run, launch
from rcskin.benchmarks.localization.foreign_parts.questions import columns
from rcskin.benchmarks.localization.foreign_parts.told import tell

SKINS = 8


def main(run: Run) -> None:
    """Ask all twins, and tell of it."""
    with tempfile.TemporaryDirectory() as scratch:
        folder = run.asked.found or Path(scratch)
        folder.mkdir(parents=True, exist_ok=True)
        question, skins = columns(run.quick), run.asked.skins or run.sized(SKINS, 1)
        tell(question, question.answers(folder, skins, run.asked.processes), run.results)


def options() -> argparse.ArgumentParser:
    """Of the command line."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--skins", type=int)
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("--found", type=Path, help="Folder of what takes time, to be kept.")
    return parser


if __name__ == "__main__":
    launch(main, options())
