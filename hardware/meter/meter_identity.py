"""Identity of a meter: model and serial number, recognized in any order."""

from __future__ import annotations

import re
from dataclasses import dataclass

from ...simulator.meters.meter_bands import METER_BANDS
from ...simulator.sweeps.schema import MEASURED, VIRTUAL

MODELS = tuple(METER_BANDS)
MAKERS = ("HIOKI", "KEYSIGHT", "AGILENT", "HEWLETT-PACKARD", "HP")
"""Makers in the answers to `*IDN?`, as regular expressions."""
SERIAL = re.compile(r"\d{4,}|[A-Z]{2}\w{8}|\d{4}[A-Z]\d{5}")
"""Serial numbers: digits (Hioki), or two letters or four digits first (Keysight)."""
FIRMWARE = re.compile(r"(V(er)?|REV|[A-Z])?\.?\s*\d+(\.\w+)+", re.IGNORECASE)
VIRTUAL_SERIAL = "000000000"
"""Serial number of the virtual meter."""
MODEL = re.compile(r"\b(" + "|".join(MODELS) + r")\b", re.IGNORECASE)


@dataclass(frozen=True)
class MeterIdentity:
    """Answer to `*IDN?`. model: empty if it is none of MODELS."""

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
    found = MODEL.search(text)
    firmware = next((field for field in fields if FIRMWARE.fullmatch(field)), "")
    serial = next((field for field in fields if SERIAL.fullmatch(field)), "")
    return MeterIdentity(text.strip(), found[1].upper() if found else "", serial, firmware)


def sweep_origin(text: str) -> str:
    """Origin of the sweeps of a meter with this answer to `*IDN?`: measured, or virtual."""
    return VIRTUAL if parse_identity(text).serial == VIRTUAL_SERIAL else MEASURED
