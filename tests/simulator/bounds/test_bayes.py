"""The best accuracy: limits, a closed form, mirror images, upper bounds."""

import pytest
from rcskin.simulator.bounds.bayes import bayes
from rcskin.simulator.bounds.touch_readings import TouchReadings, hypotheses
from rcskin.simulator.limits import bayes_accuracy
from rcskin.simulator.limits.touch_identity import distances, upper_bound
from rcskin.simulator.measure.experiment import own_presses
from rcskin.simulator.sweeps import InputError
from scipy.special import ndtr

STRIP = {"length": 0.1, "width": 0.02, "frequencies": (1e3, 1e4)}


def noise(size):
    return {"magnitude_noise": size, "phase_noise": size}


def test_the_accuracy_is_1_without_noise_and_that_of_a_guess_in_noise(noisy):
    clear = noisy(readout=noise(1e-4), columns=3, **STRIP)
    assert bayes_accuracy(clear.parts, "column", draws=200)[0] == pytest.approx(1, abs=1e-6)
    lost = noisy(readout=noise(1.0), columns=3, factor=1.0001, **STRIP)
    assert bayes_accuracy(lost.parts, "column", draws=200)[0] == pytest.approx(1 / 3, abs=1e-3)
    assert bayes_accuracy(lost.parts, "pair", draws=200)[0] == pytest.approx(1 / 3, abs=1e-3)
    assert bayes_accuracy(lost.parts, "touches", draws=200)[0] == pytest.approx(1 / 3, abs=1e-3)


def test_two_presses_of_known_strength_equal_two_points_in_normal_noise(noisy):
    scene = noisy(readout=noise(0.03), spread=0.0, columns=2, **STRIP)
    presses, among = (
        own_presses(scene.parts.skin, scene.press),
        hypotheses(scene.parts.skin, scene.parts.plan, "column"),
    )
    readings = TouchReadings(scene.parts, presses)
    apart = distances(readings, among, presses)[0, 1]
    exact = ndtr(apart / 2)
    found = bayes(readings, among, presses, seed=1, draws=4000)
    assert 0.6 < exact < 0.99
    assert found.share == pytest.approx(exact, abs=4 * found.error)
    assert upper_bound(readings, among, presses) == pytest.approx(exact, rel=1e-9)


def test_mirror_pixels_are_guessed_whatever_the_meter(noisy):
    scene = noisy(readout=noise(1e-3), rows=2, columns=2, frequencies=(1e3, 1e4))
    presses = own_presses(scene.parts.skin, scene.press)
    readings = TouchReadings(scene.parts, presses)
    for target in ("row", "pixel"):
        among = hypotheses(scene.parts.skin, scene.parts.plan, target)
        found = bayes(readings, among, presses, seed=1, draws=300)
        assert found.share == pytest.approx(0.5, abs=1e-3)
        assert upper_bound(readings, among, presses) == pytest.approx(0.5, abs=1e-3)
    assert bayes_accuracy(scene.parts, "column", draws=300)[0] > 0.99


def test_finer_steps_of_strength_change_nothing(noisy, monkeypatch):
    scene = noisy(readout=noise(0.01), spread=0.2, columns=3, **STRIP)
    coarse = bayes_accuracy(scene.parts, "pair", draws=300)
    monkeypatch.setattr("rcskin.simulator.bounds.bayes.STEP", 0.5)
    assert bayes_accuracy(scene.parts, "pair", draws=300)[0] == pytest.approx(coarse[0], abs=3e-4)


def test_a_seed_gives_the_same_bits_and_the_unpressed_skin_can_be_a_class(noisy):
    scene = noisy(readout=noise(0.02), columns=3, unpressed=True, **STRIP)
    assert bayes_accuracy(scene.parts, seed=4, draws=100) == bayes_accuracy(
        scene.parts, seed=4, draws=100
    )
    assert [each.answer for each in hypotheses(scene.parts.skin, scene.parts.plan, "column")] == [
        (0,),
        (1,),
        (2,),
        (3,),
    ]
    assert [each.answer for each in hypotheses(scene.parts.skin, scene.parts.plan, "pixel")][
        :2
    ] == [(0, 0), (1, 1)]


def test_noise_that_is_too_small_is_refused(noisy):
    scene = noisy(readout=noise(1e-9), columns=3, **STRIP)
    with pytest.raises(InputError, match="too small"):
        bayes_accuracy(scene.parts, "column", draws=10)


@pytest.mark.parametrize("target", ["corner", "pair"])
def test_targets_that_do_not_apply_are_refused(noisy, target):
    scene = noisy()
    with pytest.raises(InputError, match="`target`"):
        hypotheses(scene.parts.skin, scene.parts.plan, target)
