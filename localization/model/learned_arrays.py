"""Sizes, types and ranges of the arrays in each part of a model.

A declaration names sizes; sizes with one name are equal within an estimator. F: size of its input,
out: size of its output, K: number of classes, n: number of stored training sweeps. A rule may
follow, see `soundness`; without one an array holds floating-point numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from sklearn.compose import TransformedTargetRegressor
from sklearn.decomposition import PCA
from sklearn.kernel_ridge import KernelRidge
from sklearn.neighbors import KNeighborsRegressor
from sklearn.neural_network import MLPClassifier, MLPRegressor
from sklearn.preprocessing import StandardScaler
from sklearn.svm import SVC

from ..inversion.adapted import AdaptedClassifier, AdaptedPosition
from ..inversion.classifier import ModelBased
from ..inversion.position import ModelBasedPosition
from ..learners.affine import Affine
from ..learners.components import Components
from ..learners.drift import Drifting
from ..learners.ecoc import ECOCClassifier, one_versus_one
from ..learners.gaussians import CURVATURE_COMPONENTS, GaussianClassifier
from ..learners.networks import NetworkClassifier, NetworkRegressor
from ..learners.offsets import Offsets
from ..trust.kinds import KindGuard
from ..trust.several import SeveralGuard


class Inner(NamedTuple):
    """A fitted estimator inside another one. takes: the size of its input."""

    takes: str


CLOSE = 1e-6
"""Relative tolerance of a quantity that follows from others."""
MIXTURE = {
    "noise_": "F >0",
    "mean_": "E F",
    "directions_": "E r F",
    "along_": "E r",
    "log_weight_": "E",
    "edge_": ">0",
}
ADAPTED = {"mean_": Inner("F/2"), "taught_.0?": "n F/2"}
LEARNED: Mapping[type, Mapping[str, str | Inner]] = {
    StandardScaler: {"mean_": "F", "var_": "F >=0", "scale_": "F >0"},
    PCA: {
        "mean_": "F",
        "components_": "out F",
        "explained_variance_": "out >=0",
        "explained_variance_ratio_": "out >=0",
        "singular_values_": "out >=0",
    },
    Components: {"pca_": Inner("F"), "scale_": ">0"},
    Drifting: {"curve": "R <F", "moved.*": "R <F"},
    SVC: {
        "classes_": "K classes",
        "class_weight_": "K >0",
        "support_": "V int",
        "support_vectors_": "V F",
        "_n_support": "K int",
        "dual_coef_": "K-1 V",
        "_dual_coef_": "K-1 V",
        "intercept_": "pairs",
        "_intercept_": "pairs",
        "_probA": "0",
        "_probB": "0",
        "_gamma": ">0",
    },
    ECOCClassifier: {
        "classes_": "K classes",
        "coding_matrix_": "K L int",
        "estimators_.*": Inner("F"),
    },
    GaussianClassifier: {
        "classes_": "K classes",
        "curve": "R <F",
        "absolute": "A <F",
        "_of_change.0": "D",
        "_of_change.1": "D c",
        "_of_curve.0": "R",
        "_of_curve.1": "R z",
        "first_": "K int",
        "normals_.*.0": "W c",
        "normals_.*.1": "B c",
        "normals_.*.2": ">=0",
        "normals_.*.3": "c s",
        "normals_.*.4": "s >0",
        "normals_.*.5": ">0",
        "moved_.0?": "R ways",
        "moved_.1?": ">=0",
    },
    MLPClassifier: {"classes_": "K classes", "intercepts_.-1": "out"},
    MLPRegressor: {"intercepts_.-1": "out"},
    NetworkClassifier: {"network_": Inner("F")},
    NetworkRegressor: {"network_": Inner("F")},
    KNeighborsRegressor: {"_fit_X": "n F", "_y": "n out"},
    KernelRidge: {"X_fit_": "n F", "dual_coef_": "n out", "gamma": ">0"},
    TransformedTargetRegressor: {"regressor_": Inner("F"), "transformer_": Inner("out")},
    ModelBased: {"classes_": "K classes", "answer_": "E <K", **MIXTURE},
    ModelBasedPosition: {
        "bounds_": "3 2",
        "theta_": "E 3",
        "scale_": "3 >0",
        "slopes_": "E F 3",
        "on_skin_?": "rows columns bool",
        "sides_?": "2 >0",
        "beside_?": "E bool",
        **MIXTURE,
    },
    AdaptedClassifier: ADAPTED,
    AdaptedPosition: ADAPTED,
    Affine: {"estimator": Inner("F"), "centre_": "out", "scale_": "out >0", "correction_": "4 out"},
    Offsets: {"estimator": Inner("F"), "classes_": "K classes", "offsets_": "K"},
    KindGuard: {
        "told_": "T <F",
        "scale_": "T >0",
        "pca_": Inner("T"),
        "means_": "kinds out",
        "whitening_": "kinds out out",
        "beside_": ">=0",
        "limit_": ">0",
    },
    SeveralGuard: {"told_": "T <F", "parting_": Inner("T"), "limit_": ">0"},
}
Rule = Callable[[Any, Mapping[str, int]], bool]


def _equal(one: Any, other: Any) -> bool:
    """True if equal up to rounding, relative to the largest value."""
    size = max(float(np.abs(other).max(initial=0.0)), np.finfo(float).tiny)
    return bool((np.abs(np.asarray(one) - other) <= CLOSE * size).all())


def _within_penalty(machine: Any, sizes: Mapping[str, int]) -> bool:
    most = machine.C * machine.class_weight_.max() * (1 + CLOSE)
    return bool((np.abs(machine._dual_coef_) <= most).all())


def _copied(machine: Any, sizes: Mapping[str, int]) -> bool:
    """True if the coefficients agree; for two classes libsvm's copy has the other sign."""
    pairs = ((machine.dual_coef_, machine._dual_coef_), (machine.intercept_, machine._intercept_))
    sign = -1 if sizes["K"] == 2 else 1
    return all(np.array_equal(one, sign * other) for one, other in pairs)


def _all_learners(codes: Any, sizes: Mapping[str, int]) -> bool:
    learners = codes.estimators_
    if len(learners) == 1 < sizes["L"]:
        (own,) = learners
        return len(own.classes_) == sizes["K"] and own.decision_function_shape == "ovo"
    return len(learners) == sizes["L"] and all(len(each.classes_) == 2 for each in learners)


def _densities(classes: Any, sizes: Mapping[str, int]) -> bool:
    squared = min(classes.squared, sizes["z"])
    width = 1 + sizes["z"] + squared * (squared + 1) // 2
    left = sizes["F"] - len({*classes.curve, *classes.absolute})
    ends = np.array([*classes.first_, len(classes.normals_)])
    found = ends[0], sizes["W"], sizes["B"], sizes["D"]
    whole = found == (0, width, min(CURVATURE_COMPONENTS + 1, width), left)
    return whole and bool((np.diff(ends) > 0).all())


def _layers(network: Any, sizes: Mapping[str, int]) -> bool:
    ends = [sizes["F"], *(len(each) for each in network.intercepts_)]
    shapes = [each.shape for each in network.coefs_ if np.asarray(each).dtype.kind == "f"]
    return shapes == list(pairwise(ends)) and network.n_layers_ == len(ends)


def _one_output_a_class(network: Any, sizes: Mapping[str, int]) -> bool:
    binary = sizes["K"] == 2
    output = network.out_activation_, sizes["out"]
    known = np.array_equal(network._label_binarizer.classes_, network.classes_)
    return known and output == (("logistic", 1) if binary else ("softmax", sizes["K"]))


def _nearest(neighbours: Any, sizes: Mapping[str, int]) -> bool:
    return (
        1 <= neighbours.n_neighbors <= sizes["n"]
        and neighbours.n_samples_fit_ == sizes["n"]
        and (neighbours._fit_method, neighbours._tree) == ("brute", None)
        and neighbours.effective_metric_ == "euclidean"
    )


def _products(mixture: Any, sizes: Mapping[str, int]) -> bool:
    return _equal(mixture.along_, np.einsum("ern,en->er", mixture.directions_, mixture.mean_))


MIXED: Mapping[str, Rule] = {"`along_` of its `directions_` and `mean_`": _products}
RULES: Mapping[type, Mapping[str, Rule]] = {
    StandardScaler: {
        "`scale_` of its `var_`": lambda scaler, sizes: _equal(
            np.where(scaler.scale_ == 1, 1, scaler.scale_**2),
            np.where(scaler.scale_ == 1, 1, scaler.var_),
        )
    },
    PCA: {
        "orthonormal `components_`": lambda pca, sizes: _equal(
            pca.components_ @ pca.components_.T, np.eye(sizes["out"])
        )
    },
    SVC: {
        "as many support vectors as `_n_support` says": lambda machine, sizes: bool(
            (machine._n_support >= 0).all() and machine._n_support.sum() == sizes["V"]
        ),
        "`support_` among its training": lambda machine, sizes: bool(
            ((machine.support_ >= 0) & (machine.support_ < machine.shape_fit_[0])).all()
        ),
        "coefficients of `C` at most": _within_penalty,
        "the same coefficients twice": _copied,
        "a kernel that is rbf, of dense sweeps": lambda machine, sizes: (
            (machine.kernel, machine._sparse) == ("rbf", False)
            # scikit-learn before 1.9 has the parameter alone
            and not getattr(machine, "_effective_probability", machine.probability)
        ),
    },
    ECOCClassifier: {
        "the codes of its coding": lambda codes, sizes: np.array_equal(
            codes.coding_matrix_, one_versus_one(sizes["K"])
        ),
        "a learner for each of its codes": _all_learners,
    },
    GaussianClassifier: {"densities of its own size for each class": _densities},
    MLPClassifier: {
        "layers that follow each other": _layers,
        "an output for each class": _one_output_a_class,
    },
    MLPRegressor: {"layers that follow each other": _layers},
    KNeighborsRegressor: {"as many sweeps as its neighbours, looked at one by one": _nearest},
    KernelRidge: {"a kernel that is rbf": lambda ridge, sizes: ridge.kernel == "rbf"},
    TransformedTargetRegressor: {
        "targets of several columns, and no functions": lambda regressor, sizes: (
            (regressor.func, regressor.inverse_func, regressor._training_dim) == (None, None, 2)
        )
    },
    ModelBased: {
        "a touch for each class": lambda inversion, sizes: bool(
            np.bincount(inversion.answer_, minlength=sizes["K"]).all()
        ),
        **MIXED,
    },
    ModelBasedPosition: MIXED,
}
"""Further conditions of each part, with their descriptions."""
