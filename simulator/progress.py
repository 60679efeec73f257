"""Progress of long work: a bar and the time left on a terminal, nothing in a pipe."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Protocol, TypeVar

from .safe_text import terminal

if TYPE_CHECKING:
    from rich.progress import Task

Item = TypeVar("Item")
MAX_ROWS = 12
"""Largest number of bars; a terminal of 24 rows has room for them and a few notes."""


class Expected(float):
    """A total in expected seconds: the time left is known before anything is done."""


class ProgressCallback(Protocol):
    """Callback with the name of the work, the amount done (None if unknown) and the total.

    Work that is reported again as unknown or 0 starts over.
    """

    def __call__(self, work: str, done: float | None = None, total: float = 1.0, /) -> None: ...


def silent(work: str, done: float | None = None, total: float = 1.0, /) -> None:
    """Progress callback that shows nothing."""


class Overall:
    """A progress callback for all parts of a command, with a first estimate of the whole time.

    It passes the progress of the parts on. One more bar shows the whole.
    """

    def __init__(self, name: str, parts: Mapping[str, float], progress: ProgressCallback) -> None:
        """name: of the whole. parts: expected seconds by the name of the work, in order."""
        self._name, self._parts, self._progress = name, dict(parts), progress
        self._done, self._total = 0.0, Expected(sum(parts.values()))
        progress(name, 0, self._total)

    def __call__(self, work: str, done: float | None = None, total: float = 1.0, /) -> None:
        self._progress(work, done, total)
        if work not in self._parts or done is None:
            return
        names = list(self._parts)
        before = sum(self._parts[each] for each in names[: names.index(work)])
        share = before + self._parts[work] * min(done / total, 1.0) if total else before
        if share > self._done:
            self._done = share
            self._progress(self._name, share, self._total)


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


def time_left(
    elapsed: float, share: float, then: float, first: float = 0.0, expected: float = 0.0
) -> str:
    """Remaining time as 0:01:30, assuming equal shares take equal time; -:--:-- if unknown.

    elapsed: s, until now. share: fraction done when `then` seconds had elapsed. first: fraction
    done at the start. expected: s, of the whole, before anything is done; 0 if unknown. It counts
    less and less until half is done.
    """
    whole = then / (share - first) if share > first else expected
    if expected:
        whole += max(0.0, 1 - 2 * share) * (expected - whole)
    left = (1 - share) * whole + then - elapsed if whole else -1.0
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
            expected = task.total if isinstance(task.total, Expected) else 0.0
            left = time_left(task.elapsed or 0.0, share, then, first, expected)
            return Text("" if task.finished else f"left {left}")

    named = TextColumn("{task.description}", markup=False), BarColumn()
    columns = *named, Counted(), TimeElapsedColumn(), Left()
    rows = dict[str, "Task"]()
    with Bars(*columns, console=terminal(stderr=True)) as bars:

        def progress(work: str, done: float | None = None, total: float = 1.0, /) -> None:
            if work not in rows:
                if len(rows) == MAX_ROWS:
                    bars.remove_task(rows.pop(next(iter(rows))).id)
                known = total if isinstance(total, Expected) else None
                bars.add_task(work, total=known, then=0.0, first=(done or 0.0) / (total or 1.0))
                rows[work] = bars.tasks[-1]
            elif not done:
                bars.reset(rows[work].id, then=0.0, first=0.0)
            if done is not None:
                then = rows[work].elapsed or 0.0
                bars.update(rows[work].id, total=total, completed=done, then=then)

        yield progress


def _counted(task: Task, unit: str) -> str:
    """The count and the rate as text; empty if only a fraction is known."""
    if not task.total or task.total <= 1 or isinstance(task.total, Expected):
        return ""
    rate = f" {task.speed:,.0f} {unit}/s" if unit and task.speed else ""
    return f"{task.completed:,.0f}/{task.total:,.0f}{rate}"
