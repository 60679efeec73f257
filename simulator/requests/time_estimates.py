"""A word before what takes minutes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from time import perf_counter
from typing import TypeVar

from ..progress import duration
from .console import note

Item = TypeVar("Item")

MIN_NOTED_SECONDS = 60.0
"""s."""


def note_if_long(name: str, seconds: float, work: str) -> None:
    """A note that tells about how long `work` takes, where that is a minute or more."""
    if seconds >= MIN_NOTED_SECONDS:
        note(f"{name}: {work} will take about {duration(seconds)}")


def with_time_estimate(
    name: str, presses: Iterable[Item], count: int, clock: Callable[[], float] = perf_counter
) -> Iterator[Item]:
    """So many presses; tells once how long those to come take, by how long the latest took.

    The first one prepares for all: not before the second is done. Earlier only where the first
    alone took a minute. clock: s.
    """
    started, told = clock(), False
    for done, press in enumerate(presses):
        left, latest = count - done, clock() - started
        known = done >= 2 or (done == 1 and latest >= MIN_NOTED_SECONDS)
        if known and not told and latest * left >= MIN_NOTED_SECONDS:
            told = True
            note_if_long(name, latest * left, f"the other {left} of {count} presses")
        started = clock()
        yield press
