"""The twin experiment: localizers trained on simulation alone, asked about skins they do not know.

Every twin is drawn: sheets, foam, leads, contacts away from nominal and uneven, presses offset and
of unequal strength, drift, and for one interface a floating pair of foils at the far edge. It is
read through the virtual meter on TCP by the same driver and recorder as a skin would be, once for
all trials of one name. None of this is a measurement of a skin.

Run: python benchmarks/localization/twin.py [--quick] [--skins N] [--only TRIAL]
     [--localizers NAME,...]
"""

from __future__ import annotations

import argparse
import itertools
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from joblib import Parallel, delayed
from rcskin.benchmarks.bench import Run, launch, publish
from rcskin.benchmarks.localization.twin_parts.calibrated import calibrated
from rcskin.benchmarks.localization.twin_parts.chart import draw
from rcskin.benchmarks.localization.twin_parts.recording import recorded
from rcskin.benchmarks.localization.twin_parts.scenes import built
from rcskin.benchmarks.localization.twin_parts.skin import Twin
from rcskin.benchmarks.localization.twin_parts.training import (
    RTOL,
    SEED,
    trained,
)
from rcskin.benchmarks.localization.twin_parts.trials import TRIALS, Trial, few_trials, quantile
from rcskin.localization.model.localizer_model import Model
from rcskin.simulator.dataset.skin_model import reduced
from rcskin.simulator.models.reduced.reduced_model import Reduced
from rcskin.simulator.scene.scene_files import scene_text

SKINS, CALIBRATED, PROCESSES = 20, 10, 2
"""Twins, those of them that are calibrated too, and processes."""


@dataclass(frozen=True)
class Prepared:
    """Trials of one name with the twins' family of skins, that which the localizers believe in, and
    the localizers of each."""

    trials: tuple[Trial, ...]
    family: Reduced
    believed: Reduced
    models: tuple[dict[str, Model], ...]


def prepared(trials: tuple[Trial, ...]) -> Prepared:
    """Everything that is the same for all skins."""
    scene = trials[0].believed
    family, believed = reduced(built(scene).parts, RTOL), reduced(scene.parts, RTOL)
    models = tuple(trained(trial, believed) for trial in trials)
    return Prepared(trials, family, believed, models)


def scores(ready: Prepared, number: int) -> list[dict[str, Any]]:
    """Of one twin: a row for each localizer, and again after calibration where it is asked."""
    first, rows = ready.trials[0], []
    twin = Twin(built(first.believed), ready.family, SEED, number, first.hand)
    presses = first.recording(np.random.default_rng([SEED, number]))
    sweeps = recorded(twin, presses, [each.name for each in first.believed.interfaces])
    sweeps.attrs["scene"] = scene_text(first.believed)
    for trial, models in zip(ready.trials, ready.models, strict=True):
        for name, model in models.items():
            rows.append(_row(trial, number, name, model, sweeps))
        if trial.touches and number < CALIBRATED:
            again, asked = calibrated(trial, models, ready.believed, sweeps)
            for name, model in again.items():
                rows.append(_row(trial, number, name, model, asked, trial.touches))
    return rows


def _row(
    trial: Trial, number: int, name: str, model: Model, sweeps: xr.Dataset, calibrated: int = 0
) -> dict[str, Any]:
    found, answered = trial.score(model, sweeps)
    return {
        "trial": trial.name,
        "localizer": name,
        "calibrated with": calibrated,
        "skin": number,
        "score": found,
        "answered": answered,
        "unit": trial.unit,
        "goal": trial.goal,
    }


def summary(table: pd.DataFrame) -> pd.DataFrame:
    """One row for each trial, localizer and calibration: the distribution over skins."""
    rows = []
    by = ["trial", "localizer", "calibrated with", "unit", "goal"]
    for (trial, localizer, touches, unit, goal), group in table.groupby(by, sort=False):
        found = group["score"].to_numpy()
        distance, median = unit == "mm", quantile(found, 0.5)
        reached = median <= goal if distance else median >= goal
        rows.append(
            {
                "trial": trial,
                "localizer": localizer,
                "touches of calibration": touches,
                "skins": len(found),
                "worst": found.max() if distance else found.min(),
                "10 %": quantile(found, 0.1),
                "median": median,
                "90 %": quantile(found, 0.9),
                "answered": quantile(group["answered"].to_numpy(), 0.5),
                "unit": unit,
                "goal": goal,
                "reached": "yes" if reached else "no",
            }
        )
    return pd.DataFrame(rows).round(3).astype(object).fillna("-")


def experiment(trials: tuple[Trial, ...], skins: int, processes: int) -> pd.DataFrame:
    """A row for each answer of each localizer on each skin, in trials of one name."""
    ready = prepared(trials)
    work = (delayed(scores)(ready, number) for number in range(skins))
    answers = Parallel(n_jobs=processes, return_as="generator")(work)
    return pd.DataFrame([row for found in answers for row in found])


def main(run: Run) -> None:
    """Ask every trial and tell of it as soon as it is answered."""
    asked, skins = run.asked, run.asked.skins or run.sized(SKINS, 1)
    answers = run.results / "twin_skins.csv"
    trials = [limited(each, asked.localizers) for each in run.sized(TRIALS, few_trials())]
    trials = [t for t in trials if t.estimators and (not asked.only or asked.only in t.name)]
    for _, alike in itertools.groupby(trials, key=lambda trial: trial.name):
        table = experiment(tuple(alike), skins, asked.processes)
        told(with_others(table, answers), run.results)


def options() -> argparse.ArgumentParser:
    """Of the command line."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--skins", type=int)
    parser.add_argument("--only", help="Trials whose name holds this; the others stay as they are.")
    parser.add_argument("--localizers", help="Only these of each trial, NAME,NAME.")
    parser.add_argument("--processes", type=int, default=PROCESSES)
    return parser


def limited(trial: Trial, names: str | None) -> Trial:
    """The trial with those of its localizers that are named; with all for None."""
    if names is None:
        return trial
    return replace(trial, estimators=tuple(n for n in trial.estimators if n in names.split(",")))


def told(table: pd.DataFrame, folder: Path) -> None:
    """Write all answers, their distributions, and the picture."""
    title = "Twin experiment: localizers trained on simulation alone"
    publish(folder, "twin", title, summary(table))
    table.to_csv(folder / "twin_skins.csv", index=False, lineterminator="\n")
    draw(table, folder / "twin.png")


def with_others(table: pd.DataFrame, answers: Path) -> pd.DataFrame:
    """With the answers of localizers that were asked before and not now, in the order of TRIALS."""
    known = pd.read_csv(answers) if answers.exists() else table.head(0)
    by = ["trial", "localizer", "calibrated with"]
    asked = pd.MultiIndex.from_frame(table[by])
    whole = pd.concat([table, known[~pd.MultiIndex.from_frame(known[by]).isin(asked)]])
    order = {
        (trial.name, name): (place, number)
        for place, trial in enumerate(TRIALS)
        for number, name in enumerate(trial.estimators)
    }
    keys = [(*order[t, n], c, s) for t, n, c, s in whole[[*by, "skin"]].itertuples(index=False)]
    whole.index = pd.MultiIndex.from_tuples(keys)
    return whole.sort_index()


if __name__ == "__main__":
    launch(main, options())
