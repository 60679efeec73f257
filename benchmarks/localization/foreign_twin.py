"""Localizers trained on rcskin's model, tested on skins that it did not make.

A three-dimensional solve of foam, air, sheets and earth makes the twins, see
`benchmarks/accuracy/three_dimensions.py`. The low terminal of the meter is at earth's potential,
fingers have 0 to 10 pF, presses have edges, the foam creeps, a body is near. Sheets and foam are
non-uniform, presses miss and differ in strength, skins drift, all as in `twin.py`. The virtual
meter reads the twins over TCP. Localizers are trained on the model without earth, with the terms of
`[surroundings]`, or with these and wider distributions.

There are three tables: columns of the paper's sheet; pixels of the skin designed for 6x6 pixels;
positions of touches of 24 mm on the skin designed for them. The designs are those of
`twin_design.py`. None of this is a measurement.

With a kept folder, a run that was stopped goes on.

Run: python benchmarks/localization/foreign_twin.py [--only columns|pixels|positions] [--skins 5]
     [--found FOLDER] [--searches FOLDER] [--quick]
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

from rcskin.benchmarks.bench import Run, launch
from rcskin.benchmarks.localization.foreign_parts.experiments import EXPERIMENTS
from rcskin.benchmarks.localization.foreign_parts.report import write_report

SKINS = 5


def main(run: Run) -> None:
    """Make the tables and charts."""
    options = run.asked
    with tempfile.TemporaryDirectory() as scratch:
        folder = options.found or Path(scratch)
        searches = options.searches or folder / "searches"
        skins = options.skins or run.sized(SKINS, 1)
        for name in [options.only] if options.only else EXPERIMENTS:
            experiment = EXPERIMENTS[name](run.quick, searches)
            answers = experiment.answers(folder / name, skins, options.processes)
            write_report(experiment, answers, run.results)


def options() -> argparse.ArgumentParser:
    """Parser of the command line."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--only", choices=EXPERIMENTS, help="One of the three tables.")
    parser.add_argument("--skins", type=int)
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("--found", type=Path, help="Folder in which slow results are kept.")
    parser.add_argument("--searches", type=Path, help="Folder of designs, shared with others.")
    return parser


if __name__ == "__main__":
    launch(main, options())
