"""Measured times of a switch's turns."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from ..switch.switch import Switch

DEFAULT_SECONDS = 0.1
"""Assumed time of a turn before the first one, s."""


@dataclass
class TimedSwitch:
    """A switch whose turns are timed by a clock in s. last_seconds: time of the latest turn, s.

    total_seconds: total time of all calls, s.
    """

    switch: Switch
    clock: Callable[[], float]
    last_seconds: float = field(default=DEFAULT_SECONDS, init=False)
    total_seconds: float = field(default=0.0, init=False)

    @property
    def selected(self) -> str | None:
        """Connected interface, or None if unknown."""
        return self.switch.selected

    def select(self, name: str) -> None:
        """Connect an interface, and time it. Raises SwitchError."""
        before, begun = self.selected, self.clock()
        try:
            self.switch.select(name)
        finally:
            took = self.clock() - begun
            self.total_seconds += took
        if before not in (None, name):
            self.last_seconds = took

    def check_stayed(self) -> None:
        """Check that the switch has not turned, and time it. Raises SwitchError."""
        begun = self.clock()
        self.switch.check_stayed()
        self.total_seconds += self.clock() - begun

    def close(self) -> None:
        """Close the switch."""
        self.switch.close()
