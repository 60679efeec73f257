"""The localizer that inverts the simulator, among the named ones; it is told who makes tables."""

from __future__ import annotations

import tomllib
from collections.abc import Callable

from sklearn.base import BaseEstimator
from sklearn.pipeline import Pipeline

from localization.estimators import Estimator
from localization.inversion import QUANTITIES, Builder, ModelBased
from localization.inversion_position import ModelBasedPosition
from localization.samples import Problem
from localization.targets import TARGETS
from simulator.sweeps import InputError

NAME = "model-based"


def model_based(builder: Builder) -> Estimator:
    """The estimator of that name. builder: tables of a scene's text, a target, and strengths."""
    return Estimator(NAME, TARGETS, _pipeline_by(builder))


def _pipeline_by(builder: Builder) -> Callable[[Problem], Pipeline]:
    def build(problem: Problem) -> Pipeline:
        _check(problem)
        step: BaseEstimator = (
            ModelBasedPosition(problem.scene, builder)
            if problem.continuous
            else ModelBased(problem.scene, problem.target, builder)
        )
        return Pipeline([("invert", step)])

    return build


def _check(problem: Problem) -> None:
    """Raises InputError where the simulator would tell other features than the sweeps."""
    if problem.quantities != QUANTITIES:
        raise InputError(
            f"`estimator` {NAME} takes the features {','.join(QUANTITIES)}, "
            f"got {','.join(problem.quantities)}"
        )
    try:
        known = tuple(each["name"] for each in tomllib.loads(problem.scene)["interface"])
    except (tomllib.TOMLDecodeError, KeyError) as error:
        raise InputError(f"`estimator` {NAME} needs the scene, which the sweeps lack") from error
    if problem.interfaces != known:
        raise InputError(
            f"`estimator` {NAME} takes all interfaces of the scene, {', '.join(known)}, "
            f"got {', '.join(problem.interfaces)}"
        )
