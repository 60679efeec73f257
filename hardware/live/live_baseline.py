"""The skin at rest, as live localization knows it: measured at the start, then followed slowly."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field

from ..record.measured_sweep import MeasuredSweep
from .touch_answer import NOTHING_PRESSED, TouchAnswer

SURE = 0.95
RENEWED_AFTER = 5
FIRSTS = 8
"""Sweeps at rest that show which skin it is, as in recordings: the first of a session."""


@dataclass
class LiveBaseline:
    """The latest `wanted` sweeps at rest, 0 where none are needed, and those of the opening.

    Touches are told against the latest, and the opening shows which skin it is: as of recordings,
    whose sweeps at rest are known as such. first: what the skin was at the beginning, against which
    drift is told.
    """

    wanted: int
    sweeps: deque[MeasuredSweep] = field(init=False)
    first: MeasuredSweep | None = field(default=None, init=False)
    _firsts: list[MeasuredSweep] = field(default_factory=list, init=False)
    _quiet: int = field(default=0, init=False)
    _candidate: MeasuredSweep | None = field(default=None, init=False)

    def __post_init__(self) -> None:
        self.sweeps = deque(maxlen=self.wanted)

    @property
    def complete(self) -> bool:
        """Whether there are as many as wanted."""
        return len(self.sweeps) >= self.wanted

    @property
    def due(self) -> bool:
        """Whether the next sweep may become one at rest, and is to be measured whole."""
        return self._quiet == RENEWED_AFTER - 2

    @property
    def opening(self) -> list[MeasuredSweep]:
        """The first FIRSTS once there are as many, and the first `wanted` before."""
        return self._firsts[: FIRSTS if len(self._firsts) >= FIRSTS else self.wanted]

    def give(self, sweeps: Sequence[MeasuredSweep]) -> None:
        """Take these, measured earlier, for the skin at rest, however few they are."""
        self.wanted = min(self.wanted, len(sweeps))
        self.forget()
        for sweep in sweeps:
            self.add(sweep)

    def add(self, sweep: MeasuredSweep) -> None:
        """Take a sweep for one at rest."""
        self.first = self.first or sweep
        self.sweeps.append(sweep)
        if len(self._firsts) < FIRSTS:
            self._firsts.append(sweep)

    def forget(self) -> None:
        """Begin anew: the next sweeps are of the skin at rest."""
        self.sweeps, self._firsts = deque(maxlen=self.wanted), []
        self.first, self._quiet, self._candidate = None, 0, None

    def follow(self, sweep: MeasuredSweep | None, answer: TouchAnswer) -> bool:
        """Whether a sweep was taken for one at rest, in the place of the oldest of the latest.

        That happens once in RENEWED_AFTER answers in a row that say "nothing pressed" with a
        probability of at least SURE. It is never the last of them, in which a touch may begin.
        sweep: None where only part of one was read.
        """
        if not says_unpressed(answer):
            self._quiet, self._candidate = 0, None
            return False
        self.first = self.first or sweep
        self._quiet += 1
        if self._quiet < RENEWED_AFTER:
            self._candidate = sweep or self._candidate
            return False
        taken, self._quiet, self._candidate = self._candidate, 0, None
        if taken is None or not self.sweeps:
            return False
        self.add(taken)
        return True


def says_unpressed(answer: TouchAnswer) -> bool:
    """Whether an answer is sure that nothing is pressed."""
    return answer.label == NOTHING_PRESSED and (answer.probability or 0) >= SURE
