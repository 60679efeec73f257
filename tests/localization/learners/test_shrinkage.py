"""Coefficients of classes that have something in common are found closer together than alone."""

import numpy as np
import pytest
from rcskin.localization.learners.gaussians import shared

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
