"""Operators, which press the skin during a recording: a machine, or a person at a terminal."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Protocol, Self

import numpy as np

from ...simulator.sweeps import UNPRESSED, InputError, inputs
from ...simulator.sweeps.free_space import check_memory
from ...simulator.sweeps.press_text import parse_touches, written_pixel
from ..command_template import CommandTemplate
from ..meter.errors import MeterError, PressError
from ..meter.meter_reading import MeterReading, ReadingStatus
from ..meter.termination import raise_pending_signal
from .measured_sweep import InterfaceTrace, MeasuredSweep, percent_change

if TYPE_CHECKING:
    from rich.console import Console
    from rich.live import Live
    from rich.table import Table

    from ...simulator.arrays import Real


@dataclass(frozen=True)
class PressStep:
    """One press. row, column: 0 for the unpressed skin, -1 if it is no single pixel."""

    press: str
    row: int
    column: int


UNPRESSED_STEP = PressStep(UNPRESSED, 0, 0)
FIRST_BASELINES = 3
BYTES_FOR_STEP = 300
"""Memory of one step, its text and its place in the order."""
UNKNOWN = "?"
"""Press of a sweep whose press is unknown."""


def parse_step(text: str, rows: int, columns: int) -> PressStep:
    """Step of a press, see `sweeps.press_text`.

    Raises InputError for other syntax, or a pixel outside rows x columns.
    """
    press = "".join(text.split())
    touches = parse_touches(press)
    for row, column in (touch.pixel for touch in touches if touch.kind == "pixel"):
        if not (1 <= row <= rows and 1 <= column <= columns):
            raise InputError(f"press {text!r}: pixels must be in 1,1 to {rows},{columns}")
    return PressStep(press, *written_pixel(press)) if touches else UNPRESSED_STEP


def standard_order(
    rows: int, columns: int, repetitions: int, without: Collection[tuple[int, int]] = ()
) -> list[PressStep]:
    """All pixels row by row, `repetitions` times, with the unpressed skin between and after.

    FIRST_BASELINES unpressed sweeps begin it. without: pixels that the skin lacks.
    """
    if not 1 <= repetitions <= 10_000:
        raise InputError(f"`repetitions` must be in 1..10000, got {repetitions}")
    check_memory(
        BYTES_FOR_STEP * rows * columns * repetitions,
        f"{repetitions} sweeps of each of {rows} x {columns} pixels",
        "ask for fewer --repetitions, or fewer `pixels`",
    )
    every = product(range(1, rows + 1), range(1, columns + 1))
    pixels = [PressStep(f"{i},{j}", i, j) for i, j in every if (i, j) not in without]
    return (
        [UNPRESSED_STEP] * (FIRST_BASELINES - 1)
        + [UNPRESSED_STEP, *pixels] * repetitions
        + [UNPRESSED_STEP]
    )


def read_order(path: Path, rows: int, columns: int) -> list[PressStep]:
    """Order in a file with one press per line; `#` begins a comment.

    Raises InputError with the file and the line.
    """
    lines = inputs.text(path, inputs.SETTINGS).splitlines()
    steps: list[PressStep] = []
    for number, line in enumerate(lines, start=1):
        text = line.split("#")[0].strip()
        if not text:
            continue
        try:
            steps.append(parse_step(text, rows, columns))
        except InputError as error:
            raise InputError(f"{path}: line {number}: {error}") from error
    if not steps:
        raise InputError(f"{path}: has no press; write one per line")
    return steps


Press = Callable[[PressStep], None]


@dataclass(frozen=True)
class StepStatus:
    """Progress of a recording.

    number: of the step, from 0. total: steps. left: estimated s until the end, None if unknown.
    baseline: the latest sound unpressed sweep, or None.
    """

    number: int
    total: int
    left: float | None = None
    baseline: MeasuredSweep | None = None

    @property
    def words(self) -> str:
        """Step, number of steps, and the time left."""
        counted = f"{self.number + 1}/{self.total}"
        if self.left is None:
            return counted
        minutes, seconds = divmod(round(self.left), 60)
        return f"{counted}, {minutes}:{seconds:02d} min left"


class Operator(Protocol):
    """Presses the skin and decides what is repeated. show: what it shows of the recording."""

    @property
    def show(self) -> RecordingDisplay: ...

    def same_mounting(self, ago: str) -> bool:
        """True if the skin was not mounted anew since the last sweep. ago: time since, in words."""
        ...

    def press(self, step: PressStep, progress: StepStatus) -> bool:
        """True when the skin is pressed; False if the step before is to be repeated.

        Raises PressError if the press fails, KeyboardInterrupt if the recording is to end here.
        """
        ...

    def kept(self, remarks: Sequence[str]) -> bool:
        """True to keep a finished sweep, False to repeat it. remarks: its faults."""
        ...

    def again(self, failure: MeterError) -> bool:
        """True to repeat a failed sweep, False to stop."""
        ...


class RecordingDisplay(Protocol):
    """Shows the progress of a recording."""

    def begin(self, title: str, baseline: MeasuredSweep | None) -> None: ...
    def turn(self, interface: str) -> None: ...
    def reading(self, frequency: float, reading: MeterReading) -> None: ...
    def end(self, remarks: Sequence[str]) -> None: ...


@dataclass
class MachineOperator:
    """Presses by a function, and repeats failed or unsound sweeps up to `retries` times.

    pause: s before the first repetition after a failure; doubled for each further one.
    """

    press_skin: Press
    show: RecordingDisplay
    retries: int = 3
    pause: float = 1.0
    repetitions: int = field(default=0, init=False)
    current: int = field(default=-1, init=False)
    _failed: bool = field(default=False, init=False)

    def same_mounting(self, ago: str) -> bool:
        """False: a machine does not know."""
        return False

    def press(self, step: PressStep, progress: StepStatus) -> bool:
        """Press by the machine. Raises PressError if it fails."""
        if progress.number != self.current:
            self.current, self.repetitions = progress.number, 0
        self.press_skin(step)
        self.show.begin(f"{progress.words}  press {step.press}", progress.baseline)
        return True

    def kept(self, remarks: Sequence[str]) -> bool:
        """True if the sweep is sound or the repetitions are used up."""
        failed, self._failed = self._failed, False
        self.show.end(remarks or ["the sweep that was measured again is whole"] * failed)
        return not remarks or not self._count_repetition()

    def again(self, failure: MeterError) -> bool:
        """True, after a pause, unless the repetitions are used up."""
        self._failed = self._count_repetition()
        what = "; the sweep is measured again" * self._failed
        self.show.end([f"{failure}{what}"])
        if not self._failed:
            return False
        time.sleep(self.pause * 2 ** (self.repetitions - 1))
        return True

    def _count_repetition(self) -> bool:
        self.repetitions += 1
        return self.repetitions <= self.retries


def press_by_command(command: str) -> Press:
    """Function that presses by a command with placeholders `{press}`, `{row}`, `{column}`.

    Raises InputError if the command is malformed. The function raises PressError if the command
    cannot run or ends with another code than 0.
    """
    template = CommandTemplate(command, "press-with", press="none", row=0, column=0)

    def press(step: PressStep) -> None:
        filled = template.filled(press=step.press, row=step.row, column=step.column)
        try:
            subprocess.run(filled, check=True, capture_output=True, timeout=600)
        except (OSError, subprocess.SubprocessError) as error:
            raise PressError(f"press {step.press}: {error}; check the pressing machine") from error

    return press


def press_virtual_skin(control: str) -> Press:
    """Function that presses a virtual meter's skin through its control port."""
    from ..control_client import send_request

    def press(step: PressStep) -> None:
        send_request(control, "press", press=step.press)

    return press


MAX_ROWS = 20
COLUMNS = {
    "Rs": ("Rs (kohm)", 1e-3, 6),
    "Cp": ("Cp (pF)", 1e12, 6),
    "gain": ("gain", 1.0, 6),
    "gain_phase": ("phase (deg)", 180 / np.pi, 4),
}
"""Columns of the table by quantity: title, factor and significant digits."""
LEVELS = "▁▂▃▄▅▆▇█"


class RecordingScreen:
    """Live table of readings on a terminal while the block runs, and a line per sweep.

    In a pipe it prints only faults of sweeps, or with `plain` a line per sweep. several: True if
    sweeps have several interfaces, which are then named.
    """

    def __init__(self, console: Console, plain: bool = False, several: bool = False) -> None:
        self._console, self._reports_all = console, plain or console.is_terminal
        self._several = several
        self._live: Live | None = None
        self._title = self._press = ""
        self._baseline: MeasuredSweep | None = None
        self._rest: InterfaceTrace | None = None
        self._readings: dict[float, MeterReading] = {}

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._stop()

    def begin(self, title: str, baseline: MeasuredSweep | None) -> None:
        """Begin a sweep. baseline: unpressed sweep to compare with."""
        self._title = self._press = title
        self._baseline, self._rest, self._readings = baseline, None, {}

    def turn(self, interface: str) -> None:
        """Print the readings of the interface before, and begin this one."""
        self._finish()
        if self._several:
            self._title = f"{self._press}, interface {interface}"
        self._rest = self._baseline and self._baseline.at(interface)

    def reading(self, frequency: float, reading: MeterReading) -> None:
        """Show a reading at a frequency in Hz."""
        from rich.live import Live

        self._readings[frequency] = reading
        if self._console.is_terminal and self._live is None:
            self._live = Live(self._table(), console=self._console, transient=True)
            self._live.start()
        elif self._live:
            self._live.update(self._table())

    def end(self, remarks: Sequence[str]) -> None:
        """End the sweep and print its faults."""
        self._finish()
        self._title = self._press
        for remark in remarks:
            self._print(remark)

    def _finish(self) -> None:
        self._stop()
        if self._reports_all and self._readings:
            self._print("done" + self._curves())
        self._readings = {}

    def _stop(self) -> None:
        if self._live:
            self._live.stop()
            self._live = None

    def _print(self, text: str) -> None:
        self._console.print(f"{self._title}: {text}", highlight=False, markup=False, soft_wrap=True)

    def _changes(self) -> dict[str, Real]:
        """Change against the unpressed skin, %; empty without an unpressed sweep."""
        if self._rest is None:
            return {}
        now, before = self._trace.quantities, self._rest.quantities
        names = self._rest.kind.with_errors
        return {name: percent_change(now[name], before[name]) for name in names}

    def _curves(self) -> str:
        """Change of each quantity against the unpressed skin: a curve if possible, and its span."""
        drawn = self._console.is_terminal and self._console.encoding.startswith("utf")
        changes = [
            f"{name} {sparkline(change) + ' ' if drawn else ''}"
            f"{np.nanmin(change):+.2g} to {np.nanmax(change):+.2g} %"
            for name, change in self._changes().items()
            if np.isfinite(change).any()
        ]
        return "; against the unpressed skin " + ", ".join(changes) if changes else ""

    @property
    def _trace(self) -> InterfaceTrace:
        """Readings of the present interface so far."""
        return InterfaceTrace(tuple(self._readings), tuple(self._readings.values()))

    def _table(self) -> Table:
        from rich.table import Column, Table

        changes, quantities = self._changes(), self._trace.quantities
        columns = [(*of, quantities[name]) for name, of in COLUMNS.items() if name in quantities]
        titles = [title for title, *_ in columns]
        names = ["f (kHz)", *titles, *(f"{name} (% change)" for name in changes)]
        right = [Column(name, justify="right") for name in names]
        table = Table(*right, "", title=self._title, box=None)
        for place, (frequency, reading) in list(enumerate(self._readings.items()))[-MAX_ROWS:]:
            table.add_row(
                f"{frequency / 1e3:.5g}",
                *(f"{values[place] * by:.{digits}g}" for _, by, digits, values in columns),
                *(f"{change[place]:+.2f}" for change in changes.values()),
                "" if reading.status is ReadingStatus.NORMAL else reading.status.meaning,
            )
        return table


def sparkline(values: Real) -> str:
    """Curve with one character per value, scaled to their span; a space for NaN."""
    low, high = np.nanmin(values), np.nanmax(values)
    top = len(LEVELS) - 1
    scaled = np.full(values.shape, top / 2) if high == low else top * (values - low) / (high - low)
    return "".join(LEVELS[round(each)] if np.isfinite(each) else " " for each in scaled.tolist())


@dataclass(frozen=True)
class PersonOperator:
    """A person at the keyboard who presses the skin and decides what is repeated."""

    console: Console
    show: RecordingDisplay

    def same_mounting(self, ago: str) -> bool:
        """Answer of the person."""
        prompt = f"The last sweep was taken {ago}. Was the skin mounted anew? (y, n, q: quit) "
        while not (answer := self._ask_choice(prompt, "yn")):
            pass
        return answer == "n"

    def press(self, step: PressStep, progress: StepStatus) -> bool:
        """Print what to press and wait for Enter; False if the step before is to be repeated."""
        place = f"row {step.row}, column {step.column}" if step.row > 0 else step.press
        what = "Release the skin" if step.row == 0 else f"Press {place} and hold it"
        again = "r: repeat the one before, " if progress.number else ""
        prompt = f"{progress.words}  {what}, then Enter ({again}q: quit) "
        if self._ask_choice(prompt, "r" if progress.number else "") == "r":
            return False
        self.show.begin(f"{progress.words}  press {step.press}", progress.baseline)
        return True

    def connect(self, interface: str) -> None:
        """Ask the person to connect the meter to an interface. Raises KeyboardInterrupt at `q`."""
        self._ask_choice(
            f"Keep the press, connect interface {interface}, then Enter (q: quit) ", ""
        )

    def kept(self, remarks: Sequence[str]) -> bool:
        """True if the sweep has no remarks, or the person keeps it all the same."""
        self.show.end(remarks)
        prompt = "Enter: redo, a: accept anyway, q: quit "
        return not remarks or self._ask_choice(prompt, "ra") == "a"

    def again(self, failure: MeterError) -> bool:
        """True if the person wants to try again."""
        self.show.end([str(failure)])
        return self._ask_choice("Enter: try again, n: give up, q: quit ", "n") != "n"

    def _ask_choice(self, prompt: str, letters: str) -> str:
        """One of the letters, or empty for Enter; asks until it is.

        `q` raises KeyboardInterrupt.
        """
        while True:
            answer = self._ask(prompt).lower()
            if answer == "q":
                raise KeyboardInterrupt
            if answer in ("", *letters):
                return answer

    def _ask(self, prompt: str) -> str:
        raise_pending_signal()
        try:  # without a stream it calls `input`, which drops what a signal raises as it flushes
            line = self.console.input(prompt, markup=False, stream=sys.stdin)
        except OSError:  # the terminal is gone
            line = ""
        if not line:
            raise KeyboardInterrupt
        return line.strip()
