"""Snapshot of a meter's settings: kept with a recording, required and restored."""

from __future__ import annotations

from collections.abc import Mapping

from ..errors import CorrectionError, changed_setting
from ..reading_source import ReadingSource, SettingValue


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
