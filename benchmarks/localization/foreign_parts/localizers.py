"""Localizers of foreign twins, trained on the model as it was and with its surroundings."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr
from rcskin.benchmarks.localization.foreign_parts.effects import BODY, MOST_FINGER
from rcskin.benchmarks.localization.foreign_parts.skin import THICKNESS
from rcskin.benchmarks.localization.twin_parts.training import CHANGE, RTOL, WHOLE, simulated
from rcskin.localization.adaptation.class_adaptation import adapted
from rcskin.localization.inputs.samples import Samples
from rcskin.localization.model.localizer_model import Model
from rcskin.localization.model.model_file import load as load_model
from rcskin.localization.model.model_file import save as save_model
from rcskin.localization.model.training import train
from rcskin.simulator.dataset.skin_model import reduced
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.skin import VACUUM_PERMITTIVITY

WAS, TERMS, WIDER, ADAPTED = "as it was", "with terms", "drawn wider", "adapted"
CURVE = "with terms, by the curve at rest"
WAYS = WAS, TERMS, WIDER, ADAPTED, CURVE
LEARNED = {CURVE: ("gaussian", (*WHOLE, "lnZ", "phase"))}
"""Estimator and features of a way that does not take the paper's SVM by changes alone."""
TOUCHES = 2
"""Of each class, that adapt."""
WIDE = 2.0
"""Times the spread of the twins' sheets and foam, and times the largest finger."""
SPREADS = {TERMS: (0.2, 0.1), CURVE: (0.2, 0.1), WIDER: (0.5, 0.3)}
"""Of the logarithms of the body's and of the rim's capacitance between skins."""
RIM = {False: (0.609, 0.618, 0.618), True: (0.215, 1.247, 0.636)}
"""Mutual capacitance of the sheets along the outline, and that of the top and the bottom one to
earth, over that of vacuum, without the body and with it: from charges of a three-dimensional solve
of the paper's sheet."""


def believed(scene: Scene, way: str, body: bool) -> Scene:
    """The scene that a localizer is trained on. body: whether there is one below."""
    if way == WAS:
        return scene
    wide, (of_body, of_rim) = (WIDE if way == WIDER else 1.0), SPREADS[way]
    foam, session = scene.skin.foam, scene.dataset.session
    permittivity = foam.unpressed_capacitance_per_area * THICKNESS / VACUUM_PERMITTIVITY
    rim = dict(
        zip(
            ("mutual", "top", "bottom"),
            [each * VACUUM_PERMITTIVITY for each in RIM[body]],
            strict=True,
        )
    )
    around: dict[str, object] = {"rim": rim, "thickness": True}
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


def trained(scene: Scene, way: str, target: str, count: int, path: Path) -> Model:
    """A localizer of so many simulated sweeps, kept in a file."""
    if not path.exists():
        estimator, quantities = LEARNED.get(way, ("ksvm-ovo", CHANGE))
        sweeps = simulated(scene, reduced(scene, RTOL), count)
        save_model(path, train(sweeps, target, estimator, quantities=quantities))
    return load_model(path).for_any_skin()


def after_touches(model: Model, sweeps: xr.Dataset) -> tuple[Model, xr.Dataset]:
    """The model adapted by TOUCHES of each class, and the sweeps without these."""
    samples = model.samples(sweeps)
    few = _few_of_each(samples)
    taught = np.intersect1d(few.rows, np.flatnonzero(sweeps["press"].values != "none"))
    rest = np.setdiff1d(np.arange(sweeps.sizes["sweep"]), taught)
    return adapted(model, few).model, sweeps.isel(sweep=rest)


def _few_of_each(samples: Samples) -> Samples:
    each = [np.flatnonzero(samples.y == label)[:TOUCHES] for label in np.unique(samples.y)]
    return samples.part(np.sort(np.concatenate(each)))
