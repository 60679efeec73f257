"""Localizers trained on simulation alone: what they learn from, and what they look at."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import xarray as xr
from rcskin.benchmarks.localization.twin_parts.trials import Trial
from rcskin.localization.inputs.baselines import read_first
from rcskin.localization.model.localizer_model import Model
from rcskin.localization.model.training import train
from rcskin.simulator.dataset.dataset_plan import DatasetPlan
from rcskin.simulator.dataset.generation import generate
from rcskin.simulator.dataset.skin_model import Training
from rcskin.simulator.models.reduced.model_file import load, save
from rcskin.simulator.models.reduced.reduced_model import Reduced
from rcskin.simulator.scene.scene import Scene

SEED = 2026
RTOL = 1e-3
"""Of the simulated sweeps: a third of the meter's noise."""
CHANGE, WHOLE = ("dlnZ", "dphase"), ("dlnZ", "dphase", "lnZ0", "phase0")
"""Quantities that localizers look at: changes against the skin at rest, and its own curve too."""
BY_CHANGE = ("model-based", "ksvm-components", "kernel-ridge")
"""Localizers that do not take the curve, or whose few components have no room for it."""
NETWORK, PLENTY = "network", 20_000
"""A localizer, and simulated sweeps for all the others, which are shown no more."""


def trained(trial: Trial, believed: Reduced) -> dict[str, Model]:
    """The trial's localizers, trained on as many sweeps as it asks for."""
    asked = trial.training if NETWORK in trial.estimators else min(trial.training, PLENTY)
    with on_disk(trial.believed, believed, asked) as sweeps:
        return localized(trial, sweeps)


def simulated(scene: Scene, believed: Reduced, count: int, rtol: float = RTOL) -> xr.Dataset:
    """Sweeps of the scene's data set, by a family that was trained for it before."""
    with on_disk(scene, believed, count, rtol) as sweeps:
        return sweeps.load()


@contextmanager
def on_disk(
    scene: Scene, believed: Reduced, count: int, rtol: float = RTOL
) -> Iterator[xr.Dataset]:
    """The same, read part by part while it is there: networks learn from more than memory holds."""
    training = Training(lambda *_: believed, save, load)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "training.zarr"
        generate(DatasetPlan(scene.parts, count, SEED, rtol), path, training=training)
        yield read_first(path, count, lazy=True)


def localized(trial: Trial, sweeps: xr.Dataset) -> dict[str, Model]:
    """The trial's localizers, trained on sweeps: a network on all of them."""
    plenty = sweeps.isel(sweep=slice(PLENTY))
    return {
        name: train(
            sweeps if name == NETWORK else plenty,
            trial.target,
            name,
            quantities=CHANGE if name in BY_CHANGE else WHOLE,
        )
        for name in trial.estimators
    }
