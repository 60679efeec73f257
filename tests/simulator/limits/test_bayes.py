"""The best accuracy: its limits, a closed form, mirror images, and bounds above it."""

import numpy as np
import pytest
from rcskin.simulator.bounds.bayes import bayes
from rcskin.simulator.bounds.readings import Readings, hypotheses
from rcskin.simulator.limits import bayes_accuracy
from rcskin.simulator.limits.identity import Sampling, counts, distances, upper_bound, with_pixels
from rcskin.simulator.measure.experiment import own_presses, strengths
from rcskin.simulator.scene.randomisation import Uniform
from rcskin.simulator.sweeps import InputError
from scipy.special import ndtr

STRIP = {"length": 0.1, "width": 0.02, "frequencies": (1e3, 1e4)}


def noise(size):
    return {"magnitude_noise": size, "phase_noise": size}


def test_without_noise_everything_is_told_and_in_noise_nothing(noisy):
    clear = noisy(readout=noise(1e-4), columns=3, **STRIP)
    assert bayes_accuracy(clear, "column", draws=200)[0] == pytest.approx(1, abs=1e-6)
    lost = noisy(readout=noise(1e3), columns=3, **STRIP)
    assert bayes_accuracy(lost, "column", draws=200)[0] == pytest.approx(1 / 3, abs=1e-3)
    assert bayes_accuracy(lost, "pair", draws=200)[0] == pytest.approx(1 / 3, abs=1e-3)
    assert bayes_accuracy(lost, "touches", draws=200)[0] == pytest.approx(1 / 3, abs=1e-3)


def test_two_presses_of_known_strength_are_told_as_two_points_in_normal_noise(noisy):
    scene = noisy(readout=noise(0.03), spread=0.0, columns=2, **STRIP)
    presses, among = own_presses(scene), hypotheses(scene, "column")
    readings = Readings(scene, presses)
    apart = distances(readings, among, presses)[0, 1]
    exact = ndtr(apart / 2)
    found = bayes(readings, among, presses, seed=1, draws=4000)
    assert 0.6 < exact < 0.99
    assert found.share == pytest.approx(exact, abs=4 * found.error)
    assert upper_bound(readings, among, presses) == pytest.approx(exact, rel=1e-9)


def test_mirror_pixels_are_guessed_whatever_the_meter(noisy):
    scene = noisy(readout=noise(1e-3), rows=2, columns=2, frequencies=(1e3, 1e4))
    presses = own_presses(scene)
    readings = Readings(scene, presses)
    for target in ("row", "pixel"):
        among = hypotheses(scene, target)
        found = bayes(readings, among, presses, seed=1, draws=300)
        assert found.share == pytest.approx(0.5, abs=1e-3)
        assert upper_bound(readings, among, presses) == pytest.approx(0.5, abs=1e-3)
    assert bayes_accuracy(scene, "column", draws=300)[0] > 0.99


def test_the_pairwise_bound_is_one(noisy):
    scene = noisy(readout=noise(0.02), spread=0.2, columns=4, **STRIP)
    presses = own_presses(scene)
    readings, among = Readings(scene, presses), hypotheses(scene, "column")
    found = bayes(readings, among, presses, seed=1, draws=2000)
    assert 0.3 < found.share - 4 * found.error <= upper_bound(readings, among, presses) < 1


def test_finer_steps_of_strength_change_nothing(noisy, monkeypatch):
    scene = noisy(readout=noise(0.01), spread=0.2, columns=3, **STRIP)
    coarse = bayes_accuracy(scene, "pair", draws=300)
    monkeypatch.setattr("rcskin.simulator.bounds.bayes.STEP", 0.5)
    assert bayes_accuracy(scene, "pair", draws=300)[0] == pytest.approx(coarse[0], abs=3e-4)


def test_the_same_seed_gives_the_same_bits_and_the_skin_at_rest_can_be_a_class(noisy):
    scene = noisy(readout=noise(0.02), columns=3, unpressed=True, **STRIP)
    assert bayes_accuracy(scene, seed=4, draws=100) == bayes_accuracy(scene, seed=4, draws=100)
    assert [each.answer for each in hypotheses(scene, "column")] == [(0,), (1,), (2,), (3,)]
    assert [each.answer for each in hypotheses(scene, "pixel")][:2] == [(0, 0), (1, 1)]


def test_noise_that_is_too_small_is_refused(noisy):
    scene = noisy(readout=noise(1e-9), columns=3, **STRIP)
    with pytest.raises(InputError, match="too small"):
        bayes_accuracy(scene, "column", draws=10)


def test_strengths_have_the_distributions_moments():
    found = strengths(Uniform(low=1.0, high=3.0), 50)
    assert found.weight.sum() == pytest.approx(1)
    assert found.weight @ found.factor == pytest.approx(2)
    assert found.weight @ (found.factor - 2) ** 2 == pytest.approx(1 / 3, rel=1e-3)


def test_pixels_are_counted_until_they_are_not_told(noisy):
    scene = noisy(readout=noise(0.01), columns=3, **STRIP)
    found = list(counts(scene, "column", 0.9, Sampling(seed=1, draws=300)))
    assert [each.n for each in found] == list(range(2, 2 + len(found)))
    assert all(each.reaches(0.9) for each in found[:-1]) and not found[-1].reaches(0.9)
    shares = [each.accuracy.share for each in found]
    assert shares == sorted(shares, reverse=True)
    assert with_pixels(scene, 4).pixels.rows == 1


@pytest.mark.parametrize("target", ["corner", "pair"])
def test_targets_that_do_not_apply_are_refused(noisy, target):
    with pytest.raises(InputError, match="`target`"):
        hypotheses(noisy(), target)


def test_distances_grow_with_what_is_known_of_strengths(noisy):
    scene = noisy(readout=noise(0.01), spread=0.1, columns=3, **STRIP)
    presses, among = own_presses(scene), hypotheses(scene, "column")
    readings = Readings(scene, presses)
    free, held = distances(readings, among, presses), distances(readings, among, presses, 0.1)
    assert (held >= free - 1e-12).all() and (np.diag(free) == 0).all()
    assert (free[~np.eye(3, dtype=bool)] > 0).all()
