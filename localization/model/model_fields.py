"""Conversion of a trained model to and from the fields that its file stores."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np
from sklearn.compose import TransformedTargetRegressor
from sklearn.neighbors import KNeighborsRegressor
from sklearn.pipeline import Pipeline
from sklearn.preprocessing import StandardScaler
from sklearn.svm import SVC

from ..inputs.samples import LocalizationProblem
from ..inversion.adapted import AdaptedClassifier, AdaptedPosition
from ..inversion.classifier import ModelBased
from ..inversion.position import ModelBasedPosition
from ..learners.affine import Affine
from ..learners.components import Components
from ..learners.drift import Drifting
from ..learners.ecoc import ECOCClassifier
from ..learners.gaussians import GaussianClassifier
from ..learners.networks import NetworkClassifier, NetworkRegressor
from ..learners.offsets import Offsets
from ..trust.diagnosis import Diagnosis
from ..trust.fitted import Classifier, Guards, Regressor
from ..trust.kinds import KindGuard
from ..trust.several import SeveralGuard
from .localizer_model import Model

LAYOUT = 11
"""Layout of the model file; a new number means that older files are not readable."""
EARLIER = {"pipeline", "target", "quantities", "interfaces", "frequencies", "scene", "version"}
"""Fields of layout 1, which stored no layout number."""
OWN_STEPS = (
    Components,
    Drifting,
    ECOCClassifier,
    ModelBased,
    ModelBasedPosition,
    AdaptedClassifier,
    AdaptedPosition,
    GaussianClassifier,
    NetworkClassifier,
    NetworkRegressor,
    Offsets,
    Affine,
)
STEPS = (
    *OWN_STEPS,
    StandardScaler,
    SVC,
    KNeighborsRegressor,
    TransformedTargetRegressor,
)
"""Estimators that a pipeline may contain."""
KINDS = {
    "pipeline": Pipeline,
    "sharpness": float,
    "threshold": float,
    "factor": np.ndarray,
    "spread": Pipeline | None,
    "guards": dict | None,
    "right": int,
    "answered": int,
    "held_out": int,
    "independent": float | None,
    "median_error": float,
    "estimator": str,
    "problem": dict,
    "certain": float | None,
    "validation": str,
    "versions": dict,
    "trained_on": int,
    "left_out": str,
    "marks": np.ndarray,
    "gate": dict | None,
}
GUARDS = {
    "kinds": KindGuard,
    "several": SeveralGuard | None,
    "changes": dict | None,
}
COPIED = ("estimator", "certain", "validation", "versions", "trained_on", "left_out")
"""Fields of a model that are stored under their own names."""
PROBLEM = {
    "target": str,
    "features": int,
    "quantities": tuple,
    "interfaces": tuple,
    "frequencies": tuple,
    "scene": str,
}
DIAGNOSIS = "faults"
"""Additional field if the training had faults, see `Diagnosis`."""
OWN_FREQUENCIES = {"taken": tuple}
"""Additional field if interfaces have frequencies of their own."""


ANOTHER_LAYOUT = f"a model of another layout than {LAYOUT}, the one of this version; train it again"
OF_EARLIER = "localization.", "rcskin.localization.trust.novelty."
"""Prefixes of type names in files of layouts up to 3, and up to 9 with guards."""


class EarlierLayoutError(Exception):
    """The fields are of another layout; the message says what to do."""


def fields_of(model: Model) -> dict[str, Any]:
    """All fields of a model, by the names in KINDS, and the layout."""
    learned = model.learned
    return {
        "layout": LAYOUT,
        "pipeline": learned.pipeline,
        "sharpness": getattr(learned, "sharpness", 1.0),
        "threshold": getattr(learned, "threshold", 0.0),
        "factor": getattr(learned, "factor", np.ones(3)),
        "spread": getattr(learned, "spread", None),
        "guards": _guard_fields(learned.guards),
        "right": getattr(learned, "right", 0),
        "answered": getattr(learned, "answered", 0),
        "held_out": getattr(learned, "held_out", 0),
        "independent": getattr(learned, "independent", None),
        "median_error": getattr(learned, "median_error", 0.0),
        "problem": _problem_fields(model.problem),
        **{name: getattr(model, name) for name in COPIED},
        "marks": model.fingerprints,
        "gate": None if model.gate is None else fields_of(model.gate),
        **({} if model.diagnosis is None else {DIAGNOSIS: _diagnosis_fields(model.diagnosis)}),
    }


def _guard_fields(guards: Guards | None) -> dict[str, Any] | None:
    if guards is None:
        return None
    return {name: getattr(guards, name) for name in GUARDS} | {
        "changes": _guard_fields(guards.changes)
    }


def _guards(fields: dict[str, Any] | None) -> Guards | None:
    if fields is None:
        return None
    _check(fields, GUARDS)
    own = {name: fields[name] for name in GUARDS if name != "changes"}
    return Guards(**own, changes=_guards(fields["changes"]))


def _problem_fields(problem: LocalizationProblem) -> dict[str, Any]:
    fields = asdict(problem)
    return {name: fields[name] for name in fields if name not in OWN_FREQUENCIES or fields[name]}


def model_of(fields: Any) -> Model:
    """The model of these fields. Raises EarlierLayoutError, or ValueError if they are invalid."""
    if _is_earlier(fields):
        raise EarlierLayoutError(ANOTHER_LAYOUT)
    diagnosis = fields.pop(DIAGNOSIS, None) if isinstance(fields, dict) else None
    _check(fields, {"layout": int, **KINDS})
    own = fields["problem"]
    _check(own, PROBLEM | OWN_FREQUENCIES if OWN_FREQUENCIES.keys() <= own.keys() else PROBLEM)
    problem = LocalizationProblem(**fields["problem"])
    return Model(
        learned=_learned(fields, problem.continuous),
        problem=problem,
        gate=None if fields["gate"] is None else model_of(fields["gate"]),
        fingerprints=fields["marks"],
        diagnosis=_diagnosis(diagnosis),
        **{name: fields[name] for name in COPIED},
    )


def _diagnosis_fields(diagnosis: Diagnosis) -> dict[str, Any]:
    return {"guards": dict(diagnosis.guards), "misleading": diagnosis.misleading}


def _diagnosis(fields: dict[str, Any] | None) -> Diagnosis | None:
    if fields is None:
        return None
    _check(fields, {"guards": dict, "misleading": tuple})
    guards = fields["guards"]
    _check(guards, dict.fromkeys(guards, KindGuard))
    if len(guards) < 2 or not set(fields["misleading"]) <= guards.keys():
        raise ValueError("a diagnosis of other kinds")
    return Diagnosis(**fields)


def _learned(fields: dict[str, Any], continuous: bool) -> Classifier | Regressor:
    kind, names = (
        (Regressor, {"factor", "spread", "median_error"})
        if continuous
        else (
            Classifier,
            {"sharpness", "threshold", "right", "answered", "held_out", "independent"},
        )
    )
    own = {name: fields[name] for name in names}
    return kind(pipeline=fields["pipeline"], guards=_guards(fields["guards"]), **own)


def _is_earlier(fields: Any) -> bool:
    if not isinstance(fields, dict):
        return False
    return fields.keys() == EARLIER or fields.get("layout", LAYOUT) != LAYOUT


def _check(fields: Any, kinds: dict[str, Any]) -> None:
    if not isinstance(fields, dict) or fields.keys() != kinds.keys():
        raise ValueError("other fields")
    for name, kind in kinds.items():
        if not isinstance(fields[name], kind):
            raise ValueError(f"`{name}` is of another type")
    for name in {"pipeline", "spread"} & fields.keys():
        if fields[name] and not all(isinstance(step, STEPS) for _, step in fields[name].steps):
            raise ValueError("a pipeline of other steps")
