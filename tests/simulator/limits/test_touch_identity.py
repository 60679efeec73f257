"""Identity of touches: the pairwise bound, counts of pixels, distances between sweeps."""

import numpy as np
from rcskin.simulator.bounds.bayes import bayes
from rcskin.simulator.bounds.touch_readings import TouchReadings, hypotheses
from rcskin.simulator.limits.touch_identity import (
    Sampling,
    counts,
    distances,
    grid_text,
    upper_bound,
    with_pixels,
)
from rcskin.simulator.measure.experiment import own_presses

STRIP = {"length": 0.1, "width": 0.02, "frequencies": (1e3, 1e4)}


def noise(size):
    return {"magnitude_noise": size, "phase_noise": size}


def test_the_pairwise_bound_exceeds_the_accuracy(noisy):
    scene = noisy(readout=noise(0.02), spread=0.2, columns=4, **STRIP)
    presses = own_presses(scene.parts.skin, scene.press)
    readings, among = (
        TouchReadings(scene.parts, presses),
        hypotheses(scene.parts.skin, scene.parts.plan, "column"),
    )
    found = bayes(readings, among, presses, seed=1, draws=2000)
    assert 0.3 < found.share - 4 * found.error <= upper_bound(readings, among, presses) < 1


def test_pixels_are_counted_up_to_the_required_accuracy(noisy):
    scene = noisy(readout=noise(0.01), columns=3, **STRIP)
    found = list(counts(scene.parts, "column", 0.9, Sampling(seed=1, draws=300)))
    assert [each.n for each in found] == list(range(2, 2 + len(found)))
    assert all(each.reaches(0.9) for each in found[:-1]) and not found[-1].reaches(0.9)
    shares = [each.accuracy.share for each in found]
    assert shares == sorted(shares, reverse=True)
    assert with_pixels(scene.parts, 4).skin.pixels.rows == 1


def test_pixels_are_counted_in_the_proportion_of_the_scene(noisy):
    scene = noisy(length=0.18, width=0.07, rows=2, columns=6)
    shapes = [grid_text(scene.parts, n) for n in (2, 3, 6, 8, 12)]
    assert shapes == ["1x2", "1x3", "2x6", "3x8", "4x12"]
    assert grid_text(noisy(length=0.1, width=0.02, columns=3).parts, 12) == "1x12"
    assert grid_text(noisy(length=0.1, width=0.1, rows=3, columns=3).parts, 5) == "5x5"


def test_distances_grow_with_the_knowledge_of_strengths(noisy):
    scene = noisy(readout=noise(0.01), spread=0.1, columns=3, **STRIP)
    presses, among = (
        own_presses(scene.parts.skin, scene.press),
        hypotheses(scene.parts.skin, scene.parts.plan, "column"),
    )
    readings = TouchReadings(scene.parts, presses)
    free, held = distances(readings, among, presses), distances(readings, among, presses, 0.1)
    assert (held >= free - 1e-12).all() and (np.diag(free) == 0).all()
    assert (free[~np.eye(3, dtype=bool)] > 0).all()
