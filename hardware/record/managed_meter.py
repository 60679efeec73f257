"""The source of readings of a command: connected when needed, its settings restored at the end."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from threading import Thread
from typing import Any, Self

from ...simulator.meters.accuracy_table import DERIVED_TABLE, read_table
from ...simulator.safe_text import say
from ...simulator.sweeps import InputError
from ...simulator.sweeps.reading_quantities import GAIN, IMPEDANCE, MAGNITUDE, ReadingKind
from ..event_counter import Report
from ..meter.conversation import ANSWER_TIMES
from ..meter.errors import MeterError, WrongMeterError
from ..meter.instruments import open_meter
from ..meter.lcr_meter import SETTINGS_STORE, not_restored_message, restore_settings, settings_text
from ..meter.meter_reading import MeterIdentity, ReadingSource
from ..meter.termination import interrupts_to_quit, raise_pending_signal
from ..reader.line_format import LineFormat, ReaderErrors, read_line_format
from ..reader.line_port import check_line_resource, is_line_resource
from ..reader.reader_driver import ReaderDriver, ReaderTerminals, ordered_frequencies
from ..switch.switch import Switch
from .measured_sweep import ConditionsOf, ErrorTable
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


FILE_NEEDED = (
    "needs --reader FILE.toml, which describes the lines that it sends; `rcskin meter new-reader "
    "FILE.toml` writes a commented one"
)


@dataclass(frozen=True)
class SourceSetup:
    """Source of readings that is opened later. connect: opens it.

    table, conditions: bounds on its errors; conditions None: those of the meter that answers.
    checks_laws: True if the bounds are known, so that laws of passive skins can be checked.
    terminals: the interfaces of a reader, which need no switch; None for a meter.
    """

    connect: Callable[[], ReadingSource]
    table: ErrorTable
    conditions: ConditionsOf | None = None
    checks_laws: bool = True
    terminals: ReaderTerminals | None = None

    def switch_or(self, make: Callable[[], Switch | None], given: bool) -> Switch | None:
        """The reader's terminals, or else the switch that `make` returns.

        given: True if an option names a switch. Raises InputError if a reader gets one.
        """
        if self.terminals is None:
            return make()
        if given:
            raise InputError(
                "a reader sends the readings of all its terminals; leave --switch, --switch-with "
                "and --settle out"
            )
        return self.terminals


@dataclass(frozen=True)
class SourceOptions:
    """Options of a command that name the source. accuracy: table of a meter. reader: file."""

    resource: str
    timeout: float
    baud: int
    accuracy: Path | None
    reader: Path | None

    @property
    def is_reader(self) -> bool:
        """True if the resource is a reader of lines."""
        return is_line_resource(self.resource)


def source_setup(
    options: SourceOptions,
    frequencies: Mapping[str, Sequence[float]],
    follows: bool = False,
    report: Report = lambda kind, text: None,
    settings: Mapping[str, Any] | None = None,
    kind: ReadingKind = IMPEDANCE,
) -> SourceSetup:
    """Source of these options. Raises InputError.

    frequencies: Hz, by interface. follows, report: see `ReaderDriver`. settings: requested settings
    of a meter. kind: of the readings that the scene has.
    """
    if not options.is_reader:
        if options.reader:
            raise InputError(
                f"--reader describes lines of serial:PORT or tcp:HOST:PORT, and the resource is "
                f"{options.resource!r}"
            )
        if kind is not IMPEDANCE:
            raise InputError(
                f"the scene reads the {kind.name}, and a meter reads impedances; take a reader at "
                "serial:PORT or tcp:HOST:PORT with --reader"
            )
        return SourceSetup(
            lambda: open_meter(options.resource, options.timeout, options.baud),
            read_table(options.accuracy or DERIVED_TABLE),
        )
    if settings:
        raise InputError(
            f"a reader of lines has no setting {', '.join(f'`{name}`' for name in settings)}; set "
            "the device itself, and leave the option out"
        )
    line_format = _line_format(options)
    if line_format.kind is not kind and (line_format.kind, kind) != (GAIN, MAGNITUDE):
        raise InputError(
            f"{options.reader}: describes lines of the {line_format.kind.name}, and the scene "
            f"reads the {kind.name}; change `quantity`, `phase`, or the scene's `reader`"
        )
    try:
        terminals = ReaderTerminals(list(ordered_frequencies(line_format, frequencies)))
    except InputError as error:
        raise InputError(f"{options.reader}: {error}") from error
    where = options.resource, line_format, frequencies, terminals, options.timeout
    errors = ReaderErrors(line_format)
    return SourceSetup(
        lambda: ReaderDriver(*where, follows, report, kind),
        errors,
        errors.conditions,
        errors.known,
        terminals,
    )


def _line_format(options: SourceOptions) -> LineFormat:
    check_line_resource(options.resource)
    if options.reader is None:
        raise InputError(f"{options.resource}: a reader of lines {FILE_NEEDED}")
    if options.accuracy is not None:
        raise InputError(
            "--accuracy is a table of a meter; a reader's file states `error` and `phase_error`"
        )
    return read_line_format(options.reader)
