"""Probabilities and thresholds."""

import numpy as np
import pytest
from rcskin.localization.inputs.samples import draw_stratified
from rcskin.localization.trust.answers import CANNOT_TELL, decide, threshold_of
from rcskin.localization.trust.temperature import calibration_error, probabilities, sharpness_of
from rcskin.simulator.sweeps import InputError


@pytest.fixture
def overconfident():
    """Decisions four times too sharp for how often they are right, and the true classes."""
    random = np.random.default_rng(0)
    honest = 2.5 * random.standard_normal((4000, 5))
    chance = probabilities(honest, 1.0).cumsum(axis=1)
    index = (random.random((4000, 1)) > chance).sum(axis=1).clip(max=4)
    return 4 * honest, index


def test_probabilities_become_honest(overconfident):
    decisions, index = overconfident
    half = slice(2000), slice(2000, None)
    sharpness = sharpness_of(decisions[half[0]], index[half[0]])
    assert sharpness == pytest.approx(0.25, rel=0.1)
    right = decisions[half[1]].argmax(axis=1) == index[half[1]]
    raw, honest = (
        calibration_error(probabilities(decisions[half[1]], each).max(axis=1), right)
        for each in (1.0, sharpness)
    )
    assert honest < 0.03 < 0.2 < raw


def test_answers_above_the_threshold_are_right_at_the_rate_asked(overconfident):
    decisions, index = overconfident
    p = probabilities(decisions, 0.25)
    right = p.argmax(axis=1) == index
    threshold = threshold_of(p.max(axis=1)[:2000], right[:2000], 0.9)
    told = p.max(axis=1)[2000:] >= threshold
    assert 0.05 < told.mean() < 0.9
    assert right[2000:][told].mean() > 0.87 > right.mean()


@pytest.mark.parametrize(
    ("certain", "message"), [(1.0, "between 0 and 1"), (0.99, "cannot be reached")]
)
def test_a_rate_that_cannot_be_kept_is_refused(certain, message):
    with pytest.raises(InputError, match=message):
        threshold_of(np.linspace(0.5, 0.6, 10), np.arange(10) % 2 == 0, certain)


def test_no_answer_where_it_is_improbable_or_novel():
    p = np.array([[0.9, 0.1], [0.6, 0.4], [0.1, 0.9]])
    told = decide(np.array(["1,1", "1,2"]), p, np.array([False, False, True]), 0.8)
    assert told.labels.tolist() == ["1,1", CANNOT_TELL, CANNOT_TELL]
    assert told.probability.tolist() == [0.9, 0.6, 0.9]


def test_a_rate_asked_is_kept_with_confidence_not_by_luck():
    """A classifier that is right at 94.5 % wherever it is asked must not be said to keep 95 %."""
    random, lucky = np.random.default_rng(2), 0
    for _ in range(60):
        p, right = random.random(300), random.random(300) < 0.945
        try:
            threshold_of(p, right, 0.95)
            lucky += 1
        except InputError:
            pass
    assert lucky <= 5


def test_sweeps_are_thinned_in_like_shares_whatever_their_order():
    """52 000 sweeps of 26 classes in turn, of which evenly spaced ones miss one."""
    groups = np.arange(5200) % 26
    kept = draw_stratified(groups, 2000)
    counts = np.bincount(groups[kept], minlength=26)
    assert kept.size == 2000 and np.ptp(counts) <= 1
    np.testing.assert_array_equal(kept, draw_stratified(groups, 2000))
    assert 5200 in draw_stratified(np.append(groups, 99), 2000)
