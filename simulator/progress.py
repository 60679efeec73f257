"""Progress of long work: a bar and the time left on a terminal, silence in a pipe."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Protocol, TypeVar

from .shown import terminal

if TYPE_CHECKING:
    from rich.progress import Progress, ProgressColumn

Item = TypeVar("Item")


class Track(Protocol):
    """Hands out items one by one and tells how far it has come."""

    def __call__(self, items: Sequence[Item], description: str, /) -> Iterable[Item]: ...


def silent(items: Sequence[Item], description: str, /) -> Iterable[Item]:
    """Hands out the items and tells nothing."""
    return items


class Tell(Protocol):
    """Is told what goes on, and where that is known what share of it is done, from 0 to 1."""

    def __call__(self, told: str, share: float | None = None, /) -> None: ...


def tell_nothing(told: str, share: float | None = None, /) -> None:
    """Tells nothing."""


def duration(seconds: float) -> str:
    """A time as people say it."""
    if seconds < 90:
        return "a minute"
    return f"{seconds / 60:.0f} minutes" if seconds < 5400 else f"{seconds / 3600:.0f} hours"


def left_told(elapsed: float, share: float, then: float) -> str:
    """The time that is left, as 0:01:30, if shares take time alike; -:--:-- where none can tell.

    elapsed: s, now. share: of all, done when so many s had elapsed: `then`.
    """
    left = then / share - elapsed if share > 0 else -1.0
    if left < 0:
        return "-:--:--"
    minutes, seconds = divmod(round(left), 60)
    return f"{minutes // 60}:{minutes % 60:02}:{seconds:02}"


@contextmanager
def told_on_terminal() -> Iterator[Tell]:
    """Shows what goes on and how long it will last, if standard error is a terminal."""
    if not sys.stderr.isatty():
        yield tell_nothing
        return
    from rich.progress import ProgressColumn, Task, TextColumn, TimeElapsedColumn
    from rich.text import Text

    class Left(ProgressColumn):
        def render(self, task: Task) -> Text:
            return Text(left_told(task.elapsed or 0.0, task.completed, task.fields["then"]))

    with _bar(TimeElapsedColumn(), TextColumn("left"), Left(), transient=True) as progress:
        task = progress.add_task("", total=None, then=0.0)

        def tell(told: str, share: float | None = None, /) -> None:
            bar = progress.tasks[task]
            if bar.description != told or share is None:
                progress.reset(task, total=None, description=told, then=0.0)
            if share is not None:
                progress.update(task, total=1.0, completed=share, then=bar.elapsed or 0.0)

        yield tell


@contextmanager
def on_terminal() -> Iterator[Track]:
    """A tracker that draws a bar for each piece of work if standard error is a terminal.

    Beside it: how long the rest will take, and at the end how long all of it took.
    """
    if not sys.stderr.isatty():
        yield silent
        return
    from rich.progress import MofNCompleteColumn

    with _bar(MofNCompleteColumn(), *_time_left()) as progress:

        def track(items: Sequence[Item], description: str, /) -> Iterable[Item]:
            return progress.track(items, description=description)

        yield track


@contextmanager
def finished_on_terminal(about: str, count: int, unit: str) -> Iterator[Callable[[int], None]]:
    """To be called with each number of things that have become finished; silent in a pipe.

    Tells how many of all are finished, how fast they come and how long it still takes.
    """
    if not sys.stderr.isatty():
        yield lambda finished: None
        return
    from rich.progress import ProgressColumn, Task, TextColumn, TimeRemainingColumn
    from rich.text import Text

    class Rate(ProgressColumn):
        def render(self, task: Task) -> Text:
            return Text("" if task.speed is None else f"{task.speed:,.0f} {unit}/s")

    counted = TextColumn("{task.completed:,.0f}/{task.total:,.0f}")
    with _bar(counted, Rate(), TimeRemainingColumn()) as progress:
        task = progress.add_task(about, total=count)
        yield lambda finished: progress.advance(task, finished)


def _bar(*columns: ProgressColumn, transient: bool = False) -> Progress:
    """With these beside the bar."""
    from rich.progress import BarColumn, Progress, TextColumn

    named = TextColumn("{task.description}", markup=False), BarColumn()
    return Progress(*named, *columns, console=terminal(stderr=True), transient=transient)


def _time_left() -> tuple[ProgressColumn, ...]:
    from rich.progress import TextColumn, TimeRemainingColumn

    return TextColumn("left"), TimeRemainingColumn(elapsed_when_finished=True)
