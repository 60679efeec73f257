"""Readings one after the other: together they tell what a whole sweep tells, the best first."""

import runpy
from pathlib import Path

import numpy as np
import pytest
from rcskin.localization.inversion.classifier import InversionPlan, ModelBased
from rcskin.localization.inversion.sequential_posterior import ClassPosterior

_rig = runpy.run_path(str(Path(__file__).with_name("test_classifier.py")))
builder, change, NOISE, REST = (_rig[name] for name in ("builder", "change", "NOISE", "REST"))
READINGS = _rig["NUMBERS"] // 2


@pytest.fixture(scope="module")
def localizer():
    plan = InversionPlan("", "column", rest_sweeps=REST, builder=builder)
    return ModelBased.fitted(plan)


def sweep(column, seed=0):
    noise = NOISE * np.random.default_rng(seed).standard_normal(2 * READINGS)
    return (change(1, column, 2.0) if column else 0.0) + noise


def told(localizer, x, order):
    inquiry = ClassPosterior(localizer)
    for k in order:
        inquiry.update(k, x[[k, k + READINGS]])
    return inquiry


@pytest.mark.parametrize("column", [0, 1, 3])
def test_readings_in_any_order_give_what_their_mixture_gives(localizer, column):
    x = sweep(column)
    for order in ([4, 0, 2], list(range(READINGS)), list(range(READINGS))[::-1]):
        numbers = tuple(sorted([*order, *(k + READINGS for k in order)]))
        some = None if len(order) == READINGS else numbers
        np.testing.assert_allclose(
            told(localizer, x, order).log_densities,
            localizer.log_densities(x[None], some)[0],
            rtol=1e-9,
            atol=1e-6,
        )
    whole = told(localizer, x, range(READINGS))
    np.testing.assert_allclose(
        whole.probabilities, localizer.probabilities(x[None])[0], rtol=1e-6, atol=1e-12
    )


def test_gains_are_the_information_that_readings_give(localizer):
    """Against the mean fall of entropy over many sweeps drawn from the same tables."""
    inquiry = told(localizer, sweep(2), [])
    gains = inquiry.gains(np.arange(READINGS))
    random = np.random.default_rng(1)
    mixture, _ = localizer.part(None)
    entries = random.choice(len(mixture.mean), 1500, p=np.exp(mixture.log_chance))
    hidden = random.standard_normal((1500, mixture.spread.shape[2]))
    X = mixture.mean[entries] + np.einsum("enr,er->en", mixture.spread[entries], hidden)
    X = (X + random.standard_normal(X.shape)) * localizer.noise
    before = -(inquiry.probabilities * np.log(inquiry.probabilities)).sum()
    fallen = []
    for k in range(READINGS):
        joint = localizer.log_densities(X, (k, k + READINGS))[:, :-1] + np.log(
            inquiry.probabilities
        )
        after = np.exp(joint - joint.max(axis=1, keepdims=True))
        after /= after.sum(axis=1, keepdims=True)
        fallen.append(before + np.mean((after * np.log(after + 1e-300)).sum(axis=1)))
    np.testing.assert_allclose(gains, fallen, atol=0.12)
    assert fallen[gains.argmax()] > max(fallen) - 0.05


def test_a_prior_counts_as_it_should_and_gains_are_the_same_at_every_call(localizer):
    prior = np.log([0.97, 0.01, 0.01, 0.01])
    inquiry = ClassPosterior(localizer, prior)
    np.testing.assert_allclose(inquiry.probabilities, np.exp(prior))
    again = ClassPosterior(localizer, prior).gains(np.arange(READINGS))
    np.testing.assert_array_equal(inquiry.gains(np.arange(READINGS)), again)


def test_readings_like_no_touch_are_novel(localizer):
    x = sweep(1)
    assert not told(localizer, x, range(READINGS)).novel
    assert told(localizer, x + 0.1 * (-1.0) ** np.arange(2 * READINGS), range(READINGS)).novel
