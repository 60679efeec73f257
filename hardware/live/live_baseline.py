"""Baseline of live localization: unpressed sweeps, measured at the start and renewed slowly."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field

from ..record.measured_sweep import MeasuredSweep
from .touch_answer import NOTHING_PRESSED, TouchAnswer

MIN_PROBABILITY = 0.95
RENEWAL_COUNT = 5
OPENING_COUNT = 8
"""Number of first unpressed sweeps that identify the skin, as in recordings."""


@dataclass
class LiveBaseline:
    """The latest `wanted` unpressed sweeps (0 if none are needed), and those of the opening.

    Touches are compared with the latest. The opening identifies the skin, as in recordings. first:
    the first unpressed sweep, against which drift is measured.
    """

    wanted: int
    sweeps: deque[MeasuredSweep] = field(init=False)
    first: MeasuredSweep | None = field(default=None, init=False)
    _opening: list[MeasuredSweep] = field(default_factory=list, init=False)
    _unpressed_count: int = field(default=0, init=False)
    _candidate: MeasuredSweep | None = field(default=None, init=False)

    def __post_init__(self) -> None:
        self.sweeps = deque(maxlen=self.wanted)

    @property
    def complete(self) -> bool:
        """True if there are `wanted` sweeps."""
        return len(self.sweeps) >= self.wanted

    @property
    def renewal_due(self) -> bool:
        """True if the next sweep may renew the baseline and must be measured whole."""
        return self._unpressed_count == RENEWAL_COUNT - 2

    @property
    def opening(self) -> list[MeasuredSweep]:
        """The first OPENING_COUNT sweeps; the first `wanted` until there are so many."""
        return self._opening[
            : OPENING_COUNT if len(self._opening) >= OPENING_COUNT else self.wanted
        ]

    def use_recorded(self, sweeps: Sequence[MeasuredSweep]) -> None:
        """Use these earlier sweeps as the baseline, however few they are."""
        self.wanted = min(self.wanted, len(sweeps))
        self.forget()
        for sweep in sweeps:
            self.add(sweep)

    def add(self, sweep: MeasuredSweep) -> None:
        """Add an unpressed sweep."""
        self.first = self.first or sweep
        self.sweeps.append(sweep)
        if len(self._opening) < OPENING_COUNT:
            self._opening.append(sweep)

    def forget(self) -> None:
        """Start again: the next sweeps are unpressed."""
        self.sweeps, self._opening = deque(maxlen=self.wanted), []
        self.first, self._unpressed_count, self._candidate = None, 0, None

    def follow(self, sweep: MeasuredSweep | None, answer: TouchAnswer) -> bool:
        """True if a sweep renewed the baseline in place of the oldest of the latest.

        That happens once in RENEWAL_COUNT successive answers "nothing pressed" with a probability
        of at least MIN_PROBABILITY. The sweep is never the last of these, because a touch may begin
        in it.
        sweep: None if only a part was read.
        """
        if not says_unpressed(answer):
            self._unpressed_count, self._candidate = 0, None
            return False
        self.first = self.first or sweep
        self._unpressed_count += 1
        if self._unpressed_count < RENEWAL_COUNT:
            self._candidate = sweep or self._candidate
            return False
        taken, self._unpressed_count, self._candidate = self._candidate, 0, None
        if taken is None or not self.sweeps:
            return False
        self.add(taken)
        return True


def says_unpressed(answer: TouchAnswer) -> bool:
    """True if an answer says with certainty that nothing is pressed."""
    return answer.label == NOTHING_PRESSED and (answer.probability or 0) >= MIN_PROBABILITY
