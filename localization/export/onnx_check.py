"""Comparison of an exported graph with the model itself, by onnxruntime."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.sweeps import InputError
from ...simulator.sweeps.reading_quantities import kind_of
from ..inputs.baselines import log_baselines
from ..inputs.features import at_interfaces
from ..model.localizer_model import Model
from .graph_features import OPENING, RECENT
from .portable import PortableModel

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray
    from onnx import ModelProto

SWEEPS, RTOL = 400, 1e-2
"""Number of simulated sweeps of a comparison, and relative error of their readings."""
MAX_DIFFERENCE = 1e-5
"""Largest difference of a graph in double precision from the model."""

Arrays = dict[str, "NDArray[np.float64]"]


@dataclass(frozen=True)
class Difference:
    """Difference of an exported model from the model, over some sweeps.

    sweeps: their number. largest: of the probabilities; of positions and their deviations in mm
    and of strengths, relative to 1. labels: number of sweeps with another label.
    """

    sweeps: int
    largest: float
    labels: int


def simulated_sweeps(model: Model, count: int = SWEEPS) -> xr.Dataset:
    """Sweeps of the model's scene as its meter reads them, at the frequencies of the model.

    Raises InputError if the scene is unknown or has no such interfaces.
    """
    from ...simulator.dataset.dataset_plan import Plan
    from ...simulator.dataset.memory_dataset import in_memory
    from ...simulator.models.mechanics.force_depths import foldable

    scene = model.known_scene
    if tuple(scene.frequencies) != model.frequencies:
        scene = scene.with_({"sweep.frequencies": list(model.frequencies)})
    plan = Plan(foldable(scene, "a comparison", creeps=True), count, 1, RTOL)
    return at_interfaces(in_memory(plan), model.interfaces)


def inputs_of(
    names: list[str], model: Model, sweeps: xr.Dataset, rest: xr.Dataset | None = None
) -> Arrays:
    """Inputs of an exported model for these sweeps, by name; NaN without a baseline.

    Each sweep has its own baseline, as one unpressed sweep. rest: see `Model.usable_features`.
    """
    used = at_interfaces(sweeps, model.interfaces)
    others = None if rest is None else at_interfaces(rest, model.interfaces)
    known = log_baselines(used, others)
    kind = kind_of(used.variables)
    frequency = used["frequency"].values
    found = {}
    for name in names:
        prefix = next((each for each in (RECENT, OPENING) if name.startswith(each)), "")
        if not prefix:
            found[name] = used[name].transpose("sweep", "interface", "frequency").values
            continue
        mean = np.exp(known.recent if prefix == RECENT else known.opening)
        value = np.full((used.sizes["sweep"], 1, *mean.shape[1:]), np.nan)
        value[known.rows, 0] = kind.values(mean, frequency)[name.removeprefix(prefix)]
        found[name] = value
    return found


def difference(
    exported: ModelProto,
    model: Model,
    parts: PortableModel,
    sweeps: xr.Dataset,
    rest: xr.Dataset | None = None,
) -> Difference:
    """Largest differences of a graph from `Model.answers`, over the sweeps with an answer.

    Raises InputError as `Model.answers`, and if no sweep has what the model needs.
    """
    import onnxruntime

    options = onnxruntime.SessionOptions()
    options.log_severity_level = 3
    session = onnxruntime.InferenceSession(
        exported.SerializeToString(), options, providers=["CPUExecutionProvider"]
    )
    real = np.float32 if session.get_inputs()[0].type == "tensor(float)" else np.float64
    names = [each.name for each in session.get_inputs()]
    given = inputs_of(names, model, sweeps, rest)
    rows = model.usable_features(sweeps, rest)[1]
    if not rows.size:
        raise InputError("no sweep has a baseline before it")
    outputs = [each.name for each in session.get_outputs()]
    values = session.run(outputs, {key: each[rows].astype(real) for key, each in given.items()})
    found = dict(zip(outputs, values, strict=True))
    answers = model.answers(sweeps, rest)
    labels = np.array([*parts.labels, "cannot tell"])[found["label"]]
    off = [0.0]
    if "probabilities" in found and parts.gate is None:
        off.append(float(np.abs(found["probabilities"] - answers.chances[rows]).max()))
    if "position" in found:
        places, deviations = model.positions(sweeps, rest)
        off.append(float(np.abs(found["position"] - places[rows]).max()))
        off.append(float(np.abs(found["deviation"] - deviations[rows]).max()))
    wrong = int((labels != answers.labels[rows]).sum())
    return Difference(rows.size, max(off), wrong)
