"""Comparison of an exported graph with the model itself, by onnxruntime."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.sweeps import InputError
from ...simulator.sweeps.reading_quantities import kind_of
from ..inputs.baselines import log_baselines
from ..inputs.features import at_interfaces
from ..model.localizer_model import Model
from ..trust.answers import CANNOT_TELL
from .graph_parts import OPENING_SWEEPS, RECENT
from .portable import PortableModel

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray
    from onnx import ModelProto

    from ...simulator.arrays import Real

SWEEPS, RTOL = 400, 1e-2
"""Number of simulated sweeps of a comparison, and relative error of their readings."""
MAX_PROBABILITY, MAX_POSITION = 1e-4, 1e-3
"""Largest differences by rounding: of probabilities, and of positions in mm.

Networks compute in single precision. All others agree to 1e-9 in double.
"""

Arrays = dict[str, "Real"]


@dataclass(frozen=True)
class Difference:
    """Largest differences of an exported model from the model, over some sweeps.

    sweeps: their number. labels: number of sweeps with another label. probability: of a class.
    position: of x, y and their standard deviations, mm, and of the strength; relative above 1.
    """

    sweeps: int
    labels: int
    probability: float = 0.0
    position: float = 0.0

    @property
    def rounding_alone(self) -> bool:
        """True if double precision explains the differences."""
        within = self.probability <= MAX_PROBABILITY and self.position <= MAX_POSITION
        return within and not self.labels

    def __str__(self) -> str:
        parts = [f"{self.labels} of {self.sweeps} labels differ"]
        if self.probability:
            parts.append(f"probabilities by up to {self.probability:.1e}")
        if self.position:
            parts.append(f"positions by up to {self.position:.1e} mm")
        return ", ".join(parts)


def simulated_sweeps(model: Model, count: int = SWEEPS) -> xr.Dataset:
    """Sweeps of the model's scene as its meter reads them, at the frequencies of the model.

    Raises InputError if the scene is unknown or has no such interfaces.
    """
    from ...simulator.dataset.dataset_plan import DatasetPlan
    from ...simulator.dataset.memory_dataset import in_memory
    from ...simulator.models.mechanics.force_depths import pressed_by_factors

    parts = model.known_scene.parts
    if tuple(parts.setup.frequency) != model.frequencies:
        parts = parts.read(parts.setup.at(np.array(model.frequencies)))
    plan = DatasetPlan(pressed_by_factors(parts), count, 1, RTOL)
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
        prefix = next((each for each in (RECENT, OPENING_SWEEPS) if name.startswith(each)), "")
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
    """Largest differences of a graph from the model, over the sweeps that have a baseline.

    The model is taken without its knowledge of faults, which no graph has. Raises InputError as
    `Model.answers`, and if no sweep has what the model needs.
    """
    rows = model.usable_features(sweeps, rest)[1]
    if not rows.size:
        raise InputError(f"{model.source}: no sweep has a baseline sweep before it")
    found = outputs_of(exported, model, sweeps, rest, rows)
    answers = replace(model, diagnosis=None).answers(sweeps, rest)
    labels = np.array([*parts.labels, CANNOT_TELL])[found["label"]]
    wrong = int((labels != answers.labels[rows]).sum())
    if model.target != "position":
        off = np.abs(found["probabilities"] - answers.chances[rows]).max()
        return Difference(rows.size, wrong, probability=float(off))
    expected = model.positions(sweeps, rest)
    off = max(
        float((np.abs(found[name] - each[rows]) / np.maximum(np.abs(each[rows]), 1)).max())
        for name, each in zip(("position", "deviation"), expected, strict=True)
    )
    return Difference(rows.size, wrong, position=off)


def outputs_of(
    exported: ModelProto,
    model: Model,
    sweeps: xr.Dataset,
    rest: xr.Dataset | None,
    rows: NDArray[np.intp],
) -> dict[str, NDArray]:
    """Outputs of a graph for some of the sweeps, by name, computed by onnxruntime.

    Since 1.29, onnxruntime sends reports of its use to its maker and stores a number of the
    computer. ORT_DISABLE_TELEMETRY prevents both if it is set before the import; the function
    `disable_telemetry_events` does not (Privacy.md of onnxruntime). A value of the user stays.
    """
    os.environ.setdefault("ORT_DISABLE_TELEMETRY", "1")
    import onnxruntime

    options = onnxruntime.SessionOptions()
    options.log_severity_level = 3
    session = onnxruntime.InferenceSession(
        exported.SerializeToString(), options, providers=["CPUExecutionProvider"]
    )
    kinds = {"tensor(float)": np.float32, "tensor(double)": np.float64}
    real = {each.name: kinds[each.type] for each in session.get_inputs()}
    given = inputs_of([*real], model, sweeps, rest)
    names = [each.name for each in session.get_outputs()]
    values = session.run(names, {key: given[key][rows].astype(real[key]) for key in real})
    return {name: np.asarray(each) for name, each in zip(names, values, strict=True)}
