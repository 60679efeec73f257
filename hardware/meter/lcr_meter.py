"""Base class of all LCR meters: settings, readings, corrections, and settings that are restored."""

from __future__ import annotations

import logging
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from contextvars import ContextVar
from typing import TYPE_CHECKING, Any, ClassVar, Protocol, Self, TypeVar

from ...simulator.meters.accuracy_table import METER_BANDS
from ...simulator.sweeps import InputError
from .conversation import Connection, Conversation
from .errors import (
    CorrectionError,
    GarbledError,
    MeterError,
    NoAnswerError,
    RefusedError,
    RestartedError,
    changed_setting,
)
from .meter_reading import MeterIdentity, ReadingSource, SettingValue, parse_identity
from .setting import MeterProperty, Setting, SettingsOwner
from .termination import interruptible, shielded

if TYPE_CHECKING:
    from ...simulator.meters.accuracy_table import AccuracyTable, ReadingConditions
    from .meter_reading import MeterReading

MAX_RESTARTS = 3
"""Number of restarts of the meter that are allowed during the restoring."""


class OriginalSettingsStore(Protocol):
    """Store of a meter's original settings, shared by successive connections."""

    def original_settings(self, identity: MeterIdentity) -> dict[str, Any]:
        """Original settings of a meter; whoever changes a setting adds its original value.

        Raises WrongMeterError if the store holds those of another meter.
        """
        ...

    def save_original(self) -> None:
        """Save the original settings: one was added, and the meter is about to change."""
        ...


SETTINGS_STORE: ContextVar[OriginalSettingsStore | None] = ContextVar("keeper", default=None)
"""Store for the meters that are opened. None: each meter restores its own on release."""


def restore_original(meter: SettingsOwner) -> None:
    """Restore all changed settings.

    `original` then holds the settings that the meter did not confirm. Raises MeterError if the
    connection fails or the meter restarts too often; another call continues from there.
    """
    kept, meter.original = meter.original or {}, None
    everything = dict(kept)
    try:
        with suppress(MeterError):
            meter.talk.check_events("the end")  # drops a pending answer
        for _ in range(MAX_RESTARTS):
            with suppress(RestartedError):
                return _restore_each(meter, kept)
            kept.update(everything)
        _restore_each(meter, kept)
    finally:
        meter.original = kept


def _restore_each(meter: SettingsOwner, kept: dict[str, Any]) -> None:
    """Restore each setting in `kept`, and remove those that the meter confirms.

    A setting without a proper answer does not stop the others; its failure is raised at the end.
    """
    last, failures = meter.restored_last, []
    for name in sorted(kept, key=lambda name: name in last and 1 + last.index(name)):
        setting = getattr(type(meter), name, None)
        if not isinstance(setting, Setting):
            continue
        try:
            with suppress(RefusedError, InputError, TypeError, ValueError):  # may be of a file
                setting.restore(meter, kept[name])
                del kept[name]
        except (NoAnswerError, GarbledError) as failure:
            failures.append(failure)
    if failures:
        raise failures[0]


def not_restored_message(settings: Mapping[str, Any]) -> str:
    """Message about settings that were not restored. settings: their original values."""
    return (
        "the meter did not confirm these original settings; check them on the meter: "
        f"{settings_text(settings)}"
    )


def settings_text(settings: Mapping[str, Any]) -> str:
    """Settings as text: `name = value, ...`."""
    return ", ".join(f"{name} = {_value_text(value)}" for name, value in settings.items())


def _value_text(value: Any) -> str:
    """One value, or the values of all ranges or registers; equal values appear once."""
    each = value if isinstance(value, (tuple, list)) else (value,)
    return " ".join(map(str, dict.fromkeys(each) if len(set(each)) == 1 else each))


def restore_settings(meter: ReadingSource, settings: Mapping[str, SettingValue]) -> None:
    """Restore the settings of a snapshot.

    Raises CorrectionError if one that cannot be set differs, such as the open or short correction.
    """
    meter.apply_settings(settings)
    now = meter.snapshot()
    for name in meter.reported:
        if now[name] != settings[name]:
            again = "acquire it again (`rcskin meter correct`)"
            raise CorrectionError(
                f"{meter.resource}: {name.replace('_', ' ')} was {settings[name]} when the "
                f"recording began and is {now[name]} now; "
                f"{again if name.endswith('_correction') else 'set it again on the meter'}"
            )


def require_settings(meter: ReadingSource, settings: Mapping[str, SettingValue]) -> None:
    """Raises RestartedError if any setting differs from the snapshot."""
    now = meter.snapshot()
    for name, value in settings.items():
        if now.get(name) != value:
            raise changed_setting(meter.resource, name, now.get(name), value)


Result = TypeVar("Result")
SEARCHES = 3
"""Measurements that one reading may take with automatic range."""
LOG = logging.getLogger(__name__)


class LcrMeter(ABC):
    """An LCR meter. Each set is followed by a check of the event register.

    Setting a property raises InputError if the value is not allowed, RefusedError if the meter
    refuses it, RestartedError if the meter was switched off and on. Everything may raise
    MeterError.

    model: name in `*IDN?`, with a band in METER_BANDS. needed: settings with the values that every
    reading needs, in the order in which `set_up` sets them. meaning: those of `needed` that decide
    which quantities the numbers are; the meter answers them with each reading. settable: settings
    that a reading depends on, in the order in which they are set. reported: properties in a
    snapshot that cannot be set.
    timing: settings that the time of a reading depends on. restored_last: settings that are
    restored after all others, in this order. extents: words for the extent of a correction; the
    last one ends it. sweeps: True if the meter sweeps by itself. error_query: query of the oldest
    error in the meter's queue, if it has one.
    """

    model: str
    needed: ClassVar[Mapping[str, Any]] = {}
    meaning: tuple[str, ...] = ()
    settable: tuple[str, ...]
    reported: tuple[str, ...] = ("open_correction", "short_correction")
    timing: tuple[str, ...]
    restored_last: tuple[str, ...]
    extents: ClassVar[tuple[str, ...]]
    sweeps: bool = False
    error_query: str = ""

    frequency: ClassVar[Setting[float]]
    range: ClassVar[Setting[Any]]
    auto_range: ClassVar[Setting[bool]]
    open_correction: ClassVar[MeterProperty[Any]]
    short_correction: ClassVar[MeterProperty[Any]]

    def __init__(self, connection: Connection, identity: MeterIdentity | None = None) -> None:
        self.talk = Conversation(connection, self.error_query)
        self.identity = identity or self.talk.query("*IDN?", parse_identity)
        self.original: dict[str, Any] | None = None
        self.cached: dict[str, Any] = {}
        self._store = SETTINGS_STORE.get()
        self._sweep_seconds = 0.0

    @property
    def resource(self) -> str:
        """Name of the resource."""
        return self.talk.resource

    @property
    def band(self) -> tuple[float, float]:
        """Lowest and highest frequency, Hz."""
        return METER_BANDS[self.model]

    def nearest(self, frequency: float) -> float:
        """Frequency in Hz that the meter has after this one was set, as it answers."""
        self.frequency = frequency
        return self.frequency

    def set_up(self) -> None:
        """Set the meter up so that each reading is new and complete.

        Range, level, speed and correction do not change. Raises MeterError.
        """
        for name, value in self.needed.items():
            setattr(self, name, value)

    def measure(
        self,
        message: str,
        parse: Callable[[str, dict[str, Any]], Result],
        seconds: float,
        also: Sequence[str] = (),
    ) -> Result:
        """Result of a message that measures, parsed from its answer and the values of settings.

        The meter answers the settings in `meaning` and `also` in the same message as the numbers,
        so that no change of a quantity remains unnoticed. seconds: time allowed beyond the
        time-out. Raises RestartedError if one of `meaning` changed, NoAnswerError with the settings
        from which the time follows, and the errors of `query_checked`.
        """
        settings = [getattr(type(self), name) for name in (*self.meaning, *also)]

        def parsed(answer: str) -> Result:
            text, *answers = answer.rsplit(";", len(settings))
            values = [each.read_answer(one) for each, one in zip(settings, answers, strict=True)]
            for name, value in zip(self.meaning, values, strict=False):
                if value != self.needed[name]:
                    raise changed_setting(self.resource, name, value, self.needed[name])
            return parse(text, {each.name: one for each, one in zip(settings, values, strict=True)})

        try:
            queries = ";".join([message, *(each.query for each in settings)])
            return self.talk.query_checked(queries, parsed, seconds)
        except NoAnswerError as failure:
            known = {name: self.cached[name] for name in self.timing if name in self.cached}
            raise NoAnswerError(
                f"{failure}; the time that the meter has follows from {settings_text(known)}"
            ) from failure

    @abstractmethod
    def read_at(self, frequency: float) -> MeterReading:
        """Reading at a frequency in Hz, never older than this call.

        Raises InputError if the model does not reach the frequency, GarbledError if the meter is at
        another one, FailedReadingError if the meter reports a failure, RefusedError if the meter
        refused the trigger (its answer would be stale), RestartedError, or another MeterError.
        """

    def read_sweep(self, frequencies: Sequence[float]) -> list[MeterReading]:
        """Readings at frequencies in Hz, none older than this call. Raises as `read_at`."""
        return [self.read_at(frequency) for frequency in frequencies]

    @classmethod
    @abstractmethod
    def reading_seconds(cls, timing: Mapping[str, Any]) -> float:
        """Approximate time of a reading, s. timing: values of the settings of that name."""

    @classmethod
    @abstractmethod
    def conditions(
        cls, settings: Mapping[str, Any], frequency: float, Z: complex, table: AccuracyTable
    ) -> ReadingConditions:
        """Conditions of a reading of Z [ohm], in the words of an accuracy table.

        settings: a snapshot.
        """

    @abstractmethod
    def start_correction(self, kind: str, extent: str) -> None:
        """Start to acquire a correction (open or short), or end it. extent: one of `extents`."""

    @abstractmethod
    def correction_done(self) -> bool:
        """True if the started correction has ended."""

    @abstractmethod
    def correction_fault(self, kind: str) -> str:
        """Fault of the correction that has ended; empty if there is none."""

    @abstractmethod
    def cancel_correction(self, kind: str) -> None:
        """Cancel the started correction."""

    def prepare(self) -> None:
        """Set the meter up for readings.

        From now on `original` collects the original value of each setting that changes. Raises
        MeterError.
        """
        if self.original is None:
            self.original = self._store.original_settings(self.identity) if self._store else {}
        self.talk.send("*CLS")
        self.set_up()

    def snapshot(self) -> dict[str, SettingValue]:
        """All settings that a reading depends on; the range only if fixed. Raises MeterError."""
        texts = {name: self._text(name, getattr(self, name)) for name in self.needed}
        values = {name: getattr(self, name) for name in (*self.settable, *self.reported)}
        if values.get("auto_range"):
            del values["range"]
        return {**values, **texts}

    def apply_settings(self, settings: Mapping[str, Any]) -> None:
        """Set those of the settings that can be set, in the order of `settable`.

        Raises InputError if the meter lacks a setting, a value is not allowed, or readings need
        another one; MeterError if the meter fails.
        """
        named = self.own_settings(settings)
        fixed = {name: self._text(name, value) for name, value in self.needed.items()}
        for name, value in named.items():
            if name in fixed and value != fixed[name]:
                raise InputError(f"`{name}` must be {fixed[name]} for readings, got {value}")
            if name not in (*fixed, *self.settable, *self.reported):
                raise InputError(
                    f"meter {self.model} has no setting `{name}`; it has {', '.join(self.settable)}"
                )
        for name in (*self.needed, *self.settable):
            if name in named:
                setattr(self, name, self.needed.get(name, named[name]))

    def _text(self, name: str, value: Any) -> str:
        """Value of a setting as text, which a journal can hold."""
        return str(getattr(type(self), name).allowed.write(value))

    def own_settings(self, requested: Mapping[str, Any]) -> dict[str, Any]:
        """Requested settings in this meter's names. Raises InputError if it has none for one."""
        return dict(requested)

    def save_original(self) -> None:
        """Save the original settings, if there is a store."""
        if self._store:
            self._store.save_original()

    def restore_original(self) -> None:
        """Restore all changed settings, see `restore_original`."""
        restore_original(self)

    def release(self) -> None:
        """Restore the settings, log those not confirmed, and close.

        A store restores them itself.
        """
        try:
            if self._store is None:
                with suppress(MeterError):
                    self.restore_original()
                if self.original:
                    LOG.warning("%s: %s", self.resource, not_restored_message(self.original))
        finally:
            self.close()

    @property
    def seconds(self) -> float:
        """Approximate time of a reading with the present settings, s."""
        for name in self.timing:
            if name not in self.cached:
                self.cached[name] = getattr(self, name)
        return self.reading_seconds({name: self.cached[name] for name in self.timing})

    @property
    def max_seconds(self) -> float:
        """Longest time of a reading after `prepare`, s."""
        return 0.0 if self.original is None else SEARCHES * self.seconds

    @property
    def busy_seconds(self) -> float:
        """Time that a running reading or sweep may still take, s. Sends no query."""
        known = self.cached.keys() >= set(self.timing)
        return max(self._sweep_seconds, self.seconds if known else 0.0)

    def close(self) -> None:
        """Close the connection. Closing twice does no harm."""
        self.talk.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.release()


ADVICE = {
    "open": "check that the leads are apart, connected to nothing, and shielded",
    "short": "check that the leads are joined firmly by a clean shorting bar",
}


def correct(
    meter: LcrMeter,
    kind: str,
    extent: str = "ALL",
    progress: Callable[[float], None] = lambda seconds: None,
    patience: float = 180.0,
    interval: float = 0.2,
) -> None:
    """Acquire the open or short correction at all frequencies or one (ALL, SPOT), or end it (OFF).

    progress: called with the elapsed seconds, every `interval` s. patience: longest time, s. Raises
    InputError for other words, CorrectionError if the meter fails or does not end in time.
    """
    if kind not in ADVICE or extent not in meter.extents:
        *words, last = meter.extents
        raise InputError(
            f"`kind` must be open or short and `extent` {', '.join(words)} or {last}, got {kind}, "
            f"{extent}"
        )
    with shielded():  # before the correction starts: whatever ends the wait, it is cancelled
        try:
            with interruptible():
                meter.start_correction(kind, extent)
                if extent == meter.extents[-1]:
                    return
                if not _completed(meter, progress, patience, interval):
                    raise CorrectionError(
                        f"{meter.resource}: {kind} correction did not end in {patience:g} s; "
                        f"{ADVICE[kind]}"
                    )
        except RefusedError as refusal:
            raise CorrectionError(
                f"{kind} correction failed: {refusal}; {ADVICE[kind]}"
            ) from refusal
        except BaseException:
            with suppress(MeterError):
                meter.cancel_correction(kind)
            raise
    fault = meter.correction_fault(kind)
    if fault:
        raise CorrectionError(
            f"{meter.resource}: {kind} correction failed with {fault}; {ADVICE[kind]}"
        )


def _completed(
    meter: LcrMeter, progress: Callable[[float], None], patience: float, interval: float
) -> bool:
    begun = time.monotonic()
    while not meter.correction_done():
        elapsed = time.monotonic() - begun
        if elapsed > patience:
            return False
        progress(elapsed)
        time.sleep(interval)
    return True
