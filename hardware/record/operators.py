"""Who presses the skin: what a recording asks of a person, or of a machine."""

from __future__ import annotations

import subprocess
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Protocol

from ..command_template import CommandTemplate
from ..meter.errors import MeterError, PressError
from ..meter.meter_reading import MeterReading
from .measured_sweep import MeasuredSweep
from .press_order import PressStep

Press = Callable[[PressStep], None]


@dataclass(frozen=True)
class StepStatus:
    """How far a recording is.

    number: of the step, from 0. total: steps. left: s until the end, None where nothing tells it
    yet. rest: the latest sound sweep of the skin at rest, if there is one.
    """

    number: int
    total: int
    left: float | None = None
    rest: MeasuredSweep | None = None

    @property
    def words(self) -> str:
        """Which step of how many, and the time left."""
        counted = f"{self.number + 1}/{self.total}"
        if self.left is None:
            return counted
        minutes, seconds = divmod(round(self.left), 60)
        return f"{counted}, {minutes}:{seconds:02d} min left"


class Operator(Protocol):
    """Leads through a recording."""

    def same_mounting(self, ago: str) -> bool:
        """Whether the skin is mounted as it was when the last sweep was taken, so long ago."""
        ...

    def press(self, step: PressStep, progress: StepStatus) -> bool:
        """True when the skin is pressed and held, False where the step before is to be done again.

        Raises PressError where it cannot be pressed, KeyboardInterrupt where the recording is to
        end here.
        """
        ...

    def turn(self, interface: str) -> None:
        """An interface is about to be connected; what comes next is of it."""
        ...

    def watch(self, frequency: float, reading: MeterReading) -> None:
        """A reading came, at a frequency in Hz."""
        ...

    def kept(self, remarks: Sequence[str]) -> bool:
        """A sweep is done; False to repeat it, which is offered where there are remarks."""
        ...

    def again(self, failure: MeterError) -> bool:
        """A sweep failed; True to try it again, False to stop there."""
        ...


class RecordingDisplay(Protocol):
    """Where the course of a recording is shown."""

    def begin(self, title: str, rest: MeasuredSweep | None) -> None: ...
    def turn(self, interface: str) -> None: ...
    def reading(self, frequency: float, reading: MeterReading) -> None: ...
    def end(self, remarks: Sequence[str]) -> None: ...


@dataclass
class MachineOperator:
    """Presses by a function, and repeats what failed or is unsound up to `retries` times.

    pause: s before the first repetition after a failure, doubled with each further one.
    """

    press_skin: Press
    show: RecordingDisplay
    retries: int = 3
    pause: float = 1.0
    repetitions: int = field(default=0, init=False)
    current: int = field(default=-1, init=False)

    def same_mounting(self, ago: str) -> bool:
        """A machine does not know."""
        return False

    def press(self, step: PressStep, progress: StepStatus) -> bool:
        """Have the machine press. Raises PressError where it fails."""
        if progress.number != self.current:
            self.current, self.repetitions = progress.number, 0
        self.press_skin(step)
        self.show.begin(f"{progress.words}  press {step.press}", progress.rest)
        return True

    def turn(self, interface: str) -> None:
        """Show it."""
        self.show.turn(interface)

    def watch(self, frequency: float, reading: MeterReading) -> None:
        """Show the reading."""
        self.show.reading(frequency, reading)

    def kept(self, remarks: Sequence[str]) -> bool:
        """Whether it is sound, or has been repeated often enough."""
        self.show.end(remarks)
        return not remarks or not self._count_repetition()

    def again(self, failure: MeterError) -> bool:
        """Whether it has not failed often enough."""
        self.show.end([str(failure)])
        if not self._count_repetition():
            return False
        time.sleep(self.pause * 2 ** (self.repetitions - 1))
        return True

    def _count_repetition(self) -> bool:
        self.repetitions += 1
        return self.repetitions <= self.retries


def press_by_command(command: str) -> Press:
    """Presses by running a command in which `{press}`, `{row}` and `{column}` are filled in.

    Raises InputError where the command cannot be understood; the press raises PressError where it
    cannot be run or ends with another code than 0.
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
    """Presses a virtual meter's skin through its control port."""
    from ..control_client import send_request

    def press(step: PressStep) -> None:
        send_request(control, "press", press=step.press)

    return press
