"""Columns of the paper's sheet, asked of foreign twins in all their effects."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr
from joblib import Parallel, delayed
from rcskin.benchmarks.accuracy.three_dimensions_parts.lines import Grid
from rcskin.benchmarks.accuracy.three_dimensions_parts.solved import Solved
from rcskin.benchmarks.localization.foreign_parts.effects import EFFECTS, OWN, WITH_BODY, Effect
from rcskin.benchmarks.localization.foreign_parts.localizers import (
    ADAPTED,
    SCENES,
    TERMS,
    WAS,
    WAYS,
    after_touches,
    believed,
    loaded,
    trained,
)
from rcskin.benchmarks.localization.foreign_parts.skin import Foreign, solved
from rcskin.benchmarks.localization.twin_parts import scenes
from rcskin.benchmarks.localization.twin_parts.recording import recorded
from rcskin.benchmarks.localization.twin_parts.skin import Twin
from rcskin.benchmarks.localization.twin_parts.training import RTOL, SEED
from rcskin.benchmarks.localization.twin_parts.trials import ONE, SINGLE, Trial, every_pixel
from rcskin.localization.model.localizer_model import Model
from rcskin.simulator.dataset.skin_model import reduced
from rcskin.simulator.models.reduced.model_file import load, save
from rcskin.simulator.models.reduced.reduced_model import Reduced
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import scene_text
from rcskin.simulator.sweeps import read, write

GOAL = 0.97
PIXELS, FEW_PIXELS = 5, 2
SWEEPS, FEW_SWEEPS = 6000, 600
"""Simulated, that each localizer learns from."""


@dataclass(frozen=True)
class Question:
    """trial: its scene is what is believed of the skin but for its surroundings. ways: of WAYS.

    sweeps: that localizers learn from. grid: of the three-dimensional solve.
    """

    trial: Trial
    effects: Sequence[Effect]
    ways: Sequence[str]
    sweeps: int
    grid: Grid

    def answers(self, folder: Path, skins: int, processes: int) -> pd.DataFrame:
        """A row for each effect, way and skin; what takes time is kept in a folder."""
        around = solved(self.trial.believed, folder, self.grid)
        bodies = {effect.body for effect in self.effects}
        models = {
            (way, there): self.model(folder, way, there)
            for there in bodies
            for way in self.ways
            if way != ADAPTED
        }
        ready = Ready(self, folder, around, self.family(folder), models)
        work = (delayed(ready.of_skin)(number) for number in range(skins))
        found = Parallel(n_jobs=processes, return_as="generator")(work)
        return pd.DataFrame([row for rows in found for row in rows])

    def model(self, folder: Path, way: str, body: bool) -> Model:
        """A localizer. body: True if it knows of one below."""
        body = body and way != WAS
        source = SCENES.get(way, way)
        alike = [each for each in self.ways if each != ADAPTED and SCENES.get(each, each) == source]
        kept = folder / ("with-body" if body else "without-body")
        kept.mkdir(exist_ok=True)
        scene = believed(self.trial.believed, source, body)
        trained(scene, alike, self.trial.target, self.sweeps, kept)
        return loaded(kept, way)

    def family(self, folder: Path) -> Reduced:
        """Of twins that the model makes."""
        path = folder / "own.npz"
        if not path.exists():
            save(reduced(own_scene(self.trial.believed), RTOL), path)
        return load(path)


def own_scene(scene: Scene) -> Scene:
    """The twins' own in which presses may lie anywhere, without foils that nobody knows of."""
    return scenes.built(scene).model_copy(update={"contacts": scene.contacts})


@dataclass(frozen=True)
class Ready:
    """All that the twins of a question need; models by way, and by whether a body is below."""

    question: Question
    folder: Path
    around: Mapping[bool, Solved]
    family: Reduced
    models: Mapping[tuple[str, bool], Model]

    def of_skin(self, number: int) -> list[dict[str, object]]:
        """Rows of one skin, in all its effects."""
        return [row for effect in self.question.effects for row in self.of(effect, number)]

    def of(self, effect: Effect, number: int) -> list[dict[str, object]]:
        """Rows of one skin in one of its effects."""
        trial, rows, sweeps = self.question.trial, [], self._read(effect, number)
        for way in self.question.ways:
            model, asked = self.models[TERMS if way == ADAPTED else way, effect.body], sweeps
            if way == ADAPTED:
                model, asked = after_touches(model, sweeps)
            score, answered = trial.score(model, asked)
            told = {"effect": effect.name, "way": way, "skin": number}
            rows.append(told | {"score": score, "answered": answered})
        return rows

    def _read(self, effect: Effect, number: int) -> xr.Dataset:
        """Sweeps of a twin, kept in the folder."""
        trial, kind = self.question.trial, "".join(c if c.isalnum() else "-" for c in effect.name)
        path = self.folder / f"{kind}-{number}.nc"
        if not path.exists():
            presses = trial.recording(np.random.default_rng([SEED, number]))
            interfaces = [each.name for each in trial.believed.interfaces]
            sweeps = recorded(self._twin(effect, number), presses, interfaces)
            write(sweeps.assign_attrs(scene=scene_text(trial.believed)), path)
        return read(path)

    def _twin(self, effect: Effect, number: int) -> Twin:
        trial = self.question.trial
        if not effect.earth:
            return Twin(own_scene(trial.believed), self.family, SEED, number, trial.hand)
        scene, around = trial.believed, self.around[effect.body]
        return Foreign(scene, self.family, SEED, number, trial.hand, effect=effect, around=around)


def columns(quick: bool) -> Question:
    """Of the paper's sheet, by the paper's localizer."""
    pixels = FEW_PIXELS if quick else PIXELS
    scene = scenes.believed(ONE, pixels, SINGLE)
    order = every_pixel(3 if quick else 1)
    trial = Trial("column", scene, "column", order, ("ksvm-ovo",), GOAL, training=SWEEPS)
    if quick:
        coarse = Grid(finest=0.5, order=2, far=5.0)
        return Question(trial, (OWN, WITH_BODY), WAYS[:2], FEW_SWEEPS, coarse)
    return Question(trial, EFFECTS, WAYS, SWEEPS, Grid())
