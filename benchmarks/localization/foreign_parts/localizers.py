"""Localizers of foreign twins, trained on the model as it was and with its surroundings."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import xarray as xr
from rcskin.benchmarks.localization.foreign_parts.effects import BODY, MOST_FINGER
from rcskin.benchmarks.localization.foreign_parts.skin import THICKNESS
from rcskin.benchmarks.localization.twin_parts.training import CHANGE, WHOLE, simulated
from rcskin.localization.adaptation.class_adaptation import adapt_classes
from rcskin.localization.inputs.samples import Samples
from rcskin.localization.model.localizer_model import Model
from rcskin.localization.model.model_file import load as load_model
from rcskin.localization.model.model_file import save as save_model
from rcskin.localization.model.training import train
from rcskin.simulator.dataset.skin_model import reduced
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.skin import VACUUM_PERMITTIVITY

WAS, TERMS, WIDER, ADAPTED = "as it was", "with terms", "drawn wider", "adapted"
CURVE, GAUSSIAN, WIDER_GAUSSIAN = "by the curve", "gaussian", "gaussian, drawn wider"
WAYS = WAS, TERMS, WIDER, ADAPTED, CURVE, GAUSSIAN, WIDER_GAUSSIAN
ALL_FEATURES = (*WHOLE, "lnZ", "phase")
LEARNED = {
    CURVE: ("ksvm-ovo", WHOLE),
    GAUSSIAN: ("gaussian", ALL_FEATURES),
    WIDER_GAUSSIAN: ("gaussian", ALL_FEATURES),
}
"""Estimator and features of a way that does not take the paper's SVM by changes alone."""
SCENES = {CURVE: TERMS, GAUSSIAN: TERMS, WIDER_GAUSSIAN: WIDER}
"""Ways that learn from the sweeps of another one."""
TRAINING_RTOL = 1e-2
"""Certified bound on Rs and Cp of simulated sweeps; most are ten times closer."""
TOUCHES = 2
"""Of each class, that adapt."""
WIDE = 2.0
"""Times the spread of the twins' sheets and foam, and times the largest finger."""
SPREADS = {TERMS: (0.2, 0.1), WIDER: (0.5, 0.3)}
"""Of the logarithms of the body's and of the rim's capacitance between skins."""


def believed(scene: Scene, way: str, body: bool) -> Scene:
    """The scene that a localizer is trained on. body: whether there is one below."""
    if way == WAS:
        return scene
    wide, (of_body, of_rim) = (WIDE if way == WIDER else 1.0), SPREADS[way]
    foam, session = scene.skin.foam, scene.dataset.session
    permittivity = foam.unpressed_capacitance_per_area * THICKNESS / VACUUM_PERMITTIVITY
    around: dict[str, object] = {"rim": True, "thickness": True}
    changes: dict[str, object] = {
        "surroundings": around | ({"body": {"distance": BODY}} if body else {}),
        "skin.foam.capacitance_per_area": None,
        "skin.foam.thickness": THICKNESS,
        "skin.foam.relative_permittivity": permittivity,
        "dataset.press.finger": {"low": 0.0, "high": wide * MOST_FINGER},
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


def trained(scene: Scene, ways: Sequence[str], target: str, count: int, folder: Path) -> None:
    """Localizers of some ways that learn from the same simulated sweeps, kept in a folder."""
    missing = [way for way in ways if not file_of(folder, way).exists()]
    if not missing:
        return
    sweeps = simulated(scene, reduced(scene, TRAINING_RTOL), count, TRAINING_RTOL)
    for way in missing:
        estimator, quantities = LEARNED.get(way, ("ksvm-ovo", CHANGE))
        save_model(file_of(folder, way), train(sweeps, target, estimator, quantities=quantities))


def file_of(folder: Path, way: str) -> Path:
    """File of the localizer of a way."""
    return folder / f"{way.replace(', ', '-').replace(' ', '-')}.skops"


def loaded(folder: Path, way: str) -> Model:
    """A localizer that answers sweeps of any skin."""
    return load_model(file_of(folder, way)).insisting()


def after_touches(model: Model, sweeps: xr.Dataset) -> tuple[Model, xr.Dataset]:
    """The model adapted by TOUCHES of each class, and the sweeps without these."""
    samples = model.samples(sweeps)
    few = _few_of_each(samples)
    taught = np.intersect1d(few.rows, np.flatnonzero(sweeps["press"].values != "none"))
    rest = np.setdiff1d(np.arange(sweeps.sizes["sweep"]), taught)
    return adapt_classes(model, few).model, sweeps.isel(sweep=rest)


def _few_of_each(samples: Samples) -> Samples:
    each = [np.flatnonzero(samples.y == label)[:TOUCHES] for label in np.unique(samples.y)]
    return samples.part(np.sort(np.concatenate(each)))
