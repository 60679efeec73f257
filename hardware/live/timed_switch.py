"""Measured times of a switch's turns."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from ..switch.switch import Switch

DEFAULT_SECONDS = 0.1
"""Assumed time of a turn before the first one, s."""


@dataclass
class TimedSwitch:
    """A switch whose turns are timed by a clock in s. latest: time of the latest turn, s.

    spent: total time of all calls, s.
    """

    switch: Switch
    clock: Callable[[], float]
    latest: float = field(default=DEFAULT_SECONDS, init=False)
    spent: float = field(default=0.0, init=False)

    @property
    def selected(self) -> str | None:
        """As of `Switch`."""
        return self.switch.selected

    def select(self, name: str) -> None:
        """As of `Switch`."""
        before, begun = self.selected, self.clock()
        try:
            self.switch.select(name)
        finally:
            took = self.clock() - begun
            self.spent += took
        if before not in (None, name):
            self.latest = took

    def check_stayed(self) -> None:
        """As of `Switch`."""
        begun = self.clock()
        self.switch.check_stayed()
        self.spent += self.clock() - begun

    def close(self) -> None:
        """As of `Switch`."""
        self.switch.close()
