"""The meter of a recording: connected when needed, set as at its begin, put back at its end."""

from __future__ import annotations

import atexit
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from threading import Thread
from typing import Any

from ..meter.errors import MeterError, WrongMeterError
from ..meter.hioki import TIMING, Meter
from ..meter.snapshot import restore
from .journal import Header

PARTING, PAUSE = 2.0, 0.2
"""Seconds that a meter has to take back its settings, and between tries to reach it."""


@dataclass
class Station:
    """One meter, through all its connections. tell: told what could not be put back."""

    connect: Callable[[], Meter]
    header: Header | None = None
    tell: Callable[[str], None] = lambda text: None
    meter: Meter | None = None
    _found: dict[str, Any] = field(default_factory=dict, init=False)
    _identity: str = field(default="", init=False)
    _left: bool = field(default=False, init=False)

    def ready(self) -> Meter:
        """The meter, set up. Raises MeterError, WrongMeterError where it is another than before."""
        if self.meter is None:
            meter = self._connected()
            self.meter = meter
            atexit.register(self.leave)  # where the process is ended by force
            try:
                if self.header is not None:
                    restore(meter, self.header.settings)
            except BaseException:
                self.close()
                raise
        return self.meter

    def close(self) -> None:
        """Let the connection go; `ready` connects anew."""
        if self.meter:
            self._found = self.meter.found or {}
            self.meter.close()
            self.meter = None

    def leave(self) -> None:
        """Put back all settings as they were found, over a new connection if need be, and let go.

        One that does not answer in time is left as it is, and told of.
        """
        if self.meter or self._found:
            parting = Thread(target=self._put_back, daemon=True)
            parting.start()
            parting.join(PARTING + self._under_way())
            self._left = True
            found = self.meter.found if self.meter else self._found
            if found:
                self.tell(f"the meter does not answer: {', '.join(found)} could not be put back")
        self.close()
        self._found = {}
        atexit.unregister(self.leave)

    def _under_way(self) -> float:
        """Seconds that a reading may take which nobody waits for any more."""
        known = self.meter is not None and self.meter.known.keys() >= set(TIMING)
        return self.meter.seconds if self.meter and known else 0.0

    def _put_back(self) -> None:
        while not self._left:
            with suppress(MeterError):
                self.meter = self.meter or self._connected()
                self.meter.put_back()
                return
            self.close()
            time.sleep(PAUSE)

    def _connected(self) -> Meter:
        """The meter of before, which knows how it was found at first."""
        meter = self.connect()
        expected = self.header.meter if self.header else self._identity or meter.identity.text
        if meter.identity.text != expected:
            meter.__exit__()
            raise WrongMeterError(
                f"{meter.talk.resource}: the recording began with {expected}, now "
                f"{meter.identity.text} answers; check which meter is connected"
            )
        self._identity = expected
        meter.found = {**(meter.found or {}), **self._found}
        return meter
