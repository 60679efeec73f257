import numpy as np
from rcskin.localization.inputs.features import features
from rcskin.localization.inputs.targets import labels
from rcskin.localization.learners.classifiers import KERNEL_WIDTH, reference
from rcskin.localization.learners.ecoc import ECOCClassifier


def test_the_reference_distinguishes_the_columns_of_a_strip(strip, make_sweeps):
    unseen = make_sweeps(seed=1)
    X = features(strip)
    fitted = reference(X.shape[1]).fit(X, labels(strip))
    np.testing.assert_array_equal(fitted.predict(features(unseen)), labels(unseen))


def test_units_do_not_matter(strip):
    X, y = features(strip), labels(strip)
    units = np.geomspace(1e-12, 1e6, X.shape[1])
    one, other = (reference(X.shape[1]) for _ in range(2))
    predicted = other.fit(X * units, y).predict(X * units)
    np.testing.assert_array_equal(predicted, one.fit(X, y).predict(X))


def test_the_reference_is_one_versus_one_with_an_rbf_kernel():
    classifier = reference(40, C=3.0)[-1]
    assert isinstance(classifier, ECOCClassifier)
    svc = classifier.estimator
    assert (svc.kernel, svc.C, svc.gamma) == ("rbf", 3.0, KERNEL_WIDTH / 40)
