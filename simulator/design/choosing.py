"""The n of some candidates that tell most, and how far from the best any n may be at most.

Limits choose by the same exchanges, of `bounds.exchange`, but among frequencies that are kept apart
and by figures without slopes, so that nothing bounds what others reach.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..bounds.exchange import Score, best_choice

ALL_AT_ONCE = 6000
"""Choices that are all looked at, where there are no more."""
STEPS = 40
"""Of the relaxation: its bound is one after any."""

Slope = Callable[[NDArray[np.float64]], tuple[float, NDArray[np.float64]]]
"""From how much each candidate is read, shape (candidate,), to the share told right and its slope;
concave, and at zeros and ones that of the choice."""


@dataclass(frozen=True)
class Choice:
    """Candidates chosen, ascending; the share that they tell, and what no n of them exceed.

    every: whether all choices were looked at.
    """

    numbers: tuple[int, ...]
    share: float
    most: float
    every: bool


def chosen(
    score: Score, slope: Slope, candidates: int, n: int, starts: Sequence[Sequence[int]] = ()
) -> Choice:
    """n of the candidates, or all where there are no more.

    score: to be small, see `best_choice`. starts: choices to begin exchanges at.
    """
    if n >= candidates:
        everything = np.arange(candidates)
        share = slope(np.ones(candidates))[0]
        return Choice(tuple(everything.tolist()), share, share, True)
    every = math.comb(candidates, n) <= ALL_AT_ONCE
    best = _of_all(score, candidates, n) if every else _exchanged(score, candidates, n, starts)
    share = slope(_weights(best, candidates))[0]
    most = share if every else bound(slope, best, candidates)
    return Choice(tuple(best.tolist()), share, max(share, most), every)


def bound(slope: Slope, best: NDArray[np.int64], candidates: int) -> float:
    """What no choice of as many exceeds: a concave function lies below each of its tangents.

    Frank and Wolfe's method from the choice on, each step towards the best of the tangent.
    """
    n, least = len(best), math.inf
    weights = _weights(best, candidates)
    for step in range(STEPS):
        value, by = slope(weights)
        towards = _weights(np.argsort(-by, kind="stable")[:n], candidates)
        least = min(least, value + float(by @ (towards - weights)))
        weights = weights + 2 / (step + 3) * (towards - weights)
    return least


def exchanged_by_slope(
    slope: Slope, begun: NDArray[np.int64], candidates: int
) -> NDArray[np.int64]:
    """A choice of as many as that begun with, ascending, at least as good: of exchanges of the
    least by the slope for the best, as many at once as gain, half as many where they do not."""
    best, count = np.sort(begun), len(begun)
    value, by = slope(_weights(best, candidates))
    while count:
        inside = best[np.argsort(by[best], kind="stable")[:count]]
        left = np.setdiff1d(np.arange(candidates), best)
        outside = left[np.argsort(-by[left], kind="stable")[:count]]
        pairs = min(len(inside), len(outside))
        gains = by[outside[:pairs]] > by[inside[:pairs]]
        tried = np.sort(
            np.concatenate([np.setdiff1d(best, inside[:pairs][gains]), outside[:pairs][gains]])
        )
        found, turned = slope(_weights(tried, candidates))
        if found > value:
            best, value, by = tried, found, turned
        else:
            count //= 2
    return best


def _weights(chosen: NDArray[np.int64], candidates: int) -> NDArray[np.float64]:
    found = np.zeros(candidates)
    found[chosen] = 1.0
    return found


def _of_all(score: Score, candidates: int, n: int) -> NDArray[np.int64]:
    choices = np.array(list(itertools.combinations(range(candidates), n)), dtype=np.int64)
    return choices[int(np.argmin(score(choices)))]


def _exchanged(
    score: Score, candidates: int, n: int, starts: Sequence[Sequence[int]]
) -> NDArray[np.int64]:
    begun = [np.array(start, dtype=np.int64) for start in starts if len(set(start)) == n]
    return best_choice(score, candidates, n, begun)
