"""Live sessions without a screen: what is answered when, and sweeps that were measured before."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from rcskin.hardware.live.live_meter import LiveMeter
from rcskin.hardware.live.live_session import TimedAnswer
from rcskin.hardware.record.measured_sweep import MeasuredSweep, Watch


@dataclass
class Told:
    """What is shown: answers with the times when they came, s."""

    stage: Any

    def __post_init__(self) -> None:
        self.answers: list[tuple[float, str]] = []

    def reading(self, frequency: float, reading: object) -> None:
        """Not of interest."""

    def answer(self, moment: TimedAnswer) -> None:
        """An answer came."""
        self.answers.append((self.stage.now, moment.answer.label))

    def no_answer(self, why: str) -> None:
        """Not of interest."""

    def note(self, text: str) -> None:
        """Not of interest."""


class Replay:
    """A link whose sweeps were measured before: (begun, ended, sweep). now: s."""

    sweeps = False
    """The readings had times of their own, as of a meter that does not sweep by itself."""

    def __init__(self, link: LiveMeter, sweeps: list[tuple[float, float, MeasuredSweep]]) -> None:
        self.checker, self.header, self.now, self.switch = link.checker, link.header, 0.0, None
        self.left = list(reversed(sweeps))

    def ready(self) -> None:
        """When the next sweep begins."""
        self.now = self.left[-1][0]

    def sweep(self, watch: Watch) -> MeasuredSweep:
        """The next."""
        _, self.now, sweep = self.left.pop()
        return sweep
