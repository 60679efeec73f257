"""The meter of a command: connected when needed, its settings restored at the end."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from threading import Thread
from typing import Any, Self

from ...simulator.safe_text import say
from ..meter.errors import MeterError, WrongMeterError
from ..meter.link.conversation import ANSWER_TIMES
from ..meter.meter_reading import MeterIdentity
from ..meter.reading_source import ReadingSource
from ..meter.restoring.original_settings import (
    SETTINGS_STORE,
    not_restored_message,
    restore_settings,
    settings_text,
)
from ..meter.restoring.termination import interrupts_to_quit, raise_pending_signal
from ..switch.switch import Switch
from .recording_journal import RecordingHeader, RecordingJournal

GIVE_UP_AFTER, SLOW_LINE_FACTOR, PAUSE, POLL_INTERVAL = 2.0, 2.0, 0.2, 0.05
"""Times while settings are restored, s. The meter is given up after GIVE_UP_AFTER without any
answer, plus SLOW_LINE_FACTOR times the longest delay of an answer. PAUSE: between connections."""
TRIES = 20
"""Number of connections in which the settings may be restored."""
LOG = logging.getLogger(__name__)
RESTORING = (
    "rcskin: the meter's settings are being restored; Ctrl-C {left} more, a second apart, leaves "
    "them changed"
)


@dataclass
class ManagedMeter:
    """One meter through all its connections, from the first one to its release.

    All work with it stands in `with station, interruptible():`, in that order: a signal raises only
    in the inner block, so nothing interrupts the release at the end of the outer one.

    report: reports settings that could not be restored. journal: saves the original settings before
    any is changed. Those of a killed command are restored at the end of this one. switch: is closed
    with the meter.
    """

    connect: Callable[[], ReadingSource]
    header: RecordingHeader | None = None
    report: Callable[[str], None] = lambda text: None
    journal: RecordingJournal | None = None
    switch: Switch | None = None
    meter: ReadingSource | None = field(default=None, init=False)
    _original: dict[str, Any] = field(default_factory=dict, init=False)
    _identity: str = field(default="", init=False)
    _given_up: bool = field(default=False, init=False)

    def __post_init__(self) -> None:
        if self.journal and (kept := self.journal.original_settings()):
            self._identity, self._original = kept
            LOG.warning(
                "%s: a killed command left the meter's settings changed; this command restores the "
                "original ones at its end: %s",
                self.journal.folder,
                settings_text(self._original),
            )

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.release()

    def ready(self) -> ReadingSource:
        """The meter, set up.

        Raises MeterError; WrongMeterError if it is not the meter of before.
        """
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
        """Close the connection. `ready` opens a new one."""
        if self.meter:
            self.meter.close()
            self.meter = None

    def release(self) -> None:
        """Restore all original settings, over a new connection if necessary, and close.

        Only a meter without answers or a user who insists ends that early. Settings that the meter
        did not confirm are reported.
        """
        try:
            if self.meter or self._original:
                self._restore_patiently()
            if self._original:
                self.report(not_restored_message(self._original))
            elif self.journal:
                self.journal.drop_original_settings()
        finally:
            self.close()
            if self.switch:
                self.switch.close()

    def original_settings(self, identity: MeterIdentity) -> dict[str, Any]:
        """Original settings, see `OriginalSettingsStore`."""
        expected = self.header.meter if self.header else self._identity or identity.text
        if identity.text != expected:
            raise WrongMeterError(
                f"the recording began with {expected}, now {identity.text} answers; check which "
                "meter is connected"
            )
        self._identity = expected
        return self._original

    def save_original(self) -> None:
        """Save the original settings, see `OriginalSettingsStore`."""
        if self.journal:
            self.journal.save_original_settings(self._identity, self._original)

    def _answers_recently(self, begun: float) -> bool:
        """True if the meter answered recently, in view of how slow its line is."""
        silent = time.monotonic() - max(begun, ANSWER_TIMES.at)
        return (
            silent < GIVE_UP_AFTER + SLOW_LINE_FACTOR * ANSWER_TIMES.longest + self._busy_seconds()
        )

    def _busy_seconds(self) -> float:
        """Longest time of a reading that may still be running, s."""
        return self.meter.busy_seconds if self.meter else 0.0

    def _restore_patiently(self) -> None:
        """Restore in a thread, and wait while the meter answers and the user does not insist."""
        restoring, begun = Thread(target=self._restore, daemon=True), time.monotonic()
        restoring.start()
        left = interrupts_to_quit()
        while restoring.is_alive() and self._answers_recently(begun) and left > 0:
            restoring.join(POLL_INTERVAL)
            before, left = left, interrupts_to_quit()
            if 0 < left < before:
                say(RESTORING.format(left=f"{left} times" if left > 1 else "once"), err=True)
        self._given_up = True

    def _restore(self) -> None:
        for _ in range(TRIES):
            with suppress(MeterError):
                self.meter = self.meter or self._connected()
                self.meter.restore_original()
                return
            self.close()
            if self._given_up:
                return
            time.sleep(PAUSE)

    def _connected(self) -> ReadingSource:
        """The meter over a new connection, with this object as its store of original settings."""
        before = SETTINGS_STORE.set(self)
        try:
            return self.connect()
        finally:
            SETTINGS_STORE.reset(before)
