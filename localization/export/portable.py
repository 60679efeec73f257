"""A trained model in the parts that any language can compute, from readings to answers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...simulator.arrays import Real
from ...simulator.sweeps import InputError
from ...simulator.sweeps.errors import named
from ..inputs.features import names_beside
from ..inputs.samples import LocalizationProblem
from ..learners.registry import learners
from ..model.localizer_model import Model
from ..parts.parts import (
    DenseLayers,
    Layer,
    LogProbabilities,
    NearestErrors,
    PairwiseSVMs,
    Part,
    Scaling,
)
from ..parts.predictor import Chain
from ..trust.fitted import Classifier, Guards
from ..trust.kinds import KindGuard
from ..trust.several import SeveralGuard

Distance = KindGuard | SeveralGuard

ONE_TOUCH = ("1",)
"""Labels of a model of positions whose training had one touch in every sweep."""


@dataclass(frozen=True, eq=False)
class PortableModel:
    """Parts of a trained model.

    chain: from features to decisions of classes, or to positions. labels: classes as text; of
    positions, numbers of touches. sharpness: factor of decisions before the softmax. threshold:
    minimum probability of an answer. distances: of the features; change_distances: of the changes
    from the baseline in change_quantities. gate: model of the number of touches. spread: variances
    of positions; factor: of their roots, shape (3,).
    """

    problem: LocalizationProblem
    chain: tuple[Part, ...]
    labels: tuple[str, ...]
    sharpness: float
    threshold: float
    distances: tuple[Distance, ...]
    change_quantities: tuple[str, ...]
    change_distances: tuple[Distance, ...]
    gate: PortableModel | None
    spread: NearestErrors | None
    factor: Real

    @property
    def guarded(self) -> bool:
        """True if sweeps unlike the training are recognized."""
        return bool(self.distances)

    @property
    def all_quantities(self) -> tuple[str, ...]:
        """Names of all features that the model, its guards and its gate use."""
        gate = () if self.gate is None else self.gate.all_quantities
        return *self.problem.quantities, *self.change_quantities, *gate


def portable(model: Model, *, guarded: bool = True) -> PortableModel:
    """Parts of a model. guarded: False leaves out the guards.

    Raises InputError if the model inverts the simulator, so that it has no parts.
    """
    learned, chain = model.learned, model.predictor
    if not isinstance(chain, Chain):
        able = ", ".join(learners())
        raise InputError(
            f"{model.source}: a model of {model.estimator} computes with the simulator and cannot "
            f"be exported; models of {able} can: train one with {named('estimator')}"
        )
    guards = learned.guards if guarded else None
    changes = None if guards is None else guards.changes
    gate = None if model.gate is None else portable(model.gate, guarded=guarded)
    classes = isinstance(learned, Classifier)
    return PortableModel(
        problem=model.problem,
        chain=_of_two_classes(chain.parts),
        labels=tuple(map(str, learned.classes)) if classes else gate.labels if gate else ONE_TOUCH,
        sharpness=learned.sharpness if classes else 1.0,
        threshold=learned.threshold if classes else 0.0,
        distances=_distances(guards),
        change_quantities=() if changes is None else _change_names(model.problem, changes),
        change_distances=_distances(changes),
        gate=gate,
        spread=None if classes else learned.spread,
        factor=np.ones(3) if classes else learned.factor,
    )


def _change_names(problem: LocalizationProblem, changes: Guards) -> tuple[str, ...]:
    """Names of the changes that guards use; only the first without phases."""
    count = changes.features // problem.readings
    return names_beside(problem.quantities).relative[:count]


def _distances(guards: Guards | None) -> tuple[Distance, ...]:
    if guards is None:
        return ()
    return (guards.kinds,) if guards.several is None else (guards.kinds, guards.several)


def _of_two_classes(parts: tuple[Part, ...]) -> tuple[Part, ...]:
    """The parts, where layers whose output is the ln of odds give a number for each class."""
    found = list(parts)
    for k, (layers, after) in enumerate(zip(parts, parts[1:], strict=False)):
        if isinstance(layers, DenseLayers) and isinstance(after, LogProbabilities):
            *hidden, last = layers.layers
            if last.offset.size == 1:
                W, b = last.weights, last.offset
                both = Layer(np.hstack([np.zeros_like(W), W]), np.append(np.zeros_like(b), b))
                found[k] = DenseLayers((*hidden, both))
    return tuple(found)


def scaling_of(guard: Distance) -> Scaling:
    """Scaling of the features that a guard uses, to zero mean."""
    if isinstance(guard, SeveralGuard):
        return guard.scaling
    return Scaling(guard.components.mean * guard.scale, guard.scale)


def less_one(part: PairwiseSVMs) -> Real:
    """Offsets of scores by the kernel less 1, which single precision rounds less; shape (K, K)."""
    ones, group = np.zeros_like(part.offset), np.repeat(np.arange(len(part.counts)), part.counts)
    np.add.at(ones, group, part.coefficients)
    return part.offset + ones - ones.T
