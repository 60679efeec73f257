"""The twin experiment: localizers trained on simulation alone, asked about skins they do not know.

Every twin is drawn: sheets, foam, leads, contacts away from nominal and uneven, presses offset and
of unequal strength, drift, and for one interface a floating pair of foils at the far edge. It is
read through the virtual meter on TCP by the same driver and recorder as a skin would be, once for
all trials of one name. None of this is a measurement of a skin.

Run: python benchmarks/localization/twin.py [--quick] [--skins N] [--only TRIAL]
     [--localizers NAME,...]
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from joblib import Parallel, delayed
from matplotlib.axes import Axes
from numpy.typing import NDArray
from rcskin.benchmarks.bench import PROCESSES_OPTION, SKINS_OPTION, Run, launch
from rcskin.benchmarks.localization.twin_meters import recorded
from rcskin.benchmarks.localization.twins import (
    RTOL,
    SEED,
    TRIALS,
    Trial,
    Twin,
    built,
    few_trials,
    localized,
    quantile,
    simulated,
    trained,
)
from rcskin.localization.inputs.samples import samples_of
from rcskin.localization.inversion.estimators import estimators
from rcskin.localization.learners.registry import Estimator
from rcskin.localization.model.localizer_model import Model
from rcskin.simulator.calibration.command import Options
from rcskin.simulator.calibration.run import calibrate
from rcskin.simulator.chart_style import COLOURS, chart
from rcskin.simulator.dataset.skin_model import reduced
from rcskin.simulator.models.reduced.reduced_model import Reduced
from rcskin.simulator.scene.randomisation import Lognormal, Normal
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import scene_text
from rcskin.simulator.sweeps import ToleranceError

CALIBRATED_TO, TRAINING = 0.03, 4000
"""Spread of training around a calibrated skin, and simulated sweeps of it."""


def calibrated(
    trial: Trial, models: dict[str, Model], believed: Reduced, sweeps: xr.Dataset
) -> tuple[dict[str, Model], xr.Dataset]:
    """The localizers anew, and the sweeps that they are asked about: those that calibrate are not
    asked about again."""
    known = _known(trial, sweeps)
    rest = np.flatnonzero(sweeps["press"].values == "none")
    found = calibrate(trial.believed, sweeps.isel(sweep=np.union1d(rest, known)), Options())
    examples = _examples(_narrowed(trial.believed, found.values), believed)
    named = estimators()
    taught = tuple(name for name in models if named[name].uses_sweeps)
    again = localized(replace(trial, estimators=taught), examples)
    moved = {
        name: _moved(model, examples, named[name])
        for name, model in models.items()
        if name not in again
    }
    asked = sweeps.isel(sweep=np.setdiff1d(np.arange(sweeps.sizes["sweep"]), known))
    return {name: (again | moved)[name] for name in models}, asked


def _known(trial: Trial, sweeps: xr.Dataset) -> NDArray[np.int64]:
    """Numbers of the touches that calibrate."""
    touched = np.flatnonzero(sweeps["press"].values != "none")
    return touched[:: touched.size // trial.touches][: trial.touches]


def _moved(model: Model, examples: xr.Dataset, made: Estimator) -> Model:
    """A model that no sweep teaches, about the skin of the examples.

    Its sharpness stays, on which no answer depends that is scored here: to judge it anew takes
    tables of a dozen skins.
    """
    samples = samples_of(examples, model.target, model.problem.quantities)
    predictor = made.fit(samples.problem, samples.X, samples.y)
    learned = replace(model.learned, predictor=predictor)
    return replace(model, learned=learned, problem=samples.problem)


def _examples(around: Scene, believed: Reduced) -> xr.Dataset:
    """Sweeps of skins around a calibrated one, by a family of their own where they leave ours."""
    try:
        return simulated(around, believed, TRAINING)
    except ToleranceError:
        return simulated(around, reduced(around.parts, RTOL), TRAINING)


def _narrowed(scene: Scene, values: dict[str, float]) -> Scene:
    """Training around a skin of which the parameters are known, more or less."""
    R, c = (math.exp(values[name]) for name in ("sheet_resistance", "capacitance"))
    session = scene.dataset.session.model_copy(
        update={
            "sheet_resistance": Lognormal(median=R, spread=CALIBRATED_TO),
            "capacitance": Normal(mean=c, deviation=CALIBRATED_TO * c),
        }
    )
    return scene.model_copy(
        update={"dataset": scene.dataset.model_copy(update={"session": session})}
    )


SPREAD = 0.18
LEGEND = (
    "dot: a twin, green: calibrated; bar: median; dashed: goal. "
    "Columns by one interface, the others by two"
)


def draw(table: pd.DataFrame, path: Path) -> None:
    """table: a row for each answer, as `twin.scores` gives them."""
    shares, distances = table[table["unit"] == "right"], table[table["unit"] == "mm"]
    with chart(path, 13, 5.6) as figure:
        ratio = [max(1, _groups(shares)), max(1, _groups(distances))]
        left, right = figure.subplots(1, 2, width_ratios=ratio)
        _panel(left, shares.assign(score=100 * shares["score"], goal=100 * shares["goal"]))
        _panel(right, distances)
        left.set_ylabel("Right answers (%)")
        left.set_title(LEGEND, loc="left", size=8)
        right.set_ylabel("Median distance (mm)")
        right.set_ylim(bottom=0)
        figure.suptitle("Trained on simulation, evaluated on other simulated skins", size=11)


def _groups(table: pd.DataFrame) -> int:
    return len(table.groupby(["trial", "localizer", "calibrated with"]))


def _panel(axes: Axes, table: pd.DataFrame) -> None:
    names, random = [], np.random.default_rng(0)
    for place, (name, group) in enumerate(
        table.groupby(["trial", "localizer", "calibrated with"], sort=False)
    ):
        trial, localizer, touches = name
        color = COLOURS[0] if touches == 0 else COLOURS[2]
        scatter = place + random.uniform(-SPREAD, SPREAD, len(group))
        axes.plot(scatter, group["score"], "o", ms=4, alpha=0.6, color=color, mew=0)
        axes.hlines(group["score"].median(), place - 0.3, place + 0.3, color="black", lw=2)
        axes.hlines(group["goal"].iloc[0], place - 0.4, place + 0.4, color=COLOURS[1], ls="--")
        calibrated = f", {touches} touches" if touches else ""
        of = trial.replace(", two interfaces", "")
        names.append(f"{of}\n{localizer}{calibrated}")
    axes.set_xticks(range(len(names)), names, rotation=90, ma="right", fontsize=8)
    axes.set_axisbelow(True)


SKINS, CALIBRATED = 20, 10
"""Twins, and those of them that are calibrated too."""


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
        told(with_others(table, answers), run)


def limited(trial: Trial, names: str | None) -> Trial:
    """The trial with those of its localizers that are named; with all for None."""
    if names is None:
        return trial
    return replace(trial, estimators=tuple(n for n in trial.estimators if n in names.split(",")))


def told(table: pd.DataFrame, run: Run) -> None:
    """Write all answers, their distributions, and the picture."""
    title = "Twin experiment: localizers trained on simulation alone"
    run.publish("twin", title, summary(table))
    table.to_csv(run.results / "twin_skins.csv", index=False, lineterminator="\n")
    draw(table, run.results / "twin.png")


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
    launch(
        main,
        SKINS_OPTION
        | PROCESSES_OPTION
        | {
            "--only": {"help": "Trials whose name holds this; the others stay as they are."},
            "--localizers": {"help": "Only these of each trial, NAME,NAME."},
        },
    )
