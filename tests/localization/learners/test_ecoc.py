import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from rcskin.localization.learners.ecoc import ECOCClassifier, average_loss, one_versus_one
from sklearn.base import clone
from sklearn.datasets import make_blobs
from sklearn.svm import SVC
from sklearn.utils.estimator_checks import parametrize_with_checks

CORNERS = [[0, 0], [10, 0], [0, 10], [10, 10]]
EXACT = SVC(tol=1e-10)
"""Solved far enough that the two classes can change sides without a trace."""


@parametrize_with_checks([ECOCClassifier()])
def test_it_keeps_the_conventions_of_scikit_learn(estimator, check):
    check(estimator)


# Coding matrices


@pytest.mark.parametrize("K", range(2, 8))
def test_one_versus_one_sets_each_pair_of_classes_against_each_other(K):
    codes = one_versus_one(K)
    assert codes.shape == (K, K * (K - 1) // 2)
    assert (codes.sum(axis=0) == 0).all()
    assert (np.abs(codes).sum(axis=0) == 2).all()
    assert (np.abs(codes).sum(axis=1) == K - 1).all()
    assert len(np.unique(np.abs(codes), axis=1).T) == codes.shape[1]


def test_coding_matrix_of_three_classes():
    assert one_versus_one(3).tolist() == [[1, 1, 0], [-1, 0, 1], [0, -1, -1]]


@pytest.mark.parametrize("K", range(2, 8))
def test_no_two_classes_share_a_code(K):
    assert len(np.unique(one_versus_one(K), axis=0)) == K


# Decoding


def slow_average_loss(codes, scores):
    """The definition of loss-weighted decoding, a class and a learner at a time."""
    losses = []
    for sample in scores:
        for code in codes:
            loss = sum(abs(m) * max(0, 1 - m * s) / 2 for m, s in zip(code, sample, strict=True))
            losses.append(loss / sum(abs(m) for m in code))
    return np.reshape(losses, (len(scores), len(codes)))


@st.composite
def codes_and_scores(draw):
    K, L, n = draw(st.integers(2, 5)), draw(st.integers(1, 6)), draw(st.integers(1, 4))
    codes = draw(
        arrays(np.int64, (K, L), elements=st.integers(-1, 1)).filter(
            lambda codes: np.abs(codes).sum(axis=1).all()
        )
    )
    return codes, draw(arrays(float, (n, L), elements=st.floats(-1e3, 1e3)))


@given(codes_and_scores())
def test_decoding_agrees_with_its_definition(drawn):
    codes, scores = drawn
    loss = average_loss(codes, scores)
    np.testing.assert_allclose(loss, slow_average_loss(codes, scores), rtol=1e-12, atol=1e-12)
    assert (loss >= 0).all()


@given(codes_and_scores(), st.randoms(use_true_random=False))
def test_turning_a_learner_around_or_renumbering_classes_and_learners_changes_nothing(
    drawn, random
):
    codes, scores = drawn
    classes, learners = list(range(codes.shape[0])), list(range(codes.shape[1]))
    random.shuffle(classes)
    random.shuffle(learners)
    sides = np.array([random.choice([-1, 1]) for _ in learners])
    other = average_loss((codes * sides)[classes][:, learners], (scores * sides)[:, learners])
    np.testing.assert_allclose(
        other, average_loss(codes, scores)[:, classes], rtol=1e-12, atol=1e-12
    )


def test_scores_beyond_the_margin_on_the_side_of_a_code_cost_its_class_nothing():
    codes = one_versus_one(5)
    loss = average_loss(codes, 1.5 * codes)
    np.testing.assert_array_equal(np.diag(loss), 0)
    assert (loss[~np.eye(5, dtype=bool)] > 0).all()


def test_a_learner_without_an_opinion_costs_each_side_half():
    np.testing.assert_array_equal(average_loss(one_versus_one(3), np.zeros((1, 3))), 0.5)


# The classifier


def clusters(centers, seed=0, spread=0.5):
    return make_blobs(
        n_samples=15 * len(centers), centers=centers, cluster_std=spread, random_state=seed
    )


@pytest.mark.parametrize("K", [2, 3, 4])
def test_ties_go_to_the_lowest_class(K):
    codes = one_versus_one(K)
    model = ECOCClassifier().fit(*clusters(CORNERS[:K]))
    model._scores = lambda X: np.zeros((len(X), codes.shape[1]))
    assert (model.predict(np.zeros((3, 2))) == 0).all()


@pytest.mark.parametrize(
    "estimator", [None, SVC(C=100), SVC(gamma="auto", class_weight="balanced")]
)
def test_well_separated_clusters_are_distinguished(estimator):
    X, y = clusters(CORNERS)
    model = ECOCClassifier(estimator).fit(X, y)
    assert (model.predict(X) == y).all()
    assert model.decision_function(X).shape == (len(X), 4)
    np.testing.assert_array_equal(model.decision_function(X).argmax(axis=1), y)


def test_each_learner_sees_only_the_classes_it_distinguishes():
    X, y = clusters(CORNERS)
    pair = (y == 1) | (y == 3)
    exact = clone(EXACT).set_params(gamma=0.1)
    model, alone = ECOCClassifier(exact).fit(X, y), clone(exact).fit(X[pair], y[pair])
    score = model._scores(X)[:, model.coding_matrix_.T.tolist().index([0, 1, 0, -1])]
    np.testing.assert_allclose(score, -alone.decision_function(X), rtol=1e-6, atol=1e-9)


def one_by_one(model, X, y):
    """Scores of a learner for each column of the coding matrix, trained alone."""
    scores = []
    for code in model.coding_matrix_.T:
        sides = code[np.searchsorted(model.classes_, y)]
        learner = clone(model.estimator).fit(X[sides != 0], sides[sides != 0])
        scores.append(learner.decision_function(X))
    return np.column_stack(scores)


@pytest.mark.parametrize("kernel", ["rbf", "linear", "poly", "sigmoid"])
@pytest.mark.parametrize("K", [3, 4, 7])
def test_one_fit_holds_the_learners_of_all_pairs_to_the_same_bits(kernel, K):
    X, y = make_blobs(20 * K, 30, centers=K, cluster_std=8.0, random_state=K)
    model = ECOCClassifier(SVC(kernel=kernel, C=100.0, gamma=0.003)).fit(X, y)
    alone = one_by_one(model, X, y)
    assert len(model.estimators_) == 1
    np.testing.assert_array_equal(
        model.decision_function(X), -average_loss(model.coding_matrix_, alone)
    )


def test_a_model_that_keeps_its_pairs_one_by_one_answers_alike():
    """As those written to disk before pairs were fitted together."""
    X, y = clusters(CORNERS, spread=4.0)
    together, apart = (ECOCClassifier(SVC(gamma=0.1)).fit(X, y) for _ in range(2))
    apart.estimators_ = [
        clone(apart.estimator).fit(X[code[y] != 0], code[y][code[y] != 0])
        for code in apart.coding_matrix_.T
    ]
    np.testing.assert_array_equal(apart.decision_function(X), together.decision_function(X))


def test_two_classes_are_distinguished_as_by_the_binary_learner_alone():
    X, y = clusters([[0, 0], [1, 1]], spread=1.0)
    model, alone = ECOCClassifier(EXACT).fit(X, y), clone(EXACT).fit(X, y)
    score, margin = alone.decision_function(X), model.decision_function(X)
    np.testing.assert_array_equal(model.predict(X), alone.predict(X))
    inside = np.abs(score) <= 1
    np.testing.assert_allclose(margin[inside], score[inside], rtol=1e-6, atol=1e-9)
    np.testing.assert_array_equal(np.sign(margin), np.sign(score))


@settings(deadline=None, max_examples=20)
@given(st.permutations(["a", "b", "c", "d"]))
def test_renaming_the_classes_renames_the_answers(names):
    X, y = clusters(CORNERS, spread=0.3)
    renamed = np.array(names)[y]
    answers = ECOCClassifier().fit(X, renamed).predict(X)
    plain = ECOCClassifier().fit(X, y).predict(X)
    np.testing.assert_array_equal(answers, np.array(names)[plain])
