"""Original settings of a meter and those of a recording: kept, required and restored."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from contextvars import ContextVar
from typing import Any, Protocol

from ....simulator.sweeps import InputError
from ..errors import (
    CorrectionError,
    GarbledError,
    MeterError,
    NoAnswerError,
    RefusedError,
    RestartedError,
    changed_setting,
)
from ..meter_reading import MeterIdentity
from ..reading_source import ReadingSource, SettingValue
from ..setting import Setting, SettingsOwner

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
