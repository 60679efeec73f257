import numpy as np
import pytest
from rcskin.localization.inputs.features import features
from rcskin.localization.inputs.targets import labels
from rcskin.localization.learners.classifiers import CLASSIFIERS, KERNEL_WIDTH, REFERENCE, pipeline
from rcskin.localization.learners.ecoc import ECOCClassifier
from rcskin.simulator.sweeps import InputError


@pytest.mark.parametrize("name", CLASSIFIERS)
def test_each_classifier_tells_the_columns_of_a_strip_apart(strip, make_sweeps, name):
    unseen = make_sweeps(seed=1)
    X = features(strip)
    fitted = pipeline(name, features=X.shape[1]).fit(X, labels(strip))
    np.testing.assert_array_equal(fitted.predict(features(unseen)), labels(unseen))


@pytest.mark.parametrize("name", CLASSIFIERS)
def test_units_do_not_matter(strip, name):
    X, y = features(strip), labels(strip)
    units = np.geomspace(1e-12, 1e6, X.shape[1])
    one, other = (pipeline(name, features=X.shape[1]) for _ in range(2))
    predicted = other.fit(X * units, y).predict(X * units)
    np.testing.assert_array_equal(predicted, one.fit(X, y).predict(X))


def test_the_reference_is_one_versus_one_with_an_rbf_kernel():
    classifier = pipeline(REFERENCE, features=40, C=3.0)[-1]
    assert isinstance(classifier, ECOCClassifier)
    assert classifier.coding == "one-versus-one"
    svc = classifier.estimator
    assert (svc.kernel, svc.C, svc.gamma) == ("rbf", 3.0, KERNEL_WIDTH / 40)


def test_an_unknown_name_is_refused_with_those_there_are():
    with pytest.raises(InputError, match="ksvm-ovo, ksvm-ova, ksvm-ordinal, svc, got 'knn'"):
        pipeline("knn", features=40)
