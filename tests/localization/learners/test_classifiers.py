import numpy as np
import pytest
from rcskin.localization.inputs.features import features
from rcskin.localization.inputs.samples import LocalizationProblem
from rcskin.localization.inputs.targets import labels
from rcskin.localization.learners.classifiers import (
    KERNEL_WIDTH,
    components_svm,
    leading_components,
    reference,
)
from sklearn.decomposition import PCA
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler
from sklearn.svm import SVC


def test_the_reference_distinguishes_the_columns_of_a_strip(strip, make_sweeps):
    unseen = make_sweeps(seed=1)
    fitted = reference(features(strip), labels(strip))
    np.testing.assert_array_equal(fitted.predict(features(unseen)), labels(unseen))


def test_units_do_not_matter(strip):
    X, y = features(strip), labels(strip)
    units = np.geomspace(1e-12, 1e6, X.shape[1])
    predicted = reference(X * units, y).predict(X * units)
    np.testing.assert_array_equal(predicted, reference(X, y).predict(X))


def test_the_reference_has_an_rbf_kernel_of_its_width(strip):
    X, y = features(strip), labels(strip)
    assert reference(X, y).parts[-1].gamma == KERNEL_WIDTH / X.shape[1]
    assert reference(X, y, gamma=2.0).parts[-1].gamma == 2.0


def test_components_vary_by_one_in_sum():
    X = np.random.default_rng(0).standard_normal((500, 4)) * [1, 10, 100, 1e-3]
    assert leading_components(X, 3)(X).var(axis=0, ddof=1).sum() == pytest.approx(1)


@pytest.mark.parametrize("classes", [2, 3, 5])
def test_parts_decide_as_the_svm_of_scikit_learn_that_they_are_made_of(classes):
    random = np.random.default_rng(classes)
    y = np.arange(200) % classes
    X = random.standard_normal((200, 6)) + np.eye(classes, 6)[y]
    problem = LocalizationProblem("column", 6, ("dlnZ", "dphase"), ("left",), (1e3, 1e4, 1e5), "")
    found = components_svm(problem, X, y, C=10.0)
    scale = np.sqrt(PCA(6).fit(X).explained_variance_.sum())
    svc = make_pipeline(PCA(6), SVC(C=10.0, gamma=0.1 / scale**2, break_ties=True)).fit(X, y)
    more = random.standard_normal((50, 6))
    decided = svc.decision_function(more)
    both = decided if classes > 2 else np.stack([-decided, decided], axis=1) / 2
    np.testing.assert_allclose(found.decisions(more), both, rtol=1e-3, atol=1e-3)
    np.testing.assert_array_equal(found.predict(X), svc.predict(X))


def test_scaling_is_that_of_scikit_learn_to_the_last_bit(strip):
    X, y = features(strip), labels(strip)
    np.testing.assert_array_equal(reference(X, y).parts[0](X), StandardScaler().fit_transform(X))
