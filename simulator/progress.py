"""Progress of long work: a bar and the time left on a terminal, nothing in a pipe."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Protocol, TypeVar

from .safe_text import terminal

if TYPE_CHECKING:
    from rich.progress import Task

Item = TypeVar("Item")
MAX_ROWS = 12
"""Largest number of bars; a terminal of 24 rows has room for them and a few notes."""


class ProgressCallback(Protocol):
    """Callback with the name of the work, the amount done (None if unknown) and the total.

    Work that is reported again as unknown or 0 starts over.
    """

    def __call__(self, work: str, done: float | None = None, total: float = 1.0, /) -> None: ...


def silent(work: str, done: float | None = None, total: float = 1.0, /) -> None:
    """Progress callback that shows nothing."""


def tracked(items: Sequence[Item], work: str, progress: ProgressCallback) -> Iterator[Item]:
    """Yields the items; each counts as done when the next one is requested."""
    progress(work, 0, len(items))
    for done, item in enumerate(items, 1):
        yield item
        progress(work, done, len(items))


def duration(seconds: float) -> str:
    """A duration in words, such as `5 minutes`."""
    if seconds < 90:
        return "a minute"
    return f"{seconds / 60:.0f} minutes" if seconds < 5400 else f"{seconds / 3600:.0f} hours"


def time_left(elapsed: float, share: float, then: float, first: float = 0.0) -> str:
    """Remaining time as 0:01:30, assuming equal shares take equal time; -:--:-- if unknown.

    elapsed: s, until now. share: fraction done when `then` seconds had elapsed. first: fraction
    done at the start.
    """
    left = (1 - share) * then / (share - first) + then - elapsed if share > first else -1.0
    if left < 0:
        return "-:--:--"
    minutes, seconds = divmod(round(left), 60)
    return f"{minutes // 60}:{minutes % 60:02}:{seconds:02}"


@contextmanager
def on_terminal(unit: str = "") -> Iterator[ProgressCallback]:
    """Yields a callback that draws a bar for each piece of work if standard error is a terminal.

    Each bar shows the count, the elapsed and the remaining time. unit: unit of the count; if it is
    given, the rate is shown as well.
    """
    if not sys.stderr.isatty():
        yield silent
        return
    from rich.progress import BarColumn, ProgressColumn, TextColumn, TimeElapsedColumn
    from rich.progress import Progress as Bars
    from rich.text import Text

    class Counted(ProgressColumn):
        def render(self, task: Task) -> Text:
            return Text(_counted(task, unit))

    class Left(ProgressColumn):
        def render(self, task: Task) -> Text:
            share = task.completed / task.total if task.total else 0.0
            then, first = task.fields["then"], task.fields["first"]
            left = time_left(task.elapsed or 0.0, share, then, first)
            return Text("" if task.finished else f"left {left}")

    named = TextColumn("{task.description}", markup=False), BarColumn()
    columns = *named, Counted(), TimeElapsedColumn(), Left()
    rows = dict[str, "Task"]()
    with Bars(*columns, console=terminal(stderr=True)) as bars:

        def progress(work: str, done: float | None = None, total: float = 1.0, /) -> None:
            if work not in rows:
                if len(rows) == MAX_ROWS:
                    bars.remove_task(rows.pop(next(iter(rows))).id)
                bars.add_task(work, total=None, then=0.0, first=(done or 0.0) / (total or 1.0))
                rows[work] = bars.tasks[-1]
            elif not done:
                bars.reset(rows[work].id, then=0.0, first=0.0)
            if done is not None:
                then = rows[work].elapsed or 0.0
                bars.update(rows[work].id, total=total, completed=done, then=then)

        yield progress


def _counted(task: Task, unit: str) -> str:
    """The count and the rate as text; empty if only a fraction is known."""
    if not task.total or task.total <= 1:
        return ""
    rate = f" {task.speed:,.0f} {unit}/s" if unit and task.speed else ""
    return f"{task.completed:,.0f}/{task.total:,.0f}{rate}"
