"""Named classifiers: features brought to one scale, then a multi-class kernel SVM."""

from sklearn.pipeline import Pipeline
from sklearn.preprocessing import StandardScaler
from sklearn.svm import SVC

from localization.ecoc import ECOCClassifier
from simulator.sweeps import InputError

REFERENCE = "ksvm-ovo"
"""One-versus-one, the default of MATLAB's `fitcecoc`."""
CODING_OF = {
    REFERENCE: "one-versus-one",
    "ksvm-ova": "one-versus-all",
    "ksvm-ordinal": "ordinal",
}
CLASSIFIERS = (*CODING_OF, "svc")
"""The last is scikit-learn's own one-versus-one: it counts votes where the others weigh losses."""


def pipeline(name: str = REFERENCE, *, C: float = 10.0, gamma: float | str = "scale") -> Pipeline:
    """An untrained pipeline: features of zero mean and unit variance, then the named SVM.

    C: penalty of a sweep on the wrong side of a margin. Six presses of every pixel of a 5 x 5 skin
        with 0.3 % noise (a line of RC segments, rows alike) gave 84 % of columns right at C = 1 and
        90 % at each of 10, 100, 1000, 10000: from 10 on every learner separates its classes. With
        24 presses C = 1 gained a point or two at 1 % noise. The default is the least C that loses
        nothing where the classes can be separated.
    gamma: of the kernel exp(-gamma |x - x'|²), x without unit; "scale" is 1 / (number of features x
        their variance), over the classes that a binary learner sees.
    Raises InputError for an unknown name.
    """
    if name not in CLASSIFIERS:
        raise InputError(f"`classifier` must be one of {', '.join(CLASSIFIERS)}, got {name!r}")
    svc = SVC(kernel="rbf", C=C).set_params(gamma=gamma)
    classifier = ECOCClassifier(svc, CODING_OF[name]) if name in CODING_OF else svc
    return Pipeline([("scale", StandardScaler()), ("classify", classifier)])
