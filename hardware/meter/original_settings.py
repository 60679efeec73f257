"""Putting a meter back to what it was before anything was set."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from contextvars import ContextVar
from typing import Any, Protocol

from ...simulator.sweeps import InputError
from .errors import MeterError, RefusedError, RestartedError
from .meter_identity import MeterIdentity
from .setting import Setting, SettingsOwner
from .termination import shielded

RESTORED_LAST = ("auto_range", "trigger", "header")
"""Settings that are put back after all others, in this order."""
MAX_RESTARTS = 3
"""Times that a meter may be switched on anew while its settings are put back."""


class OriginalSettingsStore(Protocol):
    """Who sees to it that settings are put back, over other connections too."""

    def found(self, identity: MeterIdentity) -> dict[str, Any]:
        """A meter's settings as they were at first; whoever sets others adds them.

        Raises WrongMeterError where those of another meter are kept.
        """
        ...

    def note_found(self) -> None:
        """Something was added, and the meter is about to be changed."""
        ...


SETTINGS_STORE: ContextVar[OriginalSettingsStore | None] = ContextVar("keeper", default=None)
"""Of the meters that are opened; None: each is put back as it is let go."""


def restore_original(meter: SettingsOwner) -> None:
    """Set everything that was set to what it was before. No signal ends that.

    `found` then has what the meter did not confirm. Raises MeterError where the connection fails,
    or the meter is switched on anew again and again; calling it again goes on from there.
    """
    kept, meter.found = meter.found or {}, None
    everything = dict(kept)
    try:
        with shielded():
            with suppress(MeterError):
                meter.talk.check_events(
                    "the end"
                )  # what it was just answering answers nothing else
            for _ in range(MAX_RESTARTS):
                with suppress(RestartedError):
                    return _restore_each(meter, kept)
                kept.update(everything)
            _restore_each(meter, kept)
    finally:
        meter.found = kept


def _restore_each(meter: SettingsOwner, kept: dict[str, Any]) -> None:
    """Set what is kept, and drop what the meter confirms; what it refuses stays."""
    for name in sorted(
        kept, key=lambda name: name in RESTORED_LAST and 1 + RESTORED_LAST.index(name)
    ):
        setting = getattr(type(meter), name, None)
        if not isinstance(setting, Setting):
            continue
        with suppress(RefusedError, InputError, TypeError, ValueError):  # the last: from a file
            setting.put_back(meter, kept[name])
            del kept[name]


def not_restored_message(settings: Mapping[str, Any]) -> str:
    """What is told of settings that were not put back. settings: as they should be."""
    return (
        "the meter did not confirm these original settings; check them on the meter: "
        f"{settings_text(settings)}"
    )


def settings_text(settings: Mapping[str, Any]) -> str:
    """Settings with their values, in words."""
    return ", ".join(f"{name} = {_value_text(value)}" for name, value in settings.items())


def _value_text(value: Any) -> str:
    """A value, or one of each range or register, which may all be the same."""
    each = value if isinstance(value, (tuple, list)) else (value,)
    return " ".join(map(str, dict.fromkeys(each) if len(set(each)) == 1 else each))
