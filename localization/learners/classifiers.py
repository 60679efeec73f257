"""Learners of classes: each fits scikit-learn's estimators and returns their plain parts."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...simulator.arrays import Real
from ...simulator.sweeps import InputError
from ...simulator.sweeps.errors import named
from ..inputs.features import ABSOLUTE, BASELINE, READ, RELATIVE
from ..inputs.samples import LocalizationProblem
from ..parts.parts import Components, Decoding, KernelSum, PairwiseSVMs, Scaling
from ..parts.predictor import Chain
from . import gaussians

REFERENCE = "ksvm-ovo"
"""One-versus-one, the default of MATLAB's `fitcecoc`."""
KERNEL_WIDTH = 0.1
"""gamma of the kernel exp(-gamma |x - x'|²) times the number of features."""
COMPONENTS = 8
"""Maximum number of components of an SVM or a ridge regression."""


def reference(X: Real, y: NDArray, C: float = 100.0, gamma: float | None = None) -> Chain:
    """Features of zero mean and unit variance, then the paper's SVM.

    X: shape (n, feature). y: classes, (n,). C: penalty of a sweep on the wrong side of a margin.
    gamma: by default KERNEL_WIDTH over the number of features. Raises ValueError for one class.

    Width and penalty were chosen on the paper's six simulated devices, six presses a pixel, 5-fold,
    mean of six draws of 0.3 % and 0.15 degrees of noise: against gamma = "scale" and C = 10 they
    gain 3 points on the 1x4 strip (98 %) and the 5x5 sheet (94 %) and lose 1 on the 1x5 strip; a
    wider kernel or C up to 1e5 changes no device by more than a point.
    """
    scaling = standardized(X)
    width = KERNEL_WIDTH / X.shape[1] if gamma is None else gamma
    classes, machines = coded_svms(scaling(X), y, C=C, gamma=width)
    return Chain((scaling, machines), classes)


def components_svm(
    problem: LocalizationProblem, X: Real, y: NDArray, C: float = 1e4, gamma: float = 0.1
) -> Chain:
    """Components in the proportions of the features, then `SVC`.

    It is for quantities of equal errors, such as dlnZ and dphase.
    """
    first, X = on_one_scale(problem, X)
    components = leading_components(X)
    machine = _fitted_svc(components(X), y, C=C, gamma=gamma, break_ties=True)
    numbers = [*range(len(machine.classes_))]
    decoding: Decoding = "votes" if len(numbers) > 2 else "sum"
    part = _pairwise(machine, numbers, decoding)
    return Chain((*first, components, part), class_names(machine.classes_))


def gaussian(problem: LocalizationProblem, X: Real, y: NDArray) -> Chain:
    """A normal density per class, given the baseline curve if known.

    Raises InputError for features of the baseline alone.
    """
    first, X = on_one_scale(problem, X)
    classes, index = np.unique(y, return_inverse=True)
    densities = gaussians.fitted(X, index, *curve_and_absolute(problem))
    return Chain((*first, densities), class_names(classes))


def curve_and_absolute(
    problem: LocalizationProblem,
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Indices of the features of the baseline, and of those of the sweep as read.

    Both are in the order of the changes. Raises InputError for features of the baseline alone.
    """
    blocks = problem.blocks
    if all(name in BASELINE for name in problem.quantities):
        raise InputError(
            f"{named('estimator')} gaussian needs features of a press, got "
            f"{','.join(problem.quantities)}"
        )
    curve, absolute = (
        np.array([k for name in names for k in blocks[name]], dtype=np.intp)
        for names in _partners(problem.quantities)
    )
    return curve, absolute


def standardized(X: Real) -> Scaling:
    """Scaling of features to zero mean and unit variance."""
    from sklearn.preprocessing import StandardScaler

    scaler: Any = StandardScaler().fit(X)
    return Scaling(scaler.mean_, scaler.scale_)


def on_one_scale(problem: LocalizationProblem, X: Real) -> tuple[tuple[Scaling, ...], Real]:
    """Scaling to unit variance if quantities have unequal errors, and the scaled features.

    Rs and Cp are such quantities: in their own units, Rs would leave nothing of Cp in components or
    in distances.
    """
    if not any(name in READ for name in problem.quantities):
        return (), X
    scaling = standardized(X)
    return (scaling,), scaling(X)


def leading_components(X: Real, count: int = COMPONENTS) -> Components:
    """The leading principal components, all divided by one number: their variances sum to 1.

    Features of equal errors, such as ln |Z| and phase, keep equal errors in all components; scaling
    each feature on its own would raise the noise of those that a press hardly changes. count:
    maximum number of components.
    """
    from sklearn.decomposition import PCA

    pca: Any = PCA(min(count, *X.shape), svd_solver="auto").fit(X)
    scale = float(np.sqrt(pca.explained_variance_.sum())) or 1.0
    return Components(pca.mean_, pca.components_, scale)


def coded_svms(X: Real, y: NDArray, **parameters: Any) -> tuple[NDArray, PairwiseSVMs]:
    """Classes, and the SVMs of all pairs of them, decoded by their hinge losses.

    A coding matrix M (class, learner) holds +1, -1 or 0: learner j separates the class of +1 from
    that of -1, without the classes of 0. A sweep goes to the class whose row of M agrees best with
    the learners' scores: E. L. Allwein, R. E. Schapire, Y. Singer, "Reducing multiclass to binary",
    J. Mach. Learn. Res. 1 (2000) 113-141.

    One fit to all classes trains the learners: libsvm solves the pairs of many classes one by one,
    each by its own samples alone. Classes are numbered backwards: of each pair, libsvm then takes
    the same for its first as it does of the sides -1 and +1. Source: C.-C. Chang, C.-J. Lin,
    "LIBSVM", ACM Trans. Intell. Syst. Technol. 2 (2011) 27, section 4.

    parameters: those of `SVC`. Raises ValueError for one class.
    """
    classes, index = np.unique(y, return_inverse=True)
    machine = _fitted_svc(X, -index, **parameters)
    backwards = [*reversed(range(classes.size))]
    return class_names(classes), _pairwise(machine, backwards, "hinge loss")


def separating_svm(X: Real, second: NDArray[np.bool_], **parameters: Any) -> KernelSum:
    """The decision of an SVM of two classes, positive for the second one; parameters of `SVC`."""
    machine = _fitted_svc(X, second, **parameters)
    weights = np.ascontiguousarray(machine.dual_coef_.T)
    return KernelSum(machine.support_vectors_, float(machine._gamma), weights, machine.intercept_)


def class_names(classes: NDArray) -> NDArray:
    """Classes as numbers or text."""
    return classes.astype(str) if classes.dtype.kind == "O" else classes


def _fitted_svc(X: Real, y: NDArray, **parameters: Any) -> Any:
    from sklearn.svm import SVC

    machine: Any = SVC(kernel="rbf", **parameters)
    return machine.fit(X, y)


def _pairwise(machine: Any, numbers: Sequence[int], decoding: Decoding) -> PairwiseSVMs:
    """The SVMs of all pairs of one SVC. numbers: our numbers of its classes."""
    K = len(numbers)
    sign = -1.0 if K == 2 else 1.0  # scikit-learn turns the sign of two classes
    dual, intercept = sign * machine.dual_coef_, sign * machine.intercept_
    ends = np.cumsum([0, *machine.n_support_])
    coefficients, offset = np.zeros((ends[-1], K)), np.zeros((K, K))
    for pair, (a, b) in enumerate(combinations(range(K), 2)):
        of_a, of_b = slice(ends[a], ends[a + 1]), slice(ends[b], ends[b + 1])
        coefficients[of_a, numbers[b]] = dual[b - 1, of_a]
        coefficients[of_b, numbers[a]] = -dual[a, of_b]
        offset[numbers[a], numbers[b]] = intercept[pair]
        offset[numbers[b], numbers[a]] = -intercept[pair]
    group = np.repeat(numbers, machine.n_support_)
    order = np.argsort(group, kind="stable")
    counts = np.bincount(group, minlength=K)
    vectors = machine.support_vectors_[order]
    gamma = float(machine._gamma)
    return PairwiseSVMs(vectors, gamma, counts, coefficients[order], offset, decoding)


def _partners(quantities: Sequence[str]) -> tuple[list[str], list[str]]:
    """Quantities of the baseline and of the sweep as read, in the order of the changes.

    The second list is empty unless each change comes with both, and there are no other quantities.
    """
    changes = [name for name in quantities if name in RELATIVE]
    curve = [BASELINE[RELATIVE.index(name)] for name in changes]
    absolute = [ABSOLUTE[RELATIVE.index(name)] for name in changes]
    if set(quantities) == {*changes, *curve, *absolute}:
        return curve, absolute
    if set(quantities) == {*changes, *curve}:
        return curve, []
    return [name for name in quantities if name in BASELINE], []
