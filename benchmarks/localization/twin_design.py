"""Is the bound of a designed skin reached? Pixels, columns, positions and pairs, on twins.

`rcskin design` finds sheets, readings and frequencies, `rcskin dataset` simulates sweeps of skins
like it, `rcskin train` makes localizers of them: all as a user does. Twins, cast as
[dataset.session] spreads them, are read over TCP by the virtual meter, and pressed by a hand that
misses a little. Beside that, the same twins are read at once, with and without their drift: what
stands between the bound of a known skin and what is reached. The bound is of the design as it is
meant, and of each twin's own skin as it is.

With a folder that is kept a run that was stopped goes on. A search of `design_goals.py` in the same
folder of searches is not made again.

Run: python benchmarks/localization/twin_design.py [--target pixel|column|position|pair]
     [--second] [--skins 20] [--localizers NAME,...] [--training SWEEPS] [--found FOLDER]
     [--searches FOLDER] [--quick]
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pandas as pd
from joblib import Parallel, delayed
from rcskin.benchmarks.bench import Run, launch, publish
from rcskin.benchmarks.localization.design_parts.asking import scores, spread, summary
from rcskin.benchmarks.localization.design_parts.goals import FIRST, GOALS, SHOWN, TCP, Goal
from rcskin.benchmarks.localization.design_parts.kept import Kept
from rcskin.benchmarks.localization.design_parts.known import nominal, of_twin, whole
from rcskin.benchmarks.localization.twin_parts.trials import Trial
from rcskin.simulator.models.reduced.reduced_model import Reduced

SKINS = 20
COLUMNS = ["who", "skins", "10 %", "median", "90 %", "mean", "answered"]


def asked_goal(run: Run) -> Goal:
    """As the command line asks."""
    goal = GOALS["pixel in a second" if run.asked.second else run.asked.target]
    return goal.quick() if run.quick else goal


def kept_in(run: Run, folder: Path, goal: Goal) -> Kept:
    """What is kept of a goal, with searches where they are asked for."""
    return Kept(folder, goal, run.asked.searches or folder / "searches")


def asked_of(kept: Kept) -> Trial:
    """What twins of the design are asked."""
    return replace(kept.goal.trial, believed=kept.designed())


def answers_of(
    kept: Kept, trial: Trial, family: Reduced, models: dict[str, Path], number: int
) -> list[dict]:
    """Rows of one twin, of every localizer; all of them that are yet to be asked read it once."""
    names = {name: f"twin-{number}-{name}" for name in models}
    asked = {name: path for name, path in models.items() if not kept.has(names[name])}
    ways = [way for way in kept.goal.ways if way != TCP or number < FIRST]
    found = scores(trial, family, asked, number, ways) if asked else []
    rows = []
    for name, kept_as in names.items():
        own = [row for row in found if row["localizer"] == name]
        rows += kept.once(kept_as, lambda own=own: own)
    return rows


def own_bound(kept: Kept, trial: Trial, family: Reduced, number: int) -> float:
    """What could be told of one twin at most."""
    return kept.once(f"known-{number}", lambda: of_twin(kept.goal, trial, family, number))


def told(run: Run, folder: Path) -> None:
    """Search, train, ask the twins, and write the table."""
    folder.mkdir(parents=True, exist_ok=True)
    kept, skins = kept_in(run, folder, asked_goal(run)), run.asked.skins or run.sized(SKINS, 1)
    goal, trial = kept.goal, asked_of(kept)
    names = run.asked.localizers.split(",") if run.asked.localizers else trial.estimators
    sweeps = run.asked.training or goal.training
    models = {name: kept.model(name, sweeps) for name in names}
    family, workers = kept.family(trial.believed), Parallel(n_jobs=run.asked.processes)
    about = [(kept, trial, family, number) for number in range(skins)]
    answers = workers(delayed(answers_of)(*each[:3], models, each[3]) for each in about)
    found = pd.DataFrame([row for rows in answers for row in rows])
    bounds = [whole(kept), nominal(kept, trial)]
    if goal.known is not None:
        own = pd.Series(workers(delayed(own_bound)(*each) for each in about[:FIRST]))
        way = "each known, without drift"
        bounds.append({"who": "bound"} | spread(own, way, trial.placed))
    rows = sorted(summary(found, trial.placed), key=lambda row: _place(row, goal))
    table = pd.DataFrame([*bounds, *rows], columns=COLUMNS).astype(object).fillna("-")
    pixels = trial.believed.pixels
    title = goal.what.format(f"{pixels.rows}x{pixels.columns}")
    publish(run.results, goal.table, title, table)


def _place(row: dict[str, object], goal: Goal) -> int:
    """By way of reading; localizers stay in their order."""
    return next(k for k, way in enumerate(goal.ways) if str(row["skins"]).endswith(f"twins, {way}"))


def in_its_folder(run: Run, tell: Callable[[Run, Path], None]) -> None:
    """Do what takes time in a folder that is asked for, or in one that is not kept."""
    with tempfile.TemporaryDirectory() as scratch:
        tell(run, run.asked.found or Path(scratch))


def main(run: Run) -> None:
    """All of it."""
    in_its_folder(run, told)


def shared_options() -> argparse.ArgumentParser:
    """Of the command line, of all that ask twins of a design."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--skins", type=int)
    parser.add_argument("--training", type=int, help="Simulated sweeps of the data set.")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--found", type=Path, help="Folder of what takes time, to be kept.")
    parser.add_argument("--searches", type=Path, help="Folder of designs, shared with others.")
    return parser


def options() -> argparse.ArgumentParser:
    """Of the command line."""
    parser = shared_options()
    targets = [name for name in GOALS if " " not in name]
    parser.add_argument("--target", choices=targets, default="pixel")
    parser.add_argument("--localizers", help=f"Of {', '.join(SHOWN)}, joined by commas.")
    parser.add_argument("--second", action="store_true", help="A sweep may take a second.")
    return parser


if __name__ == "__main__":
    launch(main, options())
