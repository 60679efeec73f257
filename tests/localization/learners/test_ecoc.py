"""SVMs of all pairs of classes, decoded by their hinge losses."""

from functools import partial

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from rcskin.localization.learners.classifiers import coded_svms
from rcskin.localization.parts.parts import PairwiseSVMs
from sklearn.datasets import make_blobs
from sklearn.svm import SVC

CORNERS = [[0, 0], [10, 0], [0, 10], [10, 10]]
EXACT = {"C": 1.0, "tol": 1e-10}
"""Solved far enough that the two classes can change sides without a trace."""


def of_scores(S):
    """SVMs without vectors, whose scores are these for every sweep. S: (K, K), antisymmetric."""
    K = len(S)
    nothing = np.zeros((0, 1)), 1.0, np.zeros(K, dtype=np.intp), np.zeros((0, K))
    return PairwiseSVMs(*nothing, S, "hinge loss")


@st.composite
def antisymmetric(draw):
    K = draw(st.integers(2, 6))
    upper = np.triu(draw(arrays(float, (K, K), elements=st.floats(-1e3, 1e3))), 1)
    return upper - upper.T


def losses(S):
    """The definition of loss-weighted decoding, a class and a learner at a time; least is 0."""
    K = len(S)
    found = [sum(max(0, 1 - S[i, j]) / 2 for j in range(K) if j != i) / (K - 1) for i in range(K)]
    return np.array(found)


@given(antisymmetric())
def test_decoding_agrees_with_its_definition(S):
    decided = of_scores(S)(np.zeros((1, 1)))[0]
    expected = -losses(S)
    np.testing.assert_allclose(
        decided - decided.max(), expected - expected.max(), rtol=1e-12, atol=1e-11
    )


@given(antisymmetric(), st.randoms(use_true_random=False))
def test_renumbering_the_classes_renumbers_the_decisions(S, random):
    order = list(range(len(S)))
    random.shuffle(order)
    X = np.zeros((1, 1))
    other = of_scores(S[np.ix_(order, order)])(X)
    np.testing.assert_allclose(other, of_scores(S)(X)[:, order], rtol=1e-12, atol=1e-11)


@pytest.mark.parametrize("K", [2, 3, 4])
def test_ties_go_to_the_lowest_class(K):
    assert of_scores(np.zeros((K, K)))(np.zeros((3, 1))).argmax(axis=1).tolist() == [0, 0, 0]


def clusters(centers, seed=0, spread=0.5):
    return make_blobs(
        n_samples=15 * len(centers), centers=centers, cluster_std=spread, random_state=seed
    )


@pytest.mark.parametrize("options", [{}, {"C": 100}, {"gamma": 0.5, "class_weight": "balanced"}])
def test_well_separated_clusters_are_distinguished(options):
    X, y = clusters(CORNERS)
    classes, machines = coded_svms(X, y, **options)
    assert machines(X).shape == (len(X), 4)
    np.testing.assert_array_equal(classes[machines(X).argmax(axis=1)], y)


def test_each_learner_sees_only_the_classes_it_distinguishes():
    X, y = clusters(CORNERS)
    pair = (y == 1) | (y == 3)
    alone = SVC(gamma=0.1, **EXACT).fit(X[pair], y[pair])
    score = coded_svms(X, y, gamma=0.1, **EXACT)[1].scores(X)[:, 3, 1]
    np.testing.assert_allclose(score, alone.decision_function(X), rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("K", [3, 4, 7])
def test_one_fit_holds_the_learners_of_all_pairs(K):
    X, y = make_blobs(20 * K, 30, centers=K, cluster_std=8.0, random_state=K)
    svc = partial(SVC, C=100.0, gamma=0.003)
    scores = coded_svms(X, y, C=100.0, gamma=0.003)[1].scores(X)
    for i in range(K):
        for j in range(i + 1, K):
            pair = (y == i) | (y == j)
            alone = svc().fit(X[pair], np.where(y[pair] == i, 1, -1)).decision_function(X)
            np.testing.assert_allclose(scores[:, i, j], alone, rtol=1e-11, atol=1e-11)


def test_two_classes_are_distinguished_as_by_the_binary_learner_alone():
    X, y = clusters([[0, 0], [1, 1]], spread=1.0)
    classes, machines = coded_svms(X, y, gamma=0.5, **EXACT)
    alone = SVC(gamma=0.5, **EXACT).fit(X, y)
    score, margin = alone.decision_function(X), 2 * machines(X)[:, 1]
    np.testing.assert_array_equal(classes[(margin > 0).astype(int)], alone.predict(X))
    inside = np.abs(score) <= 1
    np.testing.assert_allclose(margin[inside], score[inside], rtol=1e-6, atol=1e-9)
    np.testing.assert_array_equal(np.sign(margin), np.sign(score))


@settings(deadline=None, max_examples=20)
@given(st.permutations(["a", "b", "c", "d"]))
def test_renaming_the_classes_renames_the_answers(names):
    X, y = clusters(CORNERS, spread=0.3)
    classes, machines = coded_svms(X, np.array(names)[y])
    plain, machine = coded_svms(X, y)
    np.testing.assert_array_equal(
        classes[machines(X).argmax(axis=1)], np.array(names)[plain[machine(X).argmax(axis=1)]]
    )
