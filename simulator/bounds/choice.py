"""Choice of n of many candidates, the same for frequencies and for readings.

All choices are compared where they are few; else exchanges follow a greedy choice. For a concave
merit with slopes, a bound tells what any choice of the same size may reach.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Integer, Mask, Real
from .merits import Candidates

Score = Callable[[Integer], Real]
"""Function from choices, shape (choice, n), to the minimized score, shape (choice,)."""

GAIN = 1e-9
"""Smallest relative decrease of the score by an exchange."""
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


def best_choice(
    score: Score,
    candidates: int,
    n: int,
    starts: Sequence[Sequence[int] | Integer] = (),
    excludes: Mask | None = None,
) -> Integer:
    """n candidates of low score, ascending: the best of all, or of exchanges from several starts.

    starts: further choices to begin at, in addition to the greedy one, where they are allowed.
    excludes: True for pairs of candidates that exclude each other, shape (candidate, candidate),
    symmetric; by default each candidate excludes itself. It must allow a choice of n from any
    start.
    """
    excludes = np.eye(candidates, dtype=bool) if excludes is None else excludes
    if _count(n, excludes) <= MAX_EXHAUSTIVE:
        ended = _every(n, excludes)
    else:
        given = [np.sort(start) for start in starts if len(start) == n]
        begun = [start for start in given if _allowed(start[None], excludes)[0]]
        ended = np.array(
            [_exchanged(score, k, excludes) for k in (_grown(score, n, excludes), *begun)]
        )
    return ended[int(np.argmin(score(ended)))]


def best_selection(
    candidates: Candidates, n: int, starts: Sequence[Sequence[int]] = ()
) -> Selection:
    """The best n of the candidates, or all where there are no more; see `best_choice`."""
    count, slope = candidates.count, candidates.slope
    if n >= count:
        share = slope(np.ones(count))[0]
        return Selection(tuple(range(count)), share, share, True)
    best = best_choice(candidates.score, count, n, starts)
    share = slope(_weights(best, count))[0]
    every = math.comb(count, n) <= MAX_EXHAUSTIVE
    most = share if every else selection_bound(slope, best, count)
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


def _count(n: int, excludes: Mask) -> int:
    """Number of choices, those that are not allowed included."""
    candidates = len(excludes)
    return math.comb(candidates if excludes[0, 0] else candidates + n - 1, n)


def _every(n: int, excludes: Mask) -> Integer:
    """All allowed choices, shape (choice, n)."""
    alone = itertools.combinations if excludes[0, 0] else itertools.combinations_with_replacement
    choices = np.array(list(alone(range(len(excludes)), n)), dtype=np.int64)
    return choices[_allowed(choices, excludes)]


def _allowed(choices: Integer, excludes: Mask) -> Mask:
    """True for choices whose candidates do not exclude each other, shape (choice,)."""
    one, other = np.triu_indices(choices.shape[1], 1)
    return np.logical_not(excludes[choices[:, one], choices[:, other]].any(axis=1))


def _grown(score: Score, n: int, excludes: Mask) -> Integer:
    chosen = np.zeros(0, dtype=np.int64)
    for _ in range(n):
        options = _with_each(chosen, excludes)
        chosen = options[int(np.argmin(score(options)))]
    return chosen


def _exchanged(score: Score, chosen: Integer, excludes: Mask) -> Integer:
    lowest = float(score(chosen[None])[0])
    quiet, slot = 0, 0
    while quiet < len(chosen):
        options = _with_each(np.delete(chosen, slot), excludes)
        scores = score(options)
        best = int(np.argmin(scores))
        if scores[best] < lowest * (1 - GAIN):
            lowest, quiet = float(scores[best]), 0
            chosen = np.insert(np.delete(chosen, slot), slot, options[best, -1])
        else:
            quiet += 1
        slot = (slot + 1) % len(chosen)
    return np.sort(chosen)


def _with_each(chosen: Integer, excludes: Mask) -> Integer:
    """The choice plus one more, for every allowed candidate, shape (option, n + 1)."""
    more = np.flatnonzero(~excludes[chosen].any(axis=0))
    return np.column_stack([np.tile(chosen, (len(more), 1)), more]).astype(np.int64)
