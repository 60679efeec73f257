"""Readings in one line of JSON or CSV."""

from __future__ import annotations

import binascii
import cmath
import json
import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import reduce
from operator import xor
from typing import Any

from .line_format import CHECKSUM_DIGITS, LineFormat, ReaderInterface


class LineError(ValueError):
    """A line that gives no readings. kind: plural noun, for counts. The message says why."""

    def __init__(self, kind: str, text: str) -> None:
        super().__init__(text)
        self.kind = kind


UNREADABLE = "lines that are no readings"
OUT_OF_RANGE = "readings out of range"
WRONG_LENGTH = "lines of a wrong length"
WRONG_CHECKSUM = "lines with a wrong checksum"
OTHER_INTERFACE = "lines of an unknown terminal"


SHOWN = 60
"""Characters of a line that a message quotes."""
CP_TOLERANCE = 0.01
"""Largest deviation of a sent Cp from that of Rs and X, as a fraction of |1/Z| / omega."""
MAX_IMPEDANCE = 1e15


@dataclass(frozen=True)
class LineReading:
    """One reading: ohm, or a complex gain. interface: empty if the reader has one only."""

    interface: str
    frequency: float
    value: complex


@dataclass(frozen=True)
class LineContent:
    """Readings of a line and its counters; None for those that the format lacks. time: as sent."""

    readings: tuple[LineReading, ...]
    count: int | None
    sweep: int | None
    time: float | None


def parse_line(text: str, line_format: LineFormat) -> LineContent:
    """Content of a line. Raises LineError."""
    line = _Line(line_format, _without_checksum(text, line_format.checksum))
    count, sweep = (line.whole_number(name) for name in (line_format.count, line_format.sweep))
    time = line.number(line_format.time) if line_format.time else None
    return LineContent(tuple(line.readings()), count, sweep, time)


def checksum(text: str, kind: str) -> int:
    """Checksum of a text of ASCII. kind: one of CHECKSUM_DIGITS. crc16 is CRC-16/CCITT-FALSE."""
    data = text.encode("ascii")
    if kind == "xor":
        return reduce(xor, data, 0)
    if kind == "sum":
        return sum(data) & 0xFF
    return binascii.crc_hqx(data, 0xFFFF) if kind == "crc16" else binascii.crc32(data)


def _without_checksum(text: str, kind: str) -> str:
    if not kind:
        return text
    body, star, digits = text.rpartition("*")
    if not star or len(digits.strip()) != CHECKSUM_DIGITS[kind]:
        raise LineError(UNREADABLE, f"no checksum in {text[:SHOWN]!r}")
    try:
        sent = int(digits, 16)
    except ValueError:
        raise LineError(UNREADABLE, f"no checksum in {text[:SHOWN]!r}") from None
    if sent != checksum(body, kind):
        raise LineError(
            WRONG_CHECKSUM,
            f"the checksum of {text[:SHOWN]!r} is wrong",
        )
    return body


class _Line:
    """Fields of a line."""

    def __init__(self, line_format: LineFormat, text: str) -> None:
        self.format, self.text = line_format, text
        self._json = _json_object(text) if line_format.format == "json" else {}
        self._cells = text.split(line_format.separator) if line_format.format == "csv" else []
        if self._cells and len(self._cells) != line_format.cell_count:
            raise LineError(
                UNREADABLE if len(self._cells) == 1 else WRONG_LENGTH,
                f"{text[:SHOWN]!r} has {len(self._cells)} columns instead of "
                f"{line_format.cell_count}",
            )

    def readings(self) -> Iterator[LineReading]:
        """Readings of the line. Raises LineError."""
        frequencies = self._frequencies()
        for interface in self._interfaces():
            fields = self.format.fields_of(interface)
            parts = {part: self._values(name) for part, name in fields.items()}
            for name, values in zip(fields.values(), parts.values(), strict=True):
                if len(values) != len(frequencies):
                    raise LineError(
                        WRONG_LENGTH,
                        f"{name!r} has {len(values)} values for {len(frequencies)} frequencies",
                    )
            for k, frequency in enumerate(frequencies):
                own = {part: values[k] for part, values in parts.items()}
                yield LineReading(
                    interface.name if interface else "", frequency, self._value(own, frequency)
                )

    def whole_number(self, name: str) -> int | None:
        """A counter, None without a name."""
        if not name:
            return None
        value = self.number(name)
        if not value.is_integer() or value < 0:
            raise LineError(UNREADABLE, f"{name!r} is no count in {self.text[:SHOWN]!r}")
        return int(value)

    def number(self, name: str) -> float:
        """One number of a field."""
        values = self._values(name)
        if len(values) != 1:
            raise LineError(UNREADABLE, f"{name!r} is no number in {self.text[:SHOWN]!r}")
        return values[0]

    def _frequencies(self) -> list[float]:
        listed = self.format.frequencies
        found = list(listed) if listed else self._values(self.format.frequency)
        scaled = [each * (1.0 if listed else self.format.frequency_scale) for each in found]
        if not all(each > 0 for each in scaled):
            raise LineError(OUT_OF_RANGE, f"a frequency is not positive in {self.text[:SHOWN]!r}")
        return scaled

    def _interfaces(self) -> list[ReaderInterface | None]:
        """Interfaces whose readings the line holds."""
        described = self.format.interface
        if not self.format.terminal:
            return list(described) or [None]
        label = str(self._raw(self.format.terminal)).strip()
        found = [each for each in described if each.label == label]
        if not found:
            known = ", ".join(each.label for each in described)
            raise LineError(OTHER_INTERFACE, f"terminal {label[:SHOWN]!r} is none of {known}")
        return list(found)

    def _values(self, name: str) -> list[float]:
        """Numbers of a field: one, or those of an array."""
        raw = self._raw(name)
        return [self._float(each, name) for each in (raw if isinstance(raw, list) else [raw])]

    def _raw(self, name: str) -> Any:
        if self._cells:
            cells = self._cells[self.format.cells[name]]
            return cells if len(cells) > 1 else cells[0]
        found: Any = self._json
        for key in name.split("."):
            if not isinstance(found, dict) or key not in found:
                raise LineError(UNREADABLE, f"{name!r} is missing in {self.text[:SHOWN]!r}")
            found = found[key]
        return found

    def _float(self, raw: Any, name: str) -> float:
        try:
            if isinstance(raw, bool) or isinstance(raw, str) and (not self._cells or "_" in raw):
                raise TypeError
            value = float(raw)
        except (TypeError, ValueError, OverflowError):
            raise LineError(UNREADABLE, f"{name!r} is no number in {self.text[:SHOWN]!r}") from None
        if not math.isfinite(value):
            raise LineError(OUT_OF_RANGE, f"{name!r} is {value} in {self.text[:SHOWN]!r}")
        return value

    def _value(self, parts: dict[str, float], frequency: float) -> complex:
        """Reading of these parts, ohm or gain. Raises LineError if it is out of range."""
        given = self.format
        if "magnitude" in parts:
            phase = parts.get("phase", 0.0)
            turned = math.radians(phase) if given.phase_unit == "deg" else phase
            sent = cmath.rect(parts["magnitude"], turned)
            size = parts["magnitude"]
        else:
            sent = complex(parts["real"], parts["imaginary"])
            size = abs(sent)
        low, high = given.range or (0.0, math.inf)
        value = sent * given.scale / (given.amplitude or 1.0)
        if not (low <= size <= high and 0 < abs(value) < MAX_IMPEDANCE):
            raise LineError(
                OUT_OF_RANGE,
                f"the reading {size:g} {given.unit} at {frequency:g} Hz is outside "
                f"{low:g} to {high:g}, or 0",
            )
        if "Cp" in parts:
            self._check_capacitance(parts["Cp"], value, frequency)
        return value

    def _check_capacitance(self, Cp: float, Z: complex, frequency: float) -> None:
        omega = 2 * math.pi * frequency
        if abs(omega * Cp - (1 / Z).imag) > CP_TOLERANCE * abs(1 / Z):
            raise LineError(OUT_OF_RANGE, f"Cp {Cp:g} F does not follow from Z at {frequency:g} Hz")


def _json_object(text: str) -> dict[str, Any]:
    def refuse(word: str) -> None:
        raise LineError(OUT_OF_RANGE, f"{word} in {text[:SHOWN]!r}")

    def distinct(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        if len(found := dict(pairs)) < len(pairs):
            raise LineError(UNREADABLE, f"a field comes twice in {text[:SHOWN]!r}")
        return found

    try:
        found = json.loads(text, parse_constant=refuse, object_pairs_hook=distinct)
    except LineError:
        raise
    except (ValueError, RecursionError):
        found = None
    if not isinstance(found, dict):
        raise LineError(UNREADABLE, f"{text[:SHOWN]!r} is no JSON object")
    return found
