"""A recording on a terminal: a table that grows with each reading, and prompts for a person."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..meter.errors import MeterError
from ..meter.reading import Reading, Status
from .operators import Show
from .order import Step

if TYPE_CHECKING:
    from rich.console import Console
    from rich.live import Live
    from rich.table import Table

SHOWN_READINGS = 20


class Screen:
    """Live table of Rs and Cp on a terminal; in a pipe only what is wrong with a sweep."""

    def __init__(self, console: Console) -> None:
        self._console, self._live = console, None
        self._title, self._readings = "", deque[tuple[float, Reading]](maxlen=SHOWN_READINGS)

    def begin(self, title: str) -> None:
        """A sweep begins."""
        from rich.live import Live

        self._title = title
        self._readings.clear()
        if self._console.is_terminal:
            self._live: Live | None = Live(self._table(), console=self._console, transient=True)
            self._live.start()

    def reading(self, frequency: float, reading: Reading) -> None:
        """A reading came, at a frequency in Hz."""
        self._readings.append((frequency, reading))
        if self._live:
            self._live.update(self._table())

    def end(self, remarks: Sequence[str]) -> None:
        """The sweep is over; tell what is wrong with it."""
        if self._live:
            self._live.stop()
            self._live = None
        if self._console.is_terminal and not remarks:
            self._console.print(f"{self._title}: done", highlight=False)
        for remark in remarks:
            self._console.print(
                f"{self._title}: {remark}", highlight=False, markup=False, soft_wrap=True
            )

    def _table(self) -> Table:
        from rich.table import Column, Table

        right = [Column(name, justify="right") for name in ("f (kHz)", "Rs (kohm)", "Cp (pF)")]
        table = Table(*right, "", title=self._title, box=None)
        for frequency, reading in self._readings:
            table.add_row(
                f"{frequency / 1e3:.5g}",
                f"{reading.Rs / 1e3:.6g}",
                f"{reading.Cp * 1e12:.6g}",
                "" if reading.status is Status.NORMAL else reading.status.meaning,
            )
        return table


@dataclass(frozen=True)
class Person:
    """Someone at the keyboard who presses the skin and decides what is repeated."""

    console: Console
    show: Show

    def press(self, step: Step, number: int, total: int) -> None:
        """Tell what to press, and wait for Enter."""
        place = f"row {step.row}, column {step.column}" if step.row > 0 else step.press
        what = "Release the skin" if step.row == 0 else f"Press {place} and hold it"
        self._ask(f"{number + 1}/{total}  {what}, then Enter ")
        self.show.begin(f"{number + 1}/{total}  press {step.press}")

    def watch(self, frequency: float, reading: Reading) -> None:
        """Show the reading."""
        self.show.reading(frequency, reading)

    def kept(self, remarks: Sequence[str]) -> bool:
        """Whether the person keeps a sweep in spite of remarks."""
        self.show.end(remarks)
        return not remarks or self._ask("Repeat it? [Y/n] ").lower().startswith("n")

    def again(self, failure: MeterError) -> bool:
        """Whether the person wants to try again."""
        self.show.end([str(failure)])
        return not self._ask("Try it again? [Y/n] ").lower().startswith("n")

    def _ask(self, question: str) -> str:
        try:
            return self.console.input(question, markup=False).strip()
        except EOFError:
            raise KeyboardInterrupt from None
