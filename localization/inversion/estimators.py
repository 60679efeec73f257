"""All estimators by name: trained ones, and those that invert the simulator."""

from __future__ import annotations

from functools import partial
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ...simulator.arrays import Real
from ...simulator.scene.scene_files import carried_scene
from ...simulator.sweeps import InputError
from ...simulator.sweeps.errors import named
from ..inputs.baselines import MIN_BASELINES
from ..inputs.features import NAMES, OF_IMPEDANCE, FeatureNames, names_beside
from ..inputs.samples import LocalizationProblem
from ..inputs.targets import CLASSES, TARGETS
from ..learners.classifiers import REFERENCE
from ..learners.registry import REMOVED, Estimator, learners, removal_message
from ..parts.predictor import Predictor
from .adapted import AdaptedClassifier, AdaptedPosition
from .classifier import InversionPlan, ModelBased
from .position import ModelBasedPosition

MODEL_BASED, MODEL_ADAPTED = "model-based", "model-adapted"
SKINS = 4
"""Number of sessions that calibrate probabilities and deviations: each skin costs seconds."""


DEFAULT_ESTIMATORS = {
    **dict.fromkeys(CLASSES, REFERENCE),
    "touches": "ksvm-components",
    "pair": "ksvm-components",
    "position": "kernel-ridge",
}
"""Default estimator of each target."""


EstimatorName = Literal[
    "ksvm-ovo",
    "ksvm-components",
    "gaussian",
    "kernel-ridge",
    "network",
    "model-based",
    "model-adapted",
]
"""Names of `estimators`."""


def estimators() -> dict[str, Estimator]:
    """All estimators by name."""
    return learners() | {each.name: each for each in model_based()}


def chosen(name: str | None, target: str) -> Estimator:
    """The estimator with that name, or the default one.

    Raises InputError for an unknown target, an unknown name, or one that cannot predict the target.
    """
    if target not in TARGETS:
        raise InputError(f"{named('target')} must be one of {', '.join(TARGETS)}, got {target!r}")
    known = estimators()
    able = [each.name for each in known.values() if target in each.targets]
    name = name or DEFAULT_ESTIMATORS[target]
    if name in REMOVED:
        raise InputError(f"{named('estimator')} {removal_message(name)}")
    if name not in able:
        raise InputError(
            f"{named('estimator')} must be one of {', '.join(able)} for {named('target')} "
            f"{target}, got {name!r}"
        )
    return known[name]


def model_based() -> list[Estimator]:
    """Both estimators that invert the simulator: for the mean skin, and for the actual skin."""
    return [
        _inverting(MODEL_BASED, curve=None),
        _inverting(MODEL_ADAPTED, curve=0, max_sessions=SKINS),
    ]


def _inverting(name: str, curve: int | None, max_sessions: int | None = None) -> Estimator:
    return Estimator(
        name,
        TARGETS,
        partial(_fitted, name),
        check=partial(_check, name=name),
        max_sessions=max_sessions,
        uses_sweeps=False,
        curve=curve,
    )


def _fitted(
    name: str, problem: LocalizationProblem, X: Real, y: NDArray, **options: Any
) -> Predictor:
    """Trained estimator that inverts the simulator; options: those of `InversionPlan`."""
    _check(problem, name)
    plan = InversionPlan(problem.scene, problem.target, rest_sweeps=MIN_BASELINES, **options)  # pyright: ignore[reportArgumentType]
    if problem.continuous:
        kind = AdaptedPosition if name == MODEL_ADAPTED else ModelBasedPosition
        return kind.fitted(plan)
    kind = AdaptedClassifier if name == MODEL_ADAPTED else ModelBased
    return kind.fitted(plan, X, y)


def _check_features(problem: LocalizationProblem, name: str, names: FeatureNames) -> None:
    """Raise InputError unless the features are those that an estimator takes, in their order."""
    takes = (*names.relative, *(names.baseline if name == MODEL_ADAPTED else ()))
    if problem.quantities != takes:
        raise InputError(
            f"{named('estimator')} {name} takes the features {','.join(takes)}, "
            f"got {','.join(problem.quantities)}"
        )


def _check(problem: LocalizationProblem, name: str) -> None:
    """Raise InputError if the simulator's features differ from those of the sweeps."""
    if (names := names_beside(problem.quantities)) is OF_IMPEDANCE:
        _check_features(problem, name, names)
    scene = carried_scene(problem.scene)
    if scene is None:
        raise InputError(f"{named('estimator')} {name} needs the scene, which the sweeps lack")
    _check_features(problem, name, NAMES[scene.parts.setup.kind.name])
    known = tuple(each.name for each in scene.interfaces)
    if problem.interfaces != known:
        raise InputError(
            f"{named('estimator')} {name} takes all interfaces of the scene, {', '.join(known)}, "
            f"got {', '.join(problem.interfaces)}"
        )
    every = problem.frequencies
    taken = [
        np.isin(every, every if (own := each.frequencies) is None else own)
        for each in scene.interfaces
    ]
    whole = np.ones((len(known), len(problem.frequencies)), dtype=bool)
    if not np.array_equal(taken, problem.taken or whole):
        raise InputError(
            f"{named('estimator')} {name} takes each interface at its `frequencies` of the "
            "scene, and the "
            "sweeps have others"
        )
