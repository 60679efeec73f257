"""Notes with the estimated duration before work that takes minutes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from time import perf_counter
from typing import TypeVar

from ..progress import duration
from .console import note

Item = TypeVar("Item")

MIN_NOTED_SECONDS = 60.0
"""Shortest duration of work that is announced, s."""


def note_if_long(name: str, seconds: float, work: str) -> None:
    """Prints a note with the estimated duration of `work` if that is a minute or more."""
    if seconds >= MIN_NOTED_SECONDS:
        note(f"{name}: {work} will take about {duration(seconds)}")


def with_time_estimate(
    name: str, presses: Iterable[Item], count: int, clock: Callable[[], float] = perf_counter
) -> Iterator[Item]:
    """Yields the presses; once, prints an estimate of the remaining time from the latest press.

    The first press includes preparations for all, so the estimate waits for the second one, unless
    the first alone took a minute. clock: returns seconds.
    """
    started, noted = clock(), False
    for done, press in enumerate(presses):
        left, latest = count - done, clock() - started
        known = done >= 2 or (done == 1 and latest >= MIN_NOTED_SECONDS)
        if known and not noted and latest * left >= MIN_NOTED_SECONDS:
            noted = True
            note_if_long(name, latest * left, f"the other {left} of {count} presses")
        started = clock()
        yield press
