"""Bayes' decision computed from every strength and draw, without interpolation."""

import math

import numpy as np
from rcskin.simulator.bounds.bayes import (
    FIRST_STRENGTHS,
    STEP,
    BayesAccuracy,
    Templates,
    axes_of,
    posterior,
    starts_of,
)
from rcskin.simulator.bounds.touch_readings import Hypothesis
from rcskin.simulator.measure.experiment import combined_strengths, strengths
from rcskin.simulator.press.batch import PressBatch


def exact(readings, among, presses, seed, draws):
    """As `bayes` of the package."""
    known, measured = compared(readings, among, presses, seed, draws)
    best = posterior(known, measured).max(axis=1)
    return BayesAccuracy(float(best.mean()), float(best.std(ddof=1) / math.sqrt(draws)))


def compared(readings, among, presses, seed, draws):
    """Templates, and readings of draws in their numbers."""
    pixels = sorted({pixel for each in among for pixel in each.pixels})
    steps = {pixel: _steps(readings, pixel, presses) for pixel in pixels}
    found, chance = [], []
    for each in among:
        every = combined_strengths([strengths(presses, steps[pixel]) for pixel in each.pixels])
        found.append(readings.of_presses(each, every.factor))
        chance.append(each.chance * every.weight)
    starts = starts_of([each.answer for each in among], [len(each) for each in chance])
    whole = np.concatenate(found)
    axes, random = axes_of(whole, 0.03), np.random.default_rng(seed)
    measured = axes.of(_drawn(readings, among, presses, random, draws))
    return Templates(axes.of(whole), np.concatenate(chance), starts), measured


def _steps(readings, pixel, presses):
    look = strengths(presses, FIRST_STRENGTHS).factor
    if look.size == 1:
        return 1
    alone = Hypothesis((pixel,), (), 1.0)
    speed = np.linalg.norm(np.diff(readings.of_presses(alone, look[None]), axis=0), axis=1).max()
    return max(1, math.ceil(float(speed) * FIRST_STRENGTHS / STEP))


def _drawn(readings, among, presses, random, draws):
    which = random.choice(len(among), draws, p=[each.chance for each in among])
    factors = presses.at(random.random((draws, max(len(each.pixels) for each in among) or 1)))
    pressed = (among[k].on(readings.skin, f - 1) for k, f in zip(which, factors, strict=True))
    clean = readings.whitened(PressBatch.of(pressed))
    return clean + random.standard_normal(clean.shape)
