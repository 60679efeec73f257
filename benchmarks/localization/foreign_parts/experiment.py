"""Twins with all their effects are read and localized; what takes time is kept in a folder."""

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
from rcskin.benchmarks.localization.foreign_parts.effects import Effect
from rcskin.benchmarks.localization.foreign_parts.localizers import (
    WAS,
    Way,
    after_touches,
    believed,
    kept_family,
    loaded,
    train_missing,
)
from rcskin.benchmarks.localization.foreign_parts.skin import Foreign, solved
from rcskin.benchmarks.localization.twin_parts.recording import recorded
from rcskin.benchmarks.localization.twin_parts.skin import Twin
from rcskin.benchmarks.localization.twin_parts.training import SEED
from rcskin.benchmarks.localization.twin_parts.trials import Trial
from rcskin.localization.model.localizer_model import Model
from rcskin.simulator.models.reduced.reduced_model import Reduced
from rcskin.simulator.scene.scene_files import scene_text
from rcskin.simulator.sweeps import read, write


@dataclass(frozen=True)
class Experiment:
    """One question about foreign twins.

    table, title: name of the table, and its title with {skins}. trial: its scene is that of the
    localizers, without surroundings. cases: the localizers of each effect. sweeps: number of
    training sweeps. grid: of the three-dimensional solve.
    """

    table: str
    title: str
    trial: Trial
    cases: Sequence[tuple[Effect, Sequence[Way]]]
    sweeps: int
    grid: Grid = Grid()

    def answers(self, folder: Path, skins: int, processes: int) -> pd.DataFrame:
        """A row for each effect, way and skin."""
        folder.mkdir(parents=True, exist_ok=True)
        around = solved(self.trial.believed, folder, self.grid)
        prepared = Prepared(self, folder, around, self._own(folder), self.models(folder))
        work = (delayed(prepared.of_skin)(number) for number in range(skins))
        found = Parallel(n_jobs=processes, return_as="generator")(work)
        return pd.DataFrame([row for rows in found for row in rows])

    def models(self, folder: Path) -> dict[tuple[str, bool], Model]:
        """Localizers by name, and by whether a body is below."""
        wanted = {(way, effect.body) for effect, ways in self.cases for way in ways}
        return {(way.name, body): self._model(folder, way, body) for way, body in wanted}

    def _own(self, folder: Path) -> Reduced:
        """The model without surroundings, which trains and makes the first twins."""
        return kept_family(_kept(folder, False), WAS, self.trial.believed)

    def _model(self, folder: Path, way: Way, body: bool) -> Model:
        known = body and way.training != WAS
        kept = _kept(folder, known)
        scene = believed(self.trial.believed, way.training, known)
        same = {
            each
            for effect, ways in self.cases
            for each in ways
            if each.training == way.training and (effect.body == body or each.training == WAS)
        }
        ordered = sorted(same, key=lambda each: each.name)
        train_missing(scene, way.training, ordered, self.trial.target, self.sweeps, kept)
        return loaded(way, kept)


def _kept(folder: Path, body: bool) -> Path:
    """Folder of the localizers that know of a body, or of those that do not."""
    kept = folder / ("with-body" if body else "without-body")
    kept.mkdir(exist_ok=True)
    return kept


@dataclass(frozen=True)
class Prepared:
    """An experiment with the surroundings by whether a body is below, and the localizers."""

    experiment: Experiment
    folder: Path
    around: Mapping[bool, Solved]
    family: Reduced
    models: Mapping[tuple[str, bool], Model]

    def of_skin(self, number: int) -> list[dict[str, object]]:
        """Rows of one skin in all its effects."""
        return [row for case in self.experiment.cases for row in self._of(*case, number)]

    def _of(self, effect: Effect, ways: Sequence[Way], number: int) -> list[dict[str, object]]:
        sweeps, rows = self._read(effect, number), []
        for way in ways:
            model, unseen = self.models[way.name, effect.body], sweeps
            if way.touches:
                model, unseen = after_touches(model, sweeps, way.touches)
            score, answered = self.experiment.trial.score(model, unseen)
            case = {"effect": effect.name, "way": way.name, "skin": number}
            rows.append(case | {"score": score, "answered": answered})
        return rows

    def _read(self, effect: Effect, number: int) -> xr.Dataset:
        """Sweeps of a twin, kept in the folder."""
        kind = "".join(c if c.isalnum() else "-" for c in effect.name)
        path = self.folder / f"{kind}-{number}.nc"
        if not path.exists():
            trial = self.experiment.trial
            presses = trial.recording(np.random.default_rng([SEED, number]))
            interfaces = [each.name for each in trial.believed.interfaces]
            sweeps = recorded(self._twin(effect, number), presses, interfaces)
            write(sweeps.assign_attrs(scene=scene_text(trial.believed)), path)
        return read(path)

    def _twin(self, effect: Effect, number: int) -> Twin:
        scene, hand = self.experiment.trial.believed, self.experiment.trial.hand
        if not effect.earth:
            return Twin(scene, self.family, SEED, number, hand)
        around = self.around[effect.body]
        return Foreign(scene, self.family, SEED, number, hand, effect=effect, around=around)
