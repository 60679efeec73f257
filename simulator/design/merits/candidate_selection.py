"""Selection of the best n candidates, with an upper bound for any n of them.

`limits` uses the same exchanges (`bounds.exchange`), but among frequencies with a smallest ratio,
and for figures without slopes, which have no such bound.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ...arrays import Integer, Real
from ...bounds.exchange import Score, best_choice

MAX_EXHAUSTIVE = 6000
"""Largest number of choices that are all evaluated."""
STEPS = 40
"""Steps of the relaxation; its bound is valid after any of them."""

Slope = Callable[[Real], tuple[float, Real]]
"""Function from weights of the candidates, shape (candidate,), to the merit and its slopes.

It is concave, and at weights 0 and 1 it is the merit of the selection."""


@dataclass(frozen=True)
class Selection:
    """Selected candidates, ascending, with their merit (`share`) and a bound for any n of them.

    exhaustive: True if all choices were evaluated.
    """

    candidates: tuple[int, ...]
    share: float
    upper_bound: float
    exhaustive: bool


def best_selection(
    score: Score, slope: Slope, candidates: int, n: int, starts: Sequence[Sequence[int]] = ()
) -> Selection:
    """The best n of the candidates, or all where there are no more.

    score: to be minimized, see `best_choice`. starts: choices from which exchanges begin.
    """
    if n >= candidates:
        everything = np.arange(candidates)
        share = slope(np.ones(candidates))[0]
        return Selection(tuple(everything.tolist()), share, share, True)
    every = math.comb(candidates, n) <= MAX_EXHAUSTIVE
    best = _of_all(score, candidates, n) if every else _exchanged(score, candidates, n, starts)
    share = slope(_weights(best, candidates))[0]
    most = share if every else selection_bound(slope, best, candidates)
    return Selection(tuple(best.tolist()), share, max(share, most), every)


def selection_bound(slope: Slope, best: Integer, candidates: int) -> float:
    """Upper bound for any choice of the same size: a concave function lies below its tangents.

    Frank and Wolfe's method, which starts at the choice and steps to the maximum of each tangent.
    """
    n, lowest = len(best), math.inf
    weights = _weights(best, candidates)
    for step in range(STEPS):
        value, by = slope(weights)
        towards = _weights(np.argsort(-by, kind="stable")[:n], candidates)
        lowest = min(lowest, value + float(by @ (towards - weights)))
        weights = weights + 2 / (step + 3) * (towards - weights)
    return lowest


def exchanged_by_slope(slope: Slope, begun: Integer, candidates: int) -> Integer:
    """A choice of the same size, ascending, that is at least as good as the first one.

    Each step exchanges the candidates of the smallest slopes for those of the largest outside, as
    many at once as gain, and half as many after a step without a gain.
    """
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


def _weights(chosen: Integer, candidates: int) -> Real:
    found = np.zeros(candidates)
    found[chosen] = 1.0
    return found


def _of_all(score: Score, candidates: int, n: int) -> Integer:
    choices = np.array(list(itertools.combinations(range(candidates), n)), dtype=np.int64)
    return choices[int(np.argmin(score(choices)))]


def _exchanged(score: Score, candidates: int, n: int, starts: Sequence[Sequence[int]]) -> Integer:
    begun = [np.array(start, dtype=np.int64) for start in starts if len(set(start)) == n]
    return best_choice(score, candidates, n, begun)
