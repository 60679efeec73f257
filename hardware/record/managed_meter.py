"""The meter of a command: connected when needed, set as at its begin, put back at its end."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from threading import Thread
from typing import Any

from ..meter.conversation import ANSWER_TIMES
from ..meter.errors import MeterError, WrongMeterError
from ..meter.hioki import TIMING, Meter
from ..meter.meter_identity import MeterIdentity
from ..meter.original_settings import SETTINGS_STORE, not_restored_message, settings_text
from ..meter.settings_snapshot import restore_settings
from ..meter.termination import raise_pending_signal, shielded
from .recording_journal import RecordingHeader, RecordingJournal

GIVE_UP_AFTER, SLOW_LINE_FACTOR, PAUSE, POLL_INTERVAL = 2.0, 2.0, 0.2, 0.05
"""While settings are put back: seconds without any answer after which the meter is given up, beyond
so many times the longest that an answer took; and between tries to reach it, and looks at that."""
TRIES = 20
"""Connections in which they may be put back: of a meter that answers, and never as it should."""
LOG = logging.getLogger(__name__)


@dataclass
class ManagedMeter:
    """One meter, through all its connections. tell: told what could not be put back.

    journal: keeps how the meter was found, on the disk before anything is set; what is in it from a
    command that was killed is put back at the end of this one.
    """

    connect: Callable[[], Meter]
    header: RecordingHeader | None = None
    tell: Callable[[str], None] = lambda text: None
    journal: RecordingJournal | None = None
    meter: Meter | None = field(default=None, init=False)
    _found: dict[str, Any] = field(default_factory=dict, init=False)
    _identity: str = field(default="", init=False)
    _has_left: bool = field(default=False, init=False)

    def __post_init__(self) -> None:
        if self.journal and (kept := self.journal.original_settings()):
            self._identity, self._found = kept
            LOG.warning(
                "%s: a command that was cut off left the meter changed; at the end it is put back "
                "to what it was at first: %s",
                self.journal.folder,
                settings_text(self._found),
            )

    def ready(self) -> Meter:
        """The meter, set up. Raises MeterError, WrongMeterError where it is another than before."""
        raise_pending_signal()
        if self.meter is None:
            self.meter = self._connected()
            try:
                if self.header is not None:
                    restore_settings(self.meter, self.header.settings)
            except BaseException:
                self.close()
                raise
        return self.meter

    def close(self) -> None:
        """Let the connection go; `ready` connects anew."""
        if self.meter:
            self.meter.close()
            self.meter = None

    def release(self) -> None:
        """Put back all settings as they were found, over a new connection if need be, and let go.

        No signal ends that, only a meter that does not answer or a user who insists. What the meter
        did not confirm is told.
        """
        with shielded() as insisting:
            if self.meter or self._found:
                parting = Thread(target=self._put_back, daemon=True)
                begun = time.monotonic()
                parting.start()
                while parting.is_alive() and self._patient(begun) and not insisting():
                    parting.join(POLL_INTERVAL)
                self._has_left = True
            if self._found:
                self.tell(not_restored_message(self._found))
            elif self.journal:
                self.journal.drop_original_settings()
            self.close()

    def found(self, identity: MeterIdentity) -> dict[str, Any]:
        """As of `Keeper`."""
        expected = self.header.meter if self.header else self._identity or identity.text
        if identity.text != expected:
            raise WrongMeterError(
                f"the recording began with {expected}, now {identity.text} answers; check which "
                "meter is connected"
            )
        self._identity = expected
        return self._found

    def note_found(self) -> None:
        """As of `Keeper`."""
        if self.journal:
            self.journal.save_original_settings(self._identity, self._found)

    def _patient(self, begun: float) -> bool:
        """Whether the meter answered lately, for a line as slow as it is."""
        silent = time.monotonic() - max(begun, ANSWER_TIMES.at)
        return silent < GIVE_UP_AFTER + SLOW_LINE_FACTOR * ANSWER_TIMES.longest + self._under_way()

    def _under_way(self) -> float:
        """Seconds that a reading may take which nobody waits for any more."""
        known = self.meter is not None and self.meter.known.keys() >= set(TIMING)
        return self.meter.seconds if self.meter and known else 0.0

    def _put_back(self) -> None:
        for _ in range(TRIES):
            with suppress(MeterError):
                self.meter = self.meter or self._connected()
                self.meter.put_back()
                return
            self.close()
            if self._has_left:
                return
            time.sleep(PAUSE)

    def _connected(self) -> Meter:
        """The meter, which knows how it was found at first."""
        before = SETTINGS_STORE.set(self)
        try:
            return self.connect()
        finally:
            SETTINGS_STORE.reset(before)
