"""Interface of the recorder and of live localization to a meter or another reader."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol

from .meter_reading import MeterIdentity, MeterReading

SettingValue = str | int | float | bool


class ReadingSource(Protocol):
    """A reader of a skin, connected and set up. Everything may raise MeterError."""

    @property
    def model(self) -> str:
        """Model, for messages."""
        ...

    @property
    def identity(self) -> MeterIdentity:
        """Identity. Its text distinguishes this reader from every other one."""
        ...

    @property
    def resource(self) -> str:
        """Name of the resource, for messages."""
        ...

    @property
    def band(self) -> tuple[float, float]:
        """Lowest and highest frequency, Hz."""
        ...

    def nearest(self, frequency: float) -> float:
        """Frequency in Hz that the reader sets for a requested one."""
        ...

    @property
    def sweeps(self) -> bool:
        """True if `read_sweep` is faster than `read_at` at each frequency."""
        ...

    @property
    def reported(self) -> Sequence[str]:
        """Names in a snapshot that cannot be set."""
        ...

    @property
    def busy_seconds(self) -> float:
        """Time that a running reading or sweep may still take, s. Sends no query."""
        ...

    def read_at(self, frequency: float) -> MeterReading:
        """Reading at a frequency in Hz, never older than this call."""
        ...

    def read_sweep(self, frequencies: Sequence[float]) -> list[MeterReading]:
        """Readings at frequencies in Hz, none older than this call."""
        ...

    def snapshot(self) -> dict[str, SettingValue]:
        """All settings that a reading depends on, and the `reported` ones."""
        ...

    def apply_settings(self, settings: Mapping[str, Any]) -> None:
        """Set those that can be set. Raises InputError for a name or value that is not allowed."""
        ...

    def restore_original(self) -> None:
        """Restore all changed settings."""
        ...

    def close(self) -> None:
        """Close the connection. Closing twice does no harm."""
        ...
