"""Choice of n of many candidates: greedy growth, then exchanges."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ..arrays import Integer, Mask, Real

Score = Callable[[Integer], Real]
"""Function from choices, shape (choice, n), to the minimized score, shape (choice,)."""

GAIN = 1e-9
"""Smallest relative decrease of the score by an exchange."""


def best_choice(
    score: Score,
    candidates: int,
    n: int,
    starts: Sequence[Integer] = (),
    excludes: Mask | None = None,
) -> Integer:
    """n candidates of low score, ascending: the best result of exchanges from several starts.

    starts: further choices to begin at, in addition to the greedy one. excludes: True for pairs of
    candidates that exclude each other, shape (candidate, candidate), symmetric; by default each
    candidate excludes itself. It must allow a choice of n from any start.
    """
    excludes = np.eye(candidates, dtype=bool) if excludes is None else excludes
    begun = [_grown(score, n, excludes), *starts]
    ended = [_exchanged(score, np.sort(start), excludes) for start in begun]
    scores = score(np.array(ended))
    return ended[int(np.argmin(scores))]


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
