"""Localizers of foreign twins, trained on the model without and with surroundings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr
from rcskin.benchmarks.localization.foreign_parts.effects import BODY, MAX_FINGER
from rcskin.benchmarks.localization.foreign_parts.skin import THICKNESS
from rcskin.benchmarks.localization.twin_parts.training import CHANGE, SEED, WHOLE
from rcskin.localization.adaptation.class_adaptation import adapt_classes
from rcskin.localization.inputs.baselines import read_first
from rcskin.localization.inputs.samples import Samples
from rcskin.localization.model.localizer_file import load as load_model
from rcskin.localization.model.localizer_file import save as save_model
from rcskin.localization.model.localizer_model import Model
from rcskin.localization.model.training import train
from rcskin.simulator.dataset.dataset_plan import DatasetPlan
from rcskin.simulator.dataset.generation import generate
from rcskin.simulator.dataset.skin_model import Training, reduced
from rcskin.simulator.models.reduced.model_file import load, save
from rcskin.simulator.models.reduced.reduced_model import Reduced
from rcskin.simulator.scene.foam import VACUUM_PERMITTIVITY
from rcskin.simulator.scene.scene import Scene

WAS, TERMS, WIDER = "as it was", "with terms", "drawn wider"
"""Training sweeps: without surroundings; with them; with all distributions wider."""
ALL_FEATURES = (*WHOLE, "lnZ", "phase")
TRAINING_RTOL = 1e-2
"""Certified bound on Rs and Cp of simulated sweeps; most are ten times closer."""
WIDE = 2.0
"""Factor on the spread of the twins' sheets and foam, and on the largest finger."""
SPREADS = {TERMS: (0.2, 0.1), WIDER: (0.5, 0.3)}
"""Spreads of the logarithms of the body's and of the rim's capacitance between skins."""


@dataclass(frozen=True)
class Way:
    """How a localizer is trained.

    name: column of the tables. training: WAS, TERMS or WIDER. estimator, quantities: as of `train`.
    touches: number of touches of each class, on the skin itself, that adapt it.
    """

    name: str
    training: str
    estimator: str = "ksvm-ovo"
    quantities: tuple[str, ...] = CHANGE
    touches: int = 0

    def of(self, folder: Path) -> Path:
        """File of the localizer."""
        return folder / f"localizer-{_file_name(self.name)}.npz"


def believed(scene: Scene, training: str, body: bool) -> Scene:
    """The scene that a localizer is trained on. body: True if there is one below."""
    if training == WAS:
        return scene
    wide, (of_body, of_rim) = (WIDE if training == WIDER else 1.0), SPREADS[training]
    foam, session = scene.skin.foam, scene.dataset.session
    permittivity = foam.unpressed_capacitance_per_area * THICKNESS / VACUUM_PERMITTIVITY
    around: dict[str, object] = {"rim": True, "thickness": True}
    changes: dict[str, object] = {
        "surroundings": around | ({"body": {"distance": BODY}} if body else {}),
        "skin.foam.capacitance_per_area": None,
        "skin.foam.thickness": THICKNESS,
        "skin.foam.relative_permittivity": permittivity,
        "dataset.press.finger": {"low": 0.0, "high": wide * MAX_FINGER},
        "dataset.session.rim": _about_one(of_rim),
    }
    for name in ("sheet_resistance", "sheet_mismatch"):
        changes[f"dataset.session.{name}"] = _about_one(wide * getattr(session, name).spread)
    changes["dataset.session.capacitance.deviation"] = wide * session.capacitance.deviation
    if body:
        changes["dataset.session.body"] = _about_one(of_body)
    return scene.with_(changes)


def _about_one(spread: float) -> dict[str, object]:
    return {"distribution": "lognormal", "median": 1.0, "spread": spread}


def train_missing(
    scene: Scene, training: str, ways: Sequence[Way], target: str, count: int, folder: Path
) -> None:
    """Train the localizers that the folder lacks, all on the same simulated sweeps of a scene."""
    missing = [way for way in ways if not way.of(folder).exists()]
    if not missing:
        return
    sweeps = _simulated(scene, training, count, folder)
    for way in missing:
        model = train(sweeps, target, way.estimator, quantities=way.quantities)
        save_model(way.of(folder), model)


def kept_family(folder: Path, training: str, scene: Scene) -> Reduced:
    """The reduced model of a training scene, trained unless the folder holds it."""
    path = folder / f"family-{_file_name(training)}.npz"
    if not path.exists():
        save(reduced(scene.parts, TRAINING_RTOL), path)
    return load(path)


def after_touches(model: Model, sweeps: xr.Dataset, touches: int) -> tuple[Model, xr.Dataset]:
    """The model adapted by some touches of each class, and the sweeps without these."""
    samples = model.samples(sweeps)
    few = _few_of_each(samples, touches)
    used = np.intersect1d(few.rows, np.flatnonzero(sweeps["press"].values != "none"))
    others = np.setdiff1d(np.arange(sweeps.sizes["sweep"]), used)
    return adapt_classes(model, few).model, sweeps.isel(sweep=others)


def loaded(way: Way, folder: Path) -> Model:
    """A localizer that answers sweeps of any skin."""
    return load_model(way.of(folder)).for_any_skin()


def _simulated(scene: Scene, training: str, count: int, folder: Path) -> xr.Dataset:
    """Training sweeps, kept in the folder with the reduced model."""
    family = kept_family(folder, training, scene)
    path = folder / f"{_file_name(training)}-{count}.zarr"
    plan = DatasetPlan(scene.parts, count, SEED, TRAINING_RTOL)
    generate(plan, path, training=Training(lambda *_: family, save, load))
    return read_first(path, count).load()


def _few_of_each(samples: Samples, count: int) -> Samples:
    each = [np.flatnonzero(samples.y == label)[:count] for label in np.unique(samples.y)]
    return samples.part(np.sort(np.concatenate(each)))


def _file_name(name: str) -> str:
    return name.replace(", ", "-").replace(" ", "-")
