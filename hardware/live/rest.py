"""The skin at rest, as live localization knows it: measured at the start, then followed slowly."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field

from ..record.sweep import Sweep
from .answer import NOTHING_PRESSED, Answer

SURE = 0.95
RENEWED_AFTER = 5


@dataclass
class Rest:
    """The latest sweeps at rest, at least `wanted` of them, which is 0 where none are needed.

    first: what the skin was at the beginning, against which drift is told.
    """

    wanted: int
    sweeps: deque[Sweep] = field(init=False)
    first: Sweep | None = field(default=None, init=False)
    _quiet: int = field(default=0, init=False)

    def __post_init__(self) -> None:
        self.sweeps = deque(maxlen=self.wanted)

    @property
    def complete(self) -> bool:
        """Whether there are as many as wanted."""
        return len(self.sweeps) >= self.wanted

    @property
    def due(self) -> bool:
        """Whether the next sweep is to give way for an older one, if it is at rest."""
        return self._quiet >= RENEWED_AFTER - 1

    def give(self, sweeps: Sequence[Sweep]) -> None:
        """Take these, measured earlier, for the skin at rest, however few they are."""
        self.sweeps, self.first = deque(sweeps, maxlen=len(sweeps)), sweeps[0]
        self.wanted = min(self.wanted, len(sweeps))

    def add(self, sweep: Sweep) -> None:
        """Take a sweep for one at rest."""
        self.first = self.first or sweep
        self.sweeps.append(sweep)

    def forget(self) -> None:
        """Begin anew: the next sweeps are of the skin at rest."""
        self.sweeps = deque(maxlen=self.wanted)
        self.first, self._quiet = None, 0

    def follow(self, sweep: Sweep, answer: Answer) -> bool:
        """Whether the oldest sweep gave way to this one.

        That happens once after every RENEWED_AFTER answers in a row that say "nothing pressed" with
        a probability of at least SURE.
        """
        if not at_rest(answer):
            self._quiet = 0
            return False
        self.first = self.first or sweep
        self._quiet += 1
        if not self.sweeps or self._quiet < RENEWED_AFTER:
            return False
        self._quiet = 0
        self.sweeps.append(sweep)
        return True


def at_rest(answer: Answer) -> bool:
    """Whether an answer is sure that nothing is pressed."""
    return answer.label == NOTHING_PRESSED and (answer.probability or 0) >= SURE
