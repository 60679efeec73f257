"""A meter's settings as a whole: told, kept with a recording, and set again."""

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
    """Every setting that a reading depends on; the range only if fixed. Raises MeterError."""
    told = {name: getattr(meter, name) for name in (*SETTABLE, *REPORTED)}
    if told["auto_range"]:
        del told["range"]
    return told


def apply_settings(meter: Meter, settings: Mapping[str, Any]) -> None:
    """Set what is named and settable; automatic range comes after the range, which ends it.

    Raises InputError where a value is not allowed, MeterError where the meter fails.
    """
    for name in SETTABLE:
        if name in settings:
            setattr(meter, name, settings[name])


def restore_settings(meter: Meter, settings: Mapping[str, Value]) -> None:
    """Set the meter as it was in a snapshot.

    Raises CorrectionError where open or short correction is no longer what it was: those cannot be
    set again, only acquired again.
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
    """Raises RestartedError where any setting is no longer what it was in a snapshot."""
    now = snapshot(meter)
    for name in {**settings, **now}:
        if now.get(name) != settings.get(name):
            raise RestartedError(
                f"{meter.talk.resource}: `{name}` is {now.get(name)} and was {settings.get(name)}; "
                "check whether the meter lost its settings or someone changed them on its panel"
            )
