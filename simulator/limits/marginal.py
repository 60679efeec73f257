"""The best that can be told of presses by a hand, on a known skin, by sums over drawn presses.

What a hand does beside what was meant is not known to whoever reads the sweep: the likelihood of
each answer is the mean over presses that are drawn from the hand's habits. With too few of these
the decisions are worse than Bayes', so that their share of right answers lies below the limit, and
more sure of themselves than they ought to be, so that the probability they give their own answers
lies above it. With more of them the two close in on it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import logsumexp, softmax

from simulator.limits.hand import Hand
from simulator.limits.hypotheses import Hypothesis
from simulator.progress import Track, silent

NUMBERS = 16
"""Directions of most change that readings are compared in; the others hold noise alone."""
LOOKED_AT = 100
"""Presses of each answer that tell these directions."""
AT_ONCE = 2**23
WEISZFELD_STEPS = 40
CLOSEST = 1e-4
"""m, within which the middle of the posterior is found."""
Array = NDArray[np.float64]
Single = NDArray[np.float32]
"""Enough for what a meter's noise covers."""


class Between(NamedTuple):
    """A limit that lies between two estimates, but for their standard error."""

    least: float
    most: float
    error: float


@dataclass(frozen=True)
class Axes:
    """From whitened readings to few numbers."""

    origin: Array
    turn: Array

    def of(self, readings: Array) -> Single:
        """Shape (reading, number)."""
        return ((readings - self.origin) @ self.turn).astype(np.float32)


def accuracy_of_hand(
    hand: Hand,
    among: Sequence[Hypothesis],
    *,
    seed: int = 1,
    draws: int = 1000,
    samples: int = 4000,
    track: Track = silent,
) -> Between:
    """Share of sweeps that the best classifier tells right. samples: presses of each hypothesis."""
    drawing, known = (np.random.default_rng([seed, k]) for k in (0, 1))
    axes = _axes(np.concatenate([hand.pressed(each, known, LOOKED_AT) for each in among]))
    chances = np.array([each.chance for each in among])
    which = np.sort(drawing.choice(len(among), draws, p=chances))
    clean = np.concatenate(
        [hand.pressed(among[k], drawing, int(n)) for k, n in zip(*_counted(which), strict=True)]
    )
    measured = axes.of(clean + drawing.standard_normal(clean.shape))
    likely = np.empty((draws, len(among)))
    for k, each in enumerate(track(among, "presses")):
        likely[:, k] = _evidence(measured, axes.of(hand.pressed(each, known, samples)))
    return _judged(likely + np.log(chances), among, which)


def distance_of_hand(
    hand: Hand, *, seed: int = 1, draws: int = 500, samples: int = 40_000
) -> tuple[float, float]:
    """Median distance in m between a touch anywhere and the middle of its posterior, and its
    standard error. The middle is that of least mean distance. With few samples it comes out large.
    """
    drawing, known = (np.random.default_rng([seed, k]) for k in (0, 1))
    places, readings = hand.anywhere(known, samples)
    axes = _axes(readings[: LOOKED_AT * LOOKED_AT])
    templates = axes.of(readings)
    truth, clean = hand.anywhere(drawing, draws)
    measured = axes.of(clean + drawing.standard_normal(clean.shape))
    parts = np.array_split(measured, max(1, draws * samples // AT_ONCE))
    told = np.concatenate([_middle(_log_joint(part, templates), places) for part in parts])
    away = np.hypot(*(told - truth).T)
    again = np.random.default_rng([seed, 2]).choice(away, (200, draws))
    return float(np.median(away)), float(np.median(again, axis=1).std(ddof=1))


def _counted(which: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    return np.unique(which, return_counts=True)


def _axes(readings: Array) -> Axes:
    origin = readings.mean(axis=0)
    centred = readings - origin
    _, turn = np.linalg.eigh(centred.T @ centred)
    return Axes(origin, turn[:, ::-1][:, :NUMBERS])


def _log_joint(measured: Single, templates: Single) -> Single:
    """ln of the likelihood of each template but for a constant, shape (reading, template)."""
    return measured @ templates.T - (templates**2).sum(axis=1) / 2


def _evidence(measured: Single, templates: Single) -> Array:
    """ln of the mean likelihood over templates, shape (reading,)."""
    parts = np.array_split(measured, max(1, len(measured) * len(templates) // AT_ONCE))
    sums = [np.asarray(logsumexp(_log_joint(part, templates), axis=1)) for part in parts]
    return np.concatenate(sums) - math.log(len(templates))


def _judged(likely: Array, among: Sequence[Hypothesis], which: NDArray[np.int64]) -> Between:
    answers = [each.answer for each in among]
    names = sorted(set(answers))
    answer = np.array([names.index(each) for each in answers])
    posterior = softmax(likely, axis=1)
    told = np.stack([posterior[:, answer == k].sum(axis=1) for k in range(len(names))], axis=1)
    best = told.max(axis=1, keepdims=True)
    ties = told >= best * (1 - 1e-6)
    right = ties[np.arange(len(told)), answer[which]] / ties.sum(axis=1)
    error = max(right.std(ddof=1), best.std(ddof=1)) / math.sqrt(len(right))
    return Between(float(right.mean()), float(best.mean()), float(error))


def _middle(log_joint: Single | Array, places: Array) -> Array:
    """Of least mean distance from places so likely, by Weiszfeld's iteration, (reading, 2)."""
    share = np.asarray(softmax(log_joint, axis=1))
    middle = share @ places
    for _ in range(WEISZFELD_STEPS):
        away = np.hypot(*(middle[:, None] - places).transpose(2, 0, 1))
        pull = share / np.maximum(away, CLOSEST)
        middle = pull @ places / pull.sum(axis=1, keepdims=True)
    return middle
