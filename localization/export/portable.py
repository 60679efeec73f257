"""A trained model as plain parts, from readings to answers, that any language can compute."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ...simulator.sweeps import InputError
from ..inputs.feature_names import names_beside
from ..inputs.samples import LocalizationProblem
from ..learners.registry import learners
from ..model.localizer_model import Model
from ..trust.fitted import Classifier, Guards, Regressor
from ..trust.kinds import KindGuard
from ..trust.several import SeveralGuard
from .learned_parts import NoPartsError, chain_of, kernel_sum
from .parts import AffineMap, Distance, KindDistance, NearestErrors, Part, SeveralDistance

ONE_TOUCH = ("1",)
"""Labels of a model of positions whose training had one touch in every sweep."""


@dataclass(frozen=True, eq=False)
class PortableModel:
    """Parts of a trained model.

    chain: from features to decisions of classes, or to positions. labels: classes as text; of
    positions, numbers of touches. sharpness: factor of decisions before the softmax. threshold:
    minimum probability of an answer. distances: of the features; change_distances: of the changes
    from the baseline in change_quantities. gate: model of the number of touches. deviations: those
    of positions.
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
    deviations: NearestErrors | None

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
    learned = model.learned
    try:
        chain = chain_of(learned.pipeline)
    except NoPartsError:
        able = ", ".join(learners())
        raise InputError(
            f"{model.source}: a model of {model.estimator} computes with the simulator and cannot "
            f"be exported; models of {able} can: train one with --estimator"
        ) from None
    guards = learned.guards if guarded else None
    changes = None if guards is None else guards.changes
    gate = None if model.gate is None else portable(model.gate, guarded=guarded)
    classes = isinstance(learned, Classifier)
    return PortableModel(
        problem=model.problem,
        chain=chain,
        labels=tuple(map(str, learned.classes)) if classes else gate.labels if gate else ONE_TOUCH,
        sharpness=learned.sharpness if classes else 1.0,
        threshold=learned.threshold if classes else 0.0,
        distances=_distances(guards),
        change_quantities=() if changes is None else _change_names(model.problem, changes),
        change_distances=_distances(changes),
        gate=gate,
        deviations=None if classes else _deviations(learned),
    )


def _change_names(problem: LocalizationProblem, changes: Guards) -> tuple[str, ...]:
    """Names of the changes that guards use; only the first without phases."""
    each, guard = problem.features // len(problem.quantities), changes.kinds
    return names_beside(problem.quantities).relative[: len(guard.told_) // each]


def _distances(guards: Guards | None) -> tuple[Distance, ...]:
    if guards is None:
        return ()
    several = () if guards.several is None else (_of_several(guards.several),)
    return _of_kinds(guards.kinds), *several


def _of_kinds(guard: KindGuard) -> KindDistance:
    pca: Any = guard.pca_
    return KindDistance(
        np.asarray(guard.told_),
        AffineMap.scaling(pca.mean_ * guard.scale_, guard.scale_),
        pca.components_,
        guard.means_,
        guard.whitening_,
        float(guard.beside_),
        guard.limit_,
    )


def _of_several(guard: SeveralGuard) -> SeveralDistance:
    (_, scaler), (_, machine) = guard.parting_.steps
    scaling = AffineMap.scaling(scaler.mean_, scaler.scale_)
    return SeveralDistance(np.asarray(guard.told_), scaling, kernel_sum(machine), guard.limit_)


def _deviations(learned: Regressor) -> NearestErrors:
    spread: Any = learned.spread
    (_, scaler), (_, near) = spread.steps
    scaling = AffineMap.scaling(scaler.mean_, scaler.scale_)
    return NearestErrors(scaling, near._fit_X, near._y, int(near.n_neighbors), learned.factor)
