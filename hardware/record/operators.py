"""Operators, which press the skin during a recording: a person or a machine."""

from __future__ import annotations

import subprocess
import time
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field
from itertools import product
from pathlib import Path
from typing import Protocol

from ...simulator.sweeps import UNPRESSED, InputError, inputs
from ...simulator.sweeps.free_space import check_memory
from ...simulator.sweeps.press_text import parse_touches, written_pixel
from ..command_template import CommandTemplate
from ..meter.errors import MeterError, PressError
from ..meter.meter_reading import MeterReading
from .measured_sweep import MeasuredSweep


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
