"""Parts of fitted estimators, as plain arrays."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import combinations
from typing import Any

import numpy as np
from sklearn.compose import TransformedTargetRegressor
from sklearn.frozen import FrozenEstimator
from sklearn.kernel_ridge import KernelRidge
from sklearn.pipeline import Pipeline
from sklearn.preprocessing import StandardScaler
from sklearn.svm import SVC

from ...simulator.arrays import Real
from ..learners.affine import Affine
from ..learners.components import Components
from ..learners.decisions import MIN_PROBABILITY
from ..learners.drift import Drifting
from ..learners.ecoc import ECOCClassifier
from ..learners.gaussians import ClassDensity, GaussianClassifier
from ..learners.networks import NetworkClassifier, NetworkRegressor
from ..learners.offsets import Offsets
from .parts import (
    AffineMap,
    BaselineCorrection,
    Decoding,
    DenseLayers,
    KernelSum,
    LogProbabilities,
    NormalDensities,
    PairwiseSVMs,
    Part,
)


class NoPartsError(Exception):
    """An estimator has no parts: it needs the simulator or other code to predict."""


def chain_of(estimator: Any) -> tuple[Part, ...]:
    """Parts of a fitted estimator, in order, from features to decisions or positions.

    Decisions may differ from those of the estimator by a number that all classes of a sweep share.
    Raises NoPartsError.
    """
    for kind, parts in PARTS.items():
        if isinstance(estimator, kind):
            return parts(estimator)
    raise NoPartsError(type(estimator).__name__)


def _of_pipeline(pipeline: Any) -> tuple[Part, ...]:
    return tuple(part for _, step in pipeline.steps for part in chain_of(step))


def _of_scaler(scaler: Any) -> tuple[Part, ...]:
    return (AffineMap.scaling(scaler.mean_, scaler.scale_),)


def _of_components(components: Any) -> tuple[Part, ...]:
    pca = components.pca_
    matrix = pca.components_.T / components.scale_
    return (AffineMap(pca.mean_, matrix, np.zeros(matrix.shape[1])),)


def _of_pairs(codes: Any) -> tuple[Part, ...]:
    """Parts of an ECOCClassifier, whose one SVC numbers the classes backwards."""
    K = codes.classes_.size
    if len(codes.estimators_) == 1:
        (machine,) = codes.estimators_
        return (_pairwise(machine, [*reversed(range(K))], "hinge loss"),)
    each = zip(combinations(range(K), 2), codes.estimators_, strict=True)
    return (_joined([_pairwise(own, [j, i], "hinge loss", K) for (i, j), own in each]),)


def _of_svc(machine: Any) -> tuple[Part, ...]:
    K = len(machine.classes_)
    return (_pairwise(machine, [*range(K)], "votes" if K > 2 else "sum"),)


def _pairwise(
    machine: Any, numbers: list[int], decoding: Decoding, K: int | None = None
) -> PairwiseSVMs:
    """The SVMs of one SVC. numbers: our numbers of its classes. K: number of our classes."""
    own, K = len(numbers), K or len(numbers)
    sign = -1.0 if own == 2 else 1.0  # scikit-learn turns the sign of two classes
    dual, intercept = sign * machine.dual_coef_, sign * machine.intercept_
    ends = np.cumsum([0, *machine.n_support_])
    coefficients, offset = np.zeros((ends[-1], K)), np.zeros((K, K))
    for pair, (a, b) in enumerate(combinations(range(own), 2)):
        of_a, of_b = slice(ends[a], ends[a + 1]), slice(ends[b], ends[b + 1])
        coefficients[of_a, numbers[b]] = dual[b - 1, of_a]
        coefficients[of_b, numbers[a]] = -dual[a, of_b]
        offset[numbers[a], numbers[b]] = intercept[pair]
        offset[numbers[b], numbers[a]] = -intercept[pair]
    group = np.repeat(numbers, machine.n_support_)
    order = np.argsort(group, kind="stable")
    counts = np.bincount(group, minlength=K)
    vectors = np.asarray(machine.support_vectors_)
    gamma = float(machine._gamma)
    ones = np.zeros((K, K))
    np.add.at(ones, group, coefficients)
    offset += ones - ones.T
    return PairwiseSVMs(vectors[order], gamma, counts, coefficients[order], offset, decoding)


def _joined(machines: list[PairwiseSVMs]) -> PairwiseSVMs:
    """The SVMs of all, which have one width and one decoding."""
    first, K = machines[0], len(machines[0].counts)
    group = np.concatenate([np.repeat(np.arange(K), each.counts) for each in machines])
    order = np.argsort(group, kind="stable")
    return PairwiseSVMs(
        np.concatenate([each.vectors for each in machines])[order],
        first.gamma,
        np.bincount(group, minlength=K),
        np.concatenate([each.coefficients for each in machines])[order],
        np.sum([each.offset for each in machines], axis=0),
        first.decoding,
    )


def kernel_sum(machine: Any) -> KernelSum:
    """The decision of an SVC of two classes, positive for the second one."""
    vectors, weights = np.asarray(machine.support_vectors_), np.asarray(machine.dual_coef_).T
    offset = np.asarray(machine.intercept_) + weights.sum(axis=0)
    return KernelSum(vectors, float(machine._gamma), weights, offset)


def _of_classifying_network(classifier: Any) -> tuple[Part, ...]:
    layers = _layers(classifier.network_)
    if len(classifier.classes_) == 2:  # one output: ln of the odds of the second class
        *hidden, (W, b) = layers.weights
        both = np.hstack([np.zeros_like(W), W]), np.append(np.zeros_like(b), b)
        layers = DenseLayers((*hidden, both))
    return layers, LogProbabilities(MIN_PROBABILITY)


def _layers(network: Any) -> DenseLayers:
    if network.activation != "relu":
        raise NoPartsError(f"a network of {network.activation}")
    return DenseLayers(tuple(zip(network.coefs_, network.intercepts_, strict=True)))


def _of_scaled_regressor(regressor: Any) -> tuple[Part, ...]:
    scaler: Any = regressor.transformer_
    if type(scaler) is not StandardScaler:
        raise NoPartsError(type(scaler).__name__)
    mean = np.asarray(scaler.mean_)
    back = AffineMap(np.zeros_like(mean), np.asarray(scaler.scale_), mean)
    return *chain_of(regressor.regressor_), back


def _of_ridge(ridge: Any) -> tuple[Part, ...]:
    weights = np.asarray(ridge.dual_coef_)
    return (KernelSum(ridge.X_fit_, float(ridge.gamma), weights, weights.sum(axis=0)),)


def _of_offsets(corrected: Any) -> tuple[Part, ...]:
    one = np.ones_like(corrected.offsets_)
    return *chain_of(corrected.estimator), AffineMap(0 * one, one, corrected.offsets_)


def _of_affine(corrected: Any) -> tuple[Part, ...]:
    shift, turn = corrected.correction_[0], corrected.correction_[1:]
    matrix = np.eye(len(shift)) + turn / corrected.scale_[:, None]
    moved = AffineMap(corrected.centre_, matrix, corrected.centre_ + shift)
    return *chain_of(corrected.estimator), moved


def _of_densities(classifier: Any) -> tuple[Part, ...]:
    curve, change = classifier._columns(classifier.n_features_in_)
    (_, turn), (centre, axes) = classifier._of_change, classifier._of_curve
    normals = [ClassDensity._make(each) for each in classifier.normals_]
    roots = np.array([_whitening(each) for each in normals])
    spreads = [
        np.log(each.own).sum() + (len(root) - len(each.own)) * np.log(each.floor)
        for each, root in zip(normals, roots, strict=True)
    ]
    moved = classifier.moved_
    known = AffineMap(centre, axes, np.zeros(axes.shape[1]))
    return (
        NormalDensities(
            change=change,
            curve=curve,
            absolute=np.array(classifier.absolute, dtype=np.intp),
            correction=None if moved is None else BaselineCorrection(*moved),
            turn=turn,
            known=known,
            pairs=np.triu_indices(min(classifier.squared, axes.shape[1])),
            whitening=roots,
            by_curve=np.array([each.by_curve for each in normals]) @ roots,
            curvature=np.array([each.curvature for each in normals]) @ roots,
            strength=np.array([each.strength for each in normals]),
            constant=np.array([each.prior for each in normals]) - np.array(spreads) / 2,
            first=classifier.first_,
        ),
    )


def _whitening(normal: ClassDensity) -> Real:
    """Symmetric root of the inverse covariance of the residual, shape (c, c)."""
    within = 1 / np.sqrt(normal.own) - 1 / np.sqrt(normal.floor)
    return np.eye(len(normal.axes)) / np.sqrt(normal.floor) + normal.axes * within @ normal.axes.T


PARTS: Mapping[type, Callable[[Any], tuple[Part, ...]]] = {
    Pipeline: _of_pipeline,
    FrozenEstimator: lambda frozen: chain_of(frozen.estimator),
    Drifting: lambda drifting: (),
    StandardScaler: _of_scaler,
    Components: _of_components,
    ECOCClassifier: _of_pairs,
    SVC: _of_svc,
    GaussianClassifier: _of_densities,
    NetworkClassifier: _of_classifying_network,
    NetworkRegressor: lambda regressor: (_layers(regressor.network_),),
    TransformedTargetRegressor: _of_scaled_regressor,
    KernelRidge: _of_ridge,
    Offsets: _of_offsets,
    Affine: _of_affine,
}
