"""What a designed skin reaches on a hundred twins more: `twin_design.py` asks twenty, over TCP.

A median of twenty twins is known to 2 or 3 points only. Here one localizer, trained as there, is
asked about other twins, read at once, with and without drift.

Run: python benchmarks/localization/twin_design_others.py [--skins 100] [--localizer NAME]
     [--training SWEEPS] [--found FOLDER] [--searches FOLDER] [--quick]
"""

from __future__ import annotations

import argparse
from pathlib import Path

import pandas as pd
from joblib import Parallel, delayed
from rcskin.benchmarks.bench import Run, launch, publish
from rcskin.benchmarks.localization.design_parts.asking import scores, summary
from rcskin.benchmarks.localization.design_parts.goals import GOALS
from rcskin.benchmarks.localization.twin_design import (
    asked_of,
    in_its_folder,
    kept_in,
    shared_options,
)

OTHERS, SKINS = 1000, 100
"""Number of the first of them, and how many."""
READ = "at once, without drift", "at once"


def told(run: Run, folder: Path) -> None:
    """Search and train where that is still to be done, ask the twins, and write the table."""
    folder.mkdir(parents=True, exist_ok=True)
    goal, asked = run.sized(GOALS["pixel"], GOALS["pixel"].quick()), run.asked
    kept = kept_in(run, folder, goal)
    trial = asked_of(kept)
    model = kept.model(asked.localizer, asked.training or goal.training)
    family = kept.family(trial.believed)
    numbers = range(OTHERS, OTHERS + (asked.skins or run.sized(SKINS, 1)))
    models = {asked.localizer: model}
    work = (delayed(scores)(trial, family, models, number, READ) for number in numbers)
    answers = Parallel(n_jobs=asked.processes)(work)
    found = pd.DataFrame([row for rows in answers for row in rows])
    pixels = trial.believed.pixels
    title = f"Pixels of {pixels.rows}x{pixels.columns} found (%), as designed, other twins"
    publish(run.results, "twin_design_others", title, pd.DataFrame(summary(found)))


def main(run: Run) -> None:
    """All of it."""
    in_its_folder(run, told)


def options() -> argparse.ArgumentParser:
    """Of the command line."""
    parser = shared_options()
    parser.add_argument("--localizer", default="gaussian")
    return parser


if __name__ == "__main__":
    launch(main, options())
