"""The localizers that invert the simulator, among the named ones, told who makes tables."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from sklearn.pipeline import Pipeline

from ...simulator.sweeps import InputError, inputs
from ..inputs.rest import FEWEST
from ..inputs.samples import Problem
from ..inputs.targets import TARGETS
from ..learners.registry import Estimator
from . import adapted as inversion_adapted
from . import classifier as inversion
from .adapted import AdaptedClassifier, AdaptedPosition
from .classifier import Builder, ModelBased
from .position import ModelBasedPosition

NAME, ADAPTED = "model-based", "model-adapted"
SKINS = 4
"""Sessions that probabilities and deviations are found on: each skin costs seconds."""


def model_based(builder: Builder) -> list[Estimator]:
    """Both estimators: of the skin in the mean, and of the skin at hand, by its curve at rest.

    builder: tables of a scene's text, a target, strengths, and maybe a curve at rest.
    """

    def equip(pipeline: Pipeline) -> None:
        pipeline.set_params(invert__builder=builder)

    adapted = _pipeline_by(builder, ADAPTED)
    return [
        Estimator(NAME, TARGETS, _pipeline_by(builder, NAME), taught=False),
        Estimator(ADAPTED, TARGETS, adapted, sessions=SKINS, taught=False, equip=equip),
    ]


def answer_at_once(pipeline: Pipeline) -> None:
    """Have tables of skins made beside the work, where a pipeline makes any: see `Skins`."""
    step: Any = pipeline[-1]
    if isinstance(step, AdaptedClassifier | AdaptedPosition):
        step.beside = True


def _pipeline_by(builder: Builder, name: str) -> Callable[[Problem], Pipeline]:
    def build(problem: Problem) -> Pipeline:
        takes = inversion_adapted.QUANTITIES if name == ADAPTED else inversion.QUANTITIES
        _check(problem, name, takes)
        step: Any = (
            ModelBasedPosition(problem.scene, builder, rest_sweeps=FEWEST)
            if problem.continuous
            else ModelBased(problem.scene, problem.target, builder, rest_sweeps=FEWEST)
        )
        if name == ADAPTED:
            kind = AdaptedPosition if problem.continuous else AdaptedClassifier
            step = kind(step.set_params(builder=None), builder)
        return Pipeline([("invert", step)])

    return build


def _check(problem: Problem, name: str, takes: Sequence[str]) -> None:
    """Raises InputError where the simulator would tell other features than the sweeps."""
    if problem.quantities != tuple(takes):
        raise InputError(
            f"`estimator` {name} takes the features {','.join(takes)}, "
            f"got {','.join(problem.quantities)}"
        )
    try:
        own = {each["name"]: each.get("frequencies") for each in _interfaces(problem.scene)}
    except (tomllib.TOMLDecodeError, KeyError) as error:
        raise InputError(f"`estimator` {name} needs the scene, which the sweeps lack") from error
    known = tuple(own)
    if problem.interfaces != known:
        raise InputError(
            f"`estimator` {name} takes all interfaces of the scene, {', '.join(known)}, "
            f"got {', '.join(problem.interfaces)}"
        )
    asked = problem.frequencies
    told = [np.isin(asked, asked if given is None else given) for given in own.values()]
    whole = np.ones((len(known), len(problem.frequencies)), dtype=bool)
    if not np.array_equal(told, problem.taken or whole):
        raise InputError(
            f"`estimator` {name} takes each interface at the `frequencies` that the scene reads it "
            "at, and the sweeps were read at others"
        )


def _interfaces(scene: str) -> list[dict[str, Any]]:
    return inputs.tables(scene)["interface"]
