"""Which spread of the simulated skins should a localizer learn from, and how many skins?

Columns of 5x5, by the paper's SVM. All spreads of the twin experiment's skins are multiplied by a
factor, and so many skins drawn; the twins asked about keep theirs, or have twice as much. They are
like those of `twin.py`, read by the scene's error model. None of this is a measurement.

Run: python benchmarks/localization/training_spread.py [--quick]
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr
from rcskin.benchmarks.bench import Run, launch
from rcskin.benchmarks.localization.twin_meters import read_at_once
from rcskin.benchmarks.localization.twins import (
    CHANGE,
    RTOL,
    SEED,
    SKINS,
    SWEEPS_PER_SESSION,
    TRIALS,
    WHOLE,
    Twin,
    built,
    simulated,
)
from rcskin.localization.inputs.samples import samples_of
from rcskin.localization.inversion.estimators import chosen
from rcskin.simulator.chart_style import COLOURS, LINE_STYLES, chart
from rcskin.simulator.dataset.skin_model import reduced
from rcskin.simulator.scene.randomisation import MAX_UNEVENNESS, Lognormal, Normal
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import scene_text
from rcskin.simulator.sweeps import concatenate

TRIAL = TRIALS[2]
SPREADS, FEW_SPREADS = (0.125, 0.25, 0.5, 1.0, 2.0, 4.0), (0.5, 1.0)
NUMBERS, FEW_NUMBERS = (10, 30, 100, 330), (4, 10)
TWINS, TWIN_SPREADS = 40, (1.0, 2.0)
FEATURES = {"changes": CHANGE, "changes and the unpressed curve": WHOLE}


def spread_by(scene: Scene, factor: float) -> Scene:
    """The scene, whose skins vary by so many times as much as in the twin experiment."""
    resistance, capacitance = SKINS.sheet_resistance, SKINS.capacitance
    session = SKINS.model_copy(
        update={
            "sheet_resistance": Lognormal(median=1.0, spread=factor * resistance.spread),
            "sheet_mismatch": Lognormal(median=1.0, spread=factor * SKINS.sheet_mismatch.spread),
            "capacitance": Normal(mean=1.0, deviation=factor * capacitance.deviation),
            "unevenness": min(factor * SKINS.unevenness, MAX_UNEVENNESS),
            "foam_spread": min(factor * SKINS.foam_spread, MAX_UNEVENNESS),
        }
    )
    drawn = scene.dataset.model_copy(update={"session": session})
    return scene.model_copy(update={"dataset": drawn})


def twins(spread: float, count: int) -> xr.Dataset:
    """Recordings of so many, each a session of its own."""
    scene = spread_by(built(TRIAL.believed), spread)
    family = reduced(scene.parts, RTOL)
    found = [
        read_at_once(
            Twin(scene, family, SEED, number, TRIAL.hand),
            TRIAL.recording(np.random.default_rng([SEED, number])),
            number,
        )
        for number in range(count)
    ]
    return concatenate(found).assign_attrs(scene=scene_text(TRIAL.believed))


def scores(asked: Mapping[float, xr.Dataset], spread: float, numbers: Sequence[int]) -> list[dict]:
    """Of localizers that learned from skins of that spread: a row for each twin."""
    scene = spread_by(TRIAL.believed, spread)
    sweeps = simulated(scene, reduced(scene.parts, RTOL), max(numbers) * SWEEPS_PER_SESSION)
    rows = []
    for features, quantities in FEATURES.items():
        known = samples_of(sweeps, TRIAL.target, quantities)
        tests = {each: samples_of(of, TRIAL.target, quantities) for each, of in asked.items()}
        for number in numbers:
            some = known.first_sessions(number)
            model = chosen("ksvm-ovo", TRIAL.target).fit(some.problem, some.X, some.y)
            for own, test in tests.items():
                right = model.predict(test.X) == test.y
                rows += [
                    {
                        "features": features,
                        "spread of training": spread,
                        "skins": number,
                        "spread of twins": own,
                        "twin": twin,
                        "right": right[(test.sessions == twin) & (test.y != 0)].mean(),
                    }
                    for twin in np.unique(test.sessions)
                ]
            print(features, spread, number, flush=True)
    return rows


def summary(table: pd.DataFrame) -> pd.DataFrame:
    """Mean over the twins and its standard error, and the worst of them, in per cent."""
    by = ["features", "spread of twins", "skins", "spread of training"]
    found = table.groupby(by, sort=False)["right"].agg(["mean", "sem", "min"])
    return (100 * found.fillna(0.0)).round(1).reset_index()


def tell(table: pd.DataFrame, count: int, run: Run) -> None:
    """A row for each number of skins, a column for each spread of training; and the curves."""
    cells = [f"{m} ± {s} ({low:.0f})" for m, s, low in table[["mean", "sem", "min"]].to_numpy()]
    by = ["features", "spread of twins", "skins"]
    wide = table.assign(cell=cells).pivot(index=by, columns="spread of training", values="cell")
    title = f"Columns of {count} simulated skins found, %, by the spread of training (worst skin)"
    run.publish("training_spread", title, wide.rename(columns=str).reset_index())
    draw(table, run.results / "training_spread.png")


def draw(table: pd.DataFrame, path: Path) -> None:
    """A panel for each kind of features and twins, a curve for each number of skins."""
    panels = list(itertools.product(FEATURES, TWIN_SPREADS))
    with chart(path, 8.5, 6.2) as figure:
        grid = figure.subplots(2, 2, sharex=True, sharey=True).ravel()
        for axes, (features, own) in zip(grid, panels, strict=True):
            of = table[(table["features"] == features) & (table["spread of twins"] == own)]
            for k, (number, each) in enumerate(of.groupby("skins")):
                axes.errorbar(
                    each["spread of training"],
                    each["mean"],
                    each["sem"],
                    color=COLOURS[k],
                    linestyle=LINE_STYLES[k],
                    marker=".",
                    capsize=2,
                    label=f"{number} skins",
                )
            axes.axvline(own, color="0.6", linewidth=0.8)
            axes.set_xscale("log", base=2)
            axes.xaxis.set_major_formatter("{x:g}")
            axes.set_title(f"{features[0].upper()}{features[1:]}; twins of spread {own:g}")
        grid[0].set_ylabel("Columns right (%)")
        grid[2].set_ylabel("Columns right (%)")
        for axes in grid[2:]:
            axes.set_xlabel("Spread of the skins in training")
        figure.legend(*grid[0].get_legend_handles_labels(), loc="outside lower center", ncols=4)


def main(run: Run) -> None:
    """Ask the same twins of every localizer, and publish."""
    count = run.sized(TWINS, 1)
    asked = {spread: twins(spread, count) for spread in TWIN_SPREADS}
    numbers = run.sized(NUMBERS, FEW_NUMBERS)
    rows = [
        row for spread in run.sized(SPREADS, FEW_SPREADS) for row in scores(asked, spread, numbers)
    ]
    tell(summary(pd.DataFrame(rows)), count, run)


if __name__ == "__main__":
    launch(main)
