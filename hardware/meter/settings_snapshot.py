"""Snapshot of a meter's settings: taken, kept with a recording, and restored."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .errors import CorrectionError, RestartedError
from .hioki import Meter

SETTABLE = (
    "level",
    "voltage",
    "constant_voltage",
    "constant_current",
    "range",
    "auto_range",
    "speed",
    "averaging",
    "trigger_delay",
    "cable",
    "load_correction",
)
REPORTED = ("open_correction", "short_correction")
Value = str | int | float | bool


def snapshot(meter: Meter) -> dict[str, Value]:
    """All settings that a reading depends on; the range only if fixed. Raises MeterError."""
    values = {name: getattr(meter, name) for name in (*SETTABLE, *REPORTED)}
    if values["auto_range"]:
        del values["range"]
    return values


def apply_settings(meter: Meter, settings: Mapping[str, Any]) -> None:
    """Set those of the settings that can be set; the automatic range after the range.

    Raises InputError if a value is not allowed, MeterError if the meter fails.
    """
    for name in SETTABLE:
        if name in settings:
            setattr(meter, name, settings[name])


def restore_settings(meter: Meter, settings: Mapping[str, Value]) -> None:
    """Restore the settings of a snapshot.

    Raises CorrectionError if the open or short correction differs: it cannot be set, only acquired.
    """
    apply_settings(meter, settings)
    now = snapshot(meter)
    for name in REPORTED:
        if now[name] != settings[name]:
            raise CorrectionError(
                f"{meter.talk.resource}: {name.replace('_', ' ')} was {settings[name]} when the "
                f"recording began and is {now[name]} now; acquire it again (`rcskin meter correct`)"
            )


def require_settings(meter: Meter, settings: Mapping[str, Value]) -> None:
    """Raises RestartedError if any setting differs from the snapshot."""
    now = snapshot(meter)
    for name in {**settings, **now}:
        if now.get(name) != settings.get(name):
            raise RestartedError(
                f"{meter.talk.resource}: `{name}` is {now.get(name)} and was {settings.get(name)}; "
                "check whether the meter lost its settings or someone changed them on its panel"
            )
