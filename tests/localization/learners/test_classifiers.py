"""

SVMs of all pairs of classes, decoded by their hinge losses. What learns from Rs and Cp looks at
both, whatever their units. Coefficients of classes that have something in common are found closer
together than alone. ClassDensity densities: the best answers there are where classes are so, of
skins that differ.
"""

from functools import partial

import numpy as np
import pytest
import rcskin
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from rcskin.localization.inputs.features import features
from rcskin.localization.inputs.samples import LocalizationProblem, samples_of
from rcskin.localization.inputs.targets import labels
from rcskin.localization.learners.classifiers import (
    KERNEL_WIDTH,
    coded_svms,
    components_svm,
    leading_components,
    reference,
)
from rcskin.localization.learners.gaussians import DRIFT, fitted, shared
from rcskin.localization.learners.registry import learners
from rcskin.localization.parts.parts import PairwiseSVMs
from scipy.special import expit
from scipy.stats import norm
from sklearn.datasets import make_blobs
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


OHM, FARAD = 1e5, 1e-10
QUICK = tuple(name for name in learners() if name != "network")


@pytest.mark.parametrize("name", QUICK)
def test_what_only_the_capacitance_shows_is_learned(name):
    made, random = learners()[name], np.random.default_rng(0)
    target = "position" if "position" in made.targets else "column"
    told, other = np.repeat([1.0, 2.0], 60), random.normal(size=(120, 3))
    Cp = told[:, None] + 0.1 * random.normal(size=(120, 3))
    X = np.hstack([OHM * (1 + 0.1 * other), FARAD * Cp])
    answers = np.stack([told, told, told], axis=1) if target == "position" else told.astype(int)
    problem = LocalizationProblem(target, 6, ("Rs", "Cp"), ("left",), (1e3, 1e4, 1e5), "")
    found = made.fit(problem, X[::2], answers[::2]).predict(X[1::2])
    assert (np.abs(found - answers[1::2]) < 0.5).mean() > 0.95


CLASSES, TERMS, NUMBERS, RANK = 30, 8, 10, 3


def seen(random, size):
    """True coefficients of few common ways, and estimates that err as `errors` and `noise` say."""
    true = random.standard_normal((CLASSES, RANK)) @ random.standard_normal((RANK, TERMS * NUMBERS))
    true = size * true.reshape(CLASSES, TERMS, NUMBERS)
    errors = random.uniform(0.1, 2.0, TERMS)
    turn = np.eye(NUMBERS) + 0.5 * random.standard_normal((NUMBERS, NUMBERS))
    noise = random.standard_normal(true.shape) @ turn.T * np.sqrt(errors)[:, None]
    return true, true + noise, errors, turn @ turn.T


def test_what_is_shared_errs_less_by_far():
    true, estimates, errors, noise = seen(np.random.default_rng(1), 1.0)
    alone = np.square(estimates - true).sum()
    assert np.square(shared(estimates, errors, noise) - true).sum() < 0.4 * alone


def test_noise_alone_is_nothing():
    _, estimates, errors, noise = seen(np.random.default_rng(2), 0.0)
    found = shared(estimates, errors, noise)
    assert np.square(found).sum() < 0.1 * np.square(estimates).sum()


def test_what_is_known_well_stays():
    _, estimates, errors, noise = seen(np.random.default_rng(3), 1.0)
    assert shared(estimates, 1e-8 * errors, noise) == pytest.approx(estimates, abs=1e-3)


SWEEPS = 6000
FEATURES = ("dlnZ", "dphase", "lnZ0", "phase0")


def drawn_labels(random):
    return random.integers(0, 2, SWEEPS)


def densities(X, y, curve=(), drift=DRIFT):
    return fitted(X, y, np.array(curve, dtype=np.intp), np.arange(0), drift=drift)


def share_right(X, y, **more):
    half = SWEEPS // 2
    model = densities(X[:half], y[:half], **more)
    return (model(X[half:]).argmax(axis=1) == y[half:]).mean()


def test_it_is_as_right_as_the_best_answers_to_normal_classes():
    random = np.random.default_rng(1)
    y, turn = drawn_labels(random), np.linalg.qr(random.standard_normal((6, 6)))[0]
    X = random.standard_normal((SWEEPS, 6))
    X[:, 0] += 2.0 * y
    best = norm.cdf(1.0)
    assert share_right(X @ turn, y) == pytest.approx(best, abs=0.02)


def test_the_curve_at_rest_shows_how_far_a_touch_moves_each_skin():
    random = np.random.default_rng(2)
    y, skin = drawn_labels(random), random.standard_normal((SWEEPS, 1))
    far = 5 + 0.4 * y[:, None] + skin + 0.5 * skin**2
    X = 0.1 * random.standard_normal((SWEEPS, 3)) + far * np.array([[1.0, 0.0, 2.0]])
    known = np.hstack([X, skin @ np.array([[1.0, -1.0]])])
    assert share_right(X, y) < 0.7
    assert share_right(known, y, curve=(3, 4)) > 0.95


def test_strengths_of_touches_drop_out_with_how_they_bend():
    random = np.random.default_rng(3)
    y, t = drawn_labels(random), 1 + 0.3 * random.standard_normal(SWEEPS)
    ways = np.where(y[:, None], [[10.0, 1.0, 0.0, 0.0]], [[10.0, 0.0, 0.0, 0.0]])
    bends = 6 * np.square(t - 1)[:, None] * [[0.0, 0.0, 1.0, 0.0]]
    X = t[:, None] * ways + bends + 0.15 * random.standard_normal((SWEEPS, 4))
    assert share_right(X, y) > 0.99


def test_touches_from_weak_to_strong_are_split_by_their_strength():
    drawn = {
        "dataset.press": {"touches": [0.1, 0.9], "factor": {"low": 1.3, "high": 4.5}},
        "dataset.session": {"sweeps_per_session": 28, "rest_every": 14},
    }
    scene = rcskin.load("sheet-5x5").with_(drawn)
    known, asked = (
        samples_of(rcskin.dataset(scene, 1500, seed=seed, rtol=1e-3), "column", FEATURES)
        for seed in (1, 2)
    )
    curve = np.concatenate([known.problem.blocks[name] for name in ("lnZ0", "phase0")])

    def found(strengths):
        model = fitted(known.X, known.y, curve, np.arange(0), strengths=strengths)
        return (model(asked.X).argmax(axis=1) == asked.y).mean()

    assert found(3) > max(0.93, found(1) + 0.05)


def test_probabilities_are_those_of_the_densities():
    random = np.random.default_rng(4)
    y = drawn_labels(random)
    X = random.standard_normal((SWEEPS, 2)) + 1.5 * y[:, None]
    told = expit(np.diff(densities(X, y)(X))[:, 0])
    exact = 1 / (1 + np.exp(-1.5 * (X.sum(axis=1) - 1.5)))
    assert np.abs(told - exact).mean() < 0.02


def test_drift_of_a_skin_shows_nothing_of_the_touch():
    random = np.random.default_rng(5)
    y, skin = drawn_labels(random), random.standard_normal((SWEEPS, 1))
    way, noise = np.array([[1.0, 1.0]]), 0.002
    touch = 0.02 * np.where(y[:, None], [[1.0, 0.0]], [[0.0, 1.0]])
    X = np.hstack([touch + noise * random.standard_normal((SWEEPS, 2)), skin * way])
    drifted = X + 0.03 * random.standard_normal((SWEEPS, 1)) * np.array([[1.0, 1.0, 0.0, 0.0]])
    model = densities(X, y, curve=(2, 3), drift=0.03)
    assert (model(drifted).argmax(axis=1) == y).mean() > 0.99
