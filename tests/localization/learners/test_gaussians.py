"""ClassDensity densities: the best answers there are where classes are so, of skins that differ."""

import numpy as np
import pytest
import rcskin
from rcskin.localization.inputs.samples import samples_of
from rcskin.localization.learners.gaussians import DRIFT, fitted
from scipy.special import expit
from scipy.stats import norm

SWEEPS = 6000
FEATURES = ("dlnZ", "dphase", "lnZ0", "phase0")


def labels(random):
    return random.integers(0, 2, SWEEPS)


def densities(X, y, curve=(), drift=DRIFT):
    return fitted(X, y, np.array(curve, dtype=np.intp), np.arange(0), drift=drift)


def share_right(X, y, **more):
    half = SWEEPS // 2
    model = densities(X[:half], y[:half], **more)
    return (model(X[half:]).argmax(axis=1) == y[half:]).mean()


def test_it_is_as_right_as_the_best_answers_to_normal_classes():
    random = np.random.default_rng(1)
    y, turn = labels(random), np.linalg.qr(random.standard_normal((6, 6)))[0]
    X = random.standard_normal((SWEEPS, 6))
    X[:, 0] += 2.0 * y
    best = norm.cdf(1.0)
    assert share_right(X @ turn, y) == pytest.approx(best, abs=0.02)


def test_the_curve_at_rest_shows_how_far_a_touch_moves_each_skin():
    random = np.random.default_rng(2)
    y, skin = labels(random), random.standard_normal((SWEEPS, 1))
    far = 5 + 0.4 * y[:, None] + skin + 0.5 * skin**2
    X = 0.1 * random.standard_normal((SWEEPS, 3)) + far * np.array([[1.0, 0.0, 2.0]])
    known = np.hstack([X, skin @ np.array([[1.0, -1.0]])])
    assert share_right(X, y) < 0.7
    assert share_right(known, y, curve=(3, 4)) > 0.95


def test_strengths_of_touches_drop_out_with_how_they_bend():
    random = np.random.default_rng(3)
    y, t = labels(random), 1 + 0.3 * random.standard_normal(SWEEPS)
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
    y = labels(random)
    X = random.standard_normal((SWEEPS, 2)) + 1.5 * y[:, None]
    told = expit(np.diff(densities(X, y)(X))[:, 0])
    exact = 1 / (1 + np.exp(-1.5 * (X.sum(axis=1) - 1.5)))
    assert np.abs(told - exact).mean() < 0.02


def test_drift_of_a_skin_shows_nothing_of_the_touch():
    random = np.random.default_rng(5)
    y, skin = labels(random), random.standard_normal((SWEEPS, 1))
    way, noise = np.array([[1.0, 1.0]]), 0.002
    touch = 0.02 * np.where(y[:, None], [[1.0, 0.0]], [[0.0, 1.0]])
    X = np.hstack([touch + noise * random.standard_normal((SWEEPS, 2)), skin * way])
    drifted = X + 0.03 * random.standard_normal((SWEEPS, 1)) * np.array([[1.0, 1.0, 0.0, 0.0]])
    model = densities(X, y, curve=(2, 3), drift=0.03)
    assert (model(drifted).argmax(axis=1) == y).mean() > 0.99
