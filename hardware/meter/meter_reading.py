"""One reading and its source: a complex number with its kind, the meter's status and identity."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from typing import Any, Protocol

from ...simulator.meters.accuracy_table import METER_BANDS
from ...simulator.sweeps.reading_quantities import IMPEDANCE, ReadingKind
from ...simulator.sweeps.schema import MEASURED, VIRTUAL
from .errors import FailedReadingError

MAKERS = ("HIOKI", "KEYSIGHT", "AGILENT", "HEWLETT-PACKARD", "HP")
"""Makers in the answers to `*IDN?`, as regular expressions."""
SERIAL = re.compile(r"\d{4,}|[A-Z]{2}\w{8}|\d{4}[A-Z]\d{5}")
"""Serial numbers: digits (Hioki), or two letters or four digits first (Keysight)."""
FIRMWARE = re.compile(r"(V(er)?|REV|[A-Z])?\.?\s*\d+(\.\w+)+", re.IGNORECASE)
VIRTUAL_SERIAL = "000000000"
"""Serial number of the virtual meter."""


@dataclass(frozen=True)
class MeterIdentity:
    """Answer to `*IDN?`. model: empty if it is none of METER_BANDS."""

    text: str
    model: str
    serial: str
    firmware: str

    def __str__(self) -> str:
        return f"{self.model or 'unknown model'} ({self.text})"


def parse_identity(text: str) -> MeterIdentity:
    """Identity in an answer to `*IDN?`. Raises ValueError if the answer is empty."""
    fields = [field.strip() for field in text.split(",")]
    if not any(fields):
        raise ValueError(text)
    found = re.search(rf"\b({'|'.join(METER_BANDS)})\b", text, re.IGNORECASE)
    firmware = next((field for field in fields if FIRMWARE.fullmatch(field)), "")
    serial = next((field for field in fields if SERIAL.fullmatch(field)), "")
    return MeterIdentity(text.strip(), found[1].upper() if found else "", serial, firmware)


def sweep_origin(text: str) -> str:
    """Origin of the sweeps of a meter with this answer to `*IDN?`: measured, or virtual."""
    return VIRTUAL if parse_identity(text).serial == VIRTUAL_SERIAL else MEASURED


PLACEHOLDER = 1e30
OTHER_MAKERS = 20
"""Codes from here on are not Hioki's."""
CONTACT = "contact error: check the leads and terminals"


class ReadingStatus(Enum):
    """Status of a reading: its code, and what to check if it is not normal.

    Codes below 20 are Hioki's; the others are this program's, for the meters of other makers.
    """

    NORMAL = 0, "normal"
    NOT_MEASURED = 1, "nothing was measured yet: check the trigger"
    OUTSIDE_GUARANTEE = 2, "outside guaranteed accuracy"
    OUTSIDE_DISPLAY = 3, "outside the display range"
    HIGH_IMPEDANCE = 5, "high contact impedance suspected (Hi-Z)"
    OVERFLOW = 7, "overflow: check the leads for an open circuit, or take a higher range"
    UNDERFLOW = -7, "underflow: check the leads for a short, or take a lower range"
    SAMPLING = 9, "sampling error: check for noise from the mains, or lower the speed"
    CONTACT_12 = 12, CONTACT
    CONTACT_13 = 13, CONTACT
    CONTACT_14 = 14, CONTACT
    CONTACT_15 = 15, CONTACT
    CONTACT_16 = 16, CONTACT
    CONTACT_17 = 17, CONTACT
    OVERLOAD = 21, "overload: check the leads, or take another range"
    CONVERTER = 22, "the meter's converter does not work: have the meter checked"
    SOURCE_OVERLOAD = 23, "the generator is overloaded: take a lower level"
    NOT_LEVELLED = 24, "the level control cannot hold the level: take a lower one, or end control"

    def __init__(self, code: int, meaning: str) -> None:
        self.code, self.meaning = code, meaning

    @property
    def has_values(self) -> bool:
        """True if the reading has numbers."""
        return self.code in (0, 2, 3, 5, 23, 24)


BY_CODE = {status.code: status for status in ReadingStatus}
FAILURES = {
    code for code, status in BY_CODE.items() if code < OTHER_MAKERS and not status.has_values
}
"""Codes of Hioki's without a number."""


@dataclass(frozen=True)
class MeterReading:
    """One complex number: an impedance in ohm, or a gain, as `kind` says.

    status: normal, or a flag on the number. shown: quantities that the meter shows with digits of
    their own, by name, such as Cp in F; all others follow from the number and the frequency.
    """

    value: complex
    status: ReadingStatus = ReadingStatus.NORMAL
    kind: ReadingKind = IMPEDANCE
    shown: Mapping[str, float] = field(default_factory=dict)


def parse_reading(text: str) -> MeterReading:
    """Reading in an answer `status, Cp, Rs, X`, with any number of digits and spaces.

    Raises FailedReadingError if the status is a failure, ValueError if the answer is malformed.
    """
    code, Cp, Rs, X = (float(part) for part in text.split(","))
    if not code.is_integer():
        raise ValueError(text)
    status = BY_CODE.get(int(code))
    if status is None or code >= OTHER_MAKERS:
        raise FailedReadingError(f"the meter gave status {code:g}, which has no known meaning")
    if not status.has_values:
        raise FailedReadingError(f"the reading failed with status {status.code}: {status.meaning}")
    if not all(math.isfinite(value) and abs(value) < PLACEHOLDER for value in (Cp, Rs, X)):
        raise ValueError(text)
    return MeterReading(complex(Rs, X), status, shown={"Cp": Cp})


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
