"""A bar that tells how many sweeps are finished, how fast they come and how long it still takes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def on_terminal(description: str, sweeps: int) -> Iterator[Callable[[int], None]]:
    """To be called with each number of sweeps that have become finished; silent in a pipe."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, ProgressColumn, Task, TextColumn
    from rich.progress import TimeRemainingColumn as TimeLeft
    from rich.text import Text

    class Rate(ProgressColumn):
        """Sweeps a second."""

        def render(self, task: Task) -> Text:
            return Text("" if task.speed is None else f"{task.speed:,.0f} sweeps/s")

    console = Console(stderr=True)
    counted = TextColumn("{task.completed:,.0f}/{task.total:,.0f}")
    columns = (TextColumn("{task.description}"), BarColumn(), counted, Rate(), TimeLeft())
    with Progress(*columns, console=console, disable=not console.is_terminal) as progress:
        task = progress.add_task(description, total=sweeps)
        yield lambda finished: progress.advance(task, finished)
