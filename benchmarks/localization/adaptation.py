"""What a few touches of a skin teach: models before and after `rcskin adapt`, on another mounting.

Each twin is mounted twice. The touches are of the first mounting, the questions of the second: of
other leads and session errors, foam and sheets moved by 2 %. Twins are like those of `twin.py`,
read by the scene's error model. None of this is a measurement.

Run: python benchmarks/localization/adaptation.py [--quick]
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import pandas as pd
import xarray as xr
from rcskin.benchmarks.bench import Run, launch
from rcskin.benchmarks.localization.training_spread import spread_by
from rcskin.benchmarks.localization.twin_meters import read_at_once
from rcskin.benchmarks.localization.twins import (
    CHANGE,
    RTOL,
    SEED,
    TRIALS,
    WHOLE,
    Trial,
    Twin,
    built,
    every_pixel,
    few_of_each,
    simulated,
)
from rcskin.localization.adaptation import checked_classifier, fine_tuned
from rcskin.localization.evaluation.evaluation import score
from rcskin.localization.model.localizer_model import Model
from rcskin.localization.model.training import train
from rcskin.simulator.dataset.skin_model import reduced
from rcskin.simulator.measure.skins import DrawnSkin, drawn_skin
from rcskin.simulator.models.reduced.reduced_model import Reduced
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import scene_text
from rcskin.simulator.sweeps import concatenate

MOUNTED = 103
"""Kind of random numbers, beside those of `twins`."""
MOVED = 0.02
"""Standard deviation of what foam and sheets change by from one mounting to the next."""
TOUCHES, FEW_TOUCHES = (2, 5, 10), (2,)
"""Of each class."""
TWINS, TRAINING, FEW_TRAINING = 20, 6000, 900
NARROW = 0.33
"""Of the spread of the twins: about that of scenes which say nothing of it."""


@dataclass(frozen=True)
class Case:
    """What is trained how, on skins of that spread over the twins'."""

    trial: Trial
    estimator: str
    quantities: tuple[str, ...]
    spread: float
    twins: int = TWINS


PIXELS = replace(TRIALS[3], order=every_pixel(10))
CASES = (
    Case(TRIALS[2], "ksvm-ovo", CHANGE, NARROW),
    Case(TRIALS[2], "ksvm-ovo", ("Rs", "Cp"), NARROW),
    Case(TRIALS[2], "ksvm-ovo", WHOLE, 1.0),
    Case(TRIALS[2], "model-based", CHANGE, NARROW),
    Case(TRIALS[2], "model-based", CHANGE, 1.0),
    Case(PIXELS, "model-based", CHANGE, 1.0, 10),
)


@dataclass(frozen=True)
class Mounted(Twin):
    """A twin at one of its mountings."""

    mounting: int = 0

    @cached_property
    def drawn(self) -> DrawnSkin:
        """The same skin each time, but for what a mounting changes."""
        grid, modes = self.family.grid, self.family.modes
        own = drawn_skin(self.scene.parts, self.seed, self.number, grid, modes).variation
        new = drawn_skin(self.scene.parts, self.seed + 1 + self.mounting, self.number, grid, modes)
        c, R = np.exp(MOVED * self._random(MOUNTED).standard_normal(2))
        moved = replace(
            own, top=own.top / R, bottom=own.bottom / R, capacitance=own.capacitance * c
        )
        return DrawnSkin(moved, new.leads)

    def _random(self, *purpose: int) -> np.random.Generator:
        return np.random.default_rng([self.seed, self.number, self.mounting, *purpose])


def recorded(trial: Trial, family: Reduced, number: int) -> xr.Dataset:
    """Two sessions of a twin."""
    parts = [
        read_at_once(
            Mounted(family_scene(trial), family, SEED, number, trial.hand, mounting=each),
            trial.recording(np.random.default_rng([SEED, number, each])),
            each,
        )
        for each in range(2)
    ]
    return concatenate(parts).assign_attrs(scene=scene_text(trial.believed))


def family_scene(trial: Trial) -> Scene:
    """The twins' own."""
    return built(trial.believed)


def rows(case: Case, model: Model, sweeps: xr.Dataset, touches: tuple[int, ...]) -> list[dict]:
    """Right of one twin's second mounting, by how many touches of each class of its first."""
    samples = model.samples(sweeps)
    known, asked = (samples.part(np.flatnonzero(samples.sessions == k)) for k in range(2))
    pressed = ~np.isin(asked.y.astype(str), ("0", "0,0"))
    asked = asked.part(np.flatnonzero(pressed))
    found = {"before": score(model.learned, asked)}
    for count in touches:
        few = few_of_each(known, count)
        better = fine_tuned(model, checked_classifier(model, few), few)
        found[f"{count} of each"] = score(better, asked)
    return [
        {
            "question": case.trial.name,
            "localizer": case.estimator,
            "features": ",".join(case.quantities),
            "spread of training": case.spread,
            "touches": name,
            "right": 100 * each.right.mean(),
        }
        for name, each in found.items()
    ]


def main(run: Run) -> None:
    """All cases, mean and worst over twins."""
    table = []
    for case in run.sized(CASES, CASES[:1]):
        scene = spread_by(case.trial.believed, case.spread)
        sweeps = simulated(scene, reduced(scene.parts, RTOL), run.sized(TRAINING, FEW_TRAINING))
        target = case.trial.target
        model = train(sweeps, target, case.estimator, quantities=case.quantities).for_any_skin()
        family = reduced(family_scene(case.trial).parts, RTOL)
        for number in range(run.sized(case.twins, 1)):
            sweeps = recorded(case.trial, family, number)
            table += rows(case, model, sweeps, run.sized(TOUCHES, FEW_TOUCHES))
        print(case.trial.name, case.estimator, case.quantities, case.spread, flush=True)
    by = ["question", "localizer", "features", "spread of training"]
    found = pd.DataFrame(table).groupby([*by, "touches"], sort=False)["right"].agg(["mean", "min"])
    cells = [f"{mean:.1f} ({least:.0f})" for mean, least in found.to_numpy()]
    wide = found.assign(cell=cells)["cell"].unstack("touches")
    order = list(dict.fromkeys(row["touches"] for row in table))
    title = "Accuracy on another mounting (%) by touches that adapted; mean of skins (worst)"
    run.publish("adaptation", title, wide[order].reset_index())


if __name__ == "__main__":
    launch(main)
