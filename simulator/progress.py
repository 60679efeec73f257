"""Progress of long work: a bar on a terminal, silence in a pipe."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Protocol, TypeVar

Item = TypeVar("Item")


class Track(Protocol):
    """Hands out items one by one and tells how far it has come."""

    def __call__(self, items: Sequence[Item], description: str, /) -> Iterable[Item]: ...


def silent(items: Sequence[Item], description: str, /) -> Iterable[Item]:
    """Hands out the items and tells nothing."""
    return items


@contextmanager
def on_terminal() -> Iterator[Track]:
    """A tracker that draws a bar for each piece of work if standard error is a terminal.

    Beside it: how long the rest will take, and at the end how long all of it took.
    """
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn
    from rich.progress import TimeRemainingColumn as TimeLeft

    console = Console(stderr=True)
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeLeft(elapsed_when_finished=True),
    )
    with Progress(*columns, console=console, disable=not console.is_terminal) as progress:

        def track(items: Sequence[Item], description: str, /) -> Iterable[Item]:
            return progress.track(items, description=description)

        yield track
