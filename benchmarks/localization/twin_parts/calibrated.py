"""Localizers of a twin once its skin is calibrated by touches of known place."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from rcskin.benchmarks.localization.twin_parts.training import (
    RTOL,
    localized,
    simulated,
)
from rcskin.benchmarks.localization.twin_parts.trials import Trial
from rcskin.localization.inputs.samples import samples_of
from rcskin.localization.inversion.estimators import estimators
from rcskin.localization.learners.registry import Estimator
from rcskin.localization.model.localizer_model import Model
from rcskin.simulator.calibration.fitting.fit_options import Options
from rcskin.simulator.calibration.run import calibrate
from rcskin.simulator.dataset.skin_model import reduced
from rcskin.simulator.models.reduced.reduced_model import Reduced
from rcskin.simulator.scene.randomisation import Lognormal, Normal
from rcskin.simulator.scene.scene import Scene
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
