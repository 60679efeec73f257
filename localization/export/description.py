"""What an exported file says about its model: inputs, outputs, units and origin."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.metadata import version

from ...simulator.sweeps.reading_quantities import DESCRIBED
from ..model.localizer_model import Model
from .graph_parts import OPENING_SWEEPS, RECENT
from .portable import PortableModel

FEATURES_VERSION = 1
"""Version of the definitions of features; a new number means that one has changed."""
BASELINES = {
    RECENT: "latest sweeps of the unpressed skin before the sweep, up to 3",
    OPENING_SWEEPS: "first sweeps of the unpressed skin in the session, up to 8",
}
OUTPUTS = {
    "probabilities": "probability of each of `labels`",
    "label": "index of the answer in `labels`, -1 for cannot tell",
    "novelty": "distance from the training sweeps: above 1 is unlike them, and the label is -1",
    "position": "x in mm, y in mm, strength",
    "deviation": "standard deviations of the position",
}
UNGUARDED = "no guard: sweeps unlike the training are answered too"
FAULTS_LEFT_OUT = "faults are not recognized: sweeps like those of {kinds} are answered too"


def limits_of(model: Model, parts: PortableModel) -> list[str]:
    """Sentences on what `rcskin localize` refuses to answer, and an exported model does not."""
    lines = [] if parts.guarded else [UNGUARDED]
    if model.diagnosis is not None and model.diagnosis.misleading:
        kinds = " or ".join(model.diagnosis.misleading)
        lines.append(FAULTS_LEFT_OUT.format(kinds=kinds))
    return lines


def described(model: Model, parts: PortableModel, inputs: Sequence[str]) -> dict[str, object]:
    """Description of an exported model, by key. inputs: names of its inputs."""
    problem = model.problem
    outputs = ["position", "deviation"] if problem.continuous else []
    outputs += ["probabilities"] if parts.gate or not problem.continuous else []
    outputs += ["label", "novelty"] if parts.guarded else ["label"]
    return {
        "rcskin_version": version("rcskin"),
        "target": model.target,
        "estimator": model.estimator,
        "features": list(problem.quantities),
        "features_version": FEATURES_VERSION,
        "interfaces": list(problem.interfaces),
        "frequencies_Hz": list(problem.frequencies),
        **({"taken": [list(map(int, row)) for row in problem.taken]} if problem.taken else {}),
        "labels": list(parts.labels),
        "min_probability": parts.threshold,
        "inputs": {name: input_meaning(name) for name in inputs},
        "outputs": {name: OUTPUTS[name] for name in outputs},
        "guard": "distance from the training sweeps" if parts.guarded else UNGUARDED,
        "limits": limits_of(model, parts),
        "trained_with": dict(model.versions),
        "trained_on_sweeps": model.trained_on,
        "validation": f"{model.validation}: {model.learned.outcome}",
        "scene": problem.scene,
    }


def input_meaning(name: str) -> str:
    """Meaning and unit of an input, such as `baseline_Rs`."""
    for prefix, meaning in BASELINES.items():
        if name.startswith(prefix):
            quantity = DESCRIBED[name.removeprefix(prefix)]
            return f"{quantity.meaning}, {quantity.units}, of the {meaning}"
    return f"{DESCRIBED[name].meaning}, {DESCRIBED[name].units}"
