"""Progress of long work: a bar and the time left on a terminal, silence in a pipe."""

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
"""Pieces of work that are shown; a terminal of 24 rows has room for them and a few notes."""


class ProgressCallback(Protocol):
    """Callback that takes what is being done, and how much of a total is done, None if unknown.

    Work that is reported again as unknown or at 0 begins anew.
    """

    def __call__(self, work: str, done: float | None = None, total: float = 1.0, /) -> None: ...


def silent(work: str, done: float | None = None, total: float = 1.0, /) -> None:
    """Shows nothing."""


def tracked(items: Sequence[Item], work: str, progress: ProgressCallback) -> Iterator[Item]:
    """The items one by one; each counts as done when the next one is asked for."""
    progress(work, 0, len(items))
    for done, item in enumerate(items, 1):
        yield item
        progress(work, done, len(items))


def duration(seconds: float) -> str:
    """A time as people say it."""
    if seconds < 90:
        return "a minute"
    return f"{seconds / 60:.0f} minutes" if seconds < 5400 else f"{seconds / 3600:.0f} hours"


def time_left(elapsed: float, share: float, then: float, first: float = 0.0) -> str:
    """The time that is left, as 0:01:30, if shares take time alike; -:--:-- where it is unknown.

    elapsed: s, now. share: of all, done when so many s had elapsed: `then`. first: the share that
    was done at the start.
    """
    left = (1 - share) * then / (share - first) + then - elapsed if share > first else -1.0
    if left < 0:
        return "-:--:--"
    minutes, seconds = divmod(round(left), 60)
    return f"{minutes // 60}:{minutes % 60:02}:{seconds:02}"


@contextmanager
def on_terminal(unit: str = "") -> Iterator[ProgressCallback]:
    """Draws a bar for each piece of work if standard error is a terminal.

    Beside it: how many of a total are done, how long the work has lasted, and how long the rest
    will take. unit: of what is counted; where it is given, the rate is shown too.
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
    """How many of a total are done, and how fast; empty where only a share is known."""
    if not task.total or task.total <= 1:
        return ""
    rate = f" {task.speed:,.0f} {unit}/s" if unit and task.speed else ""
    return f"{task.completed:,.0f}/{task.total:,.0f}{rate}"
