"""Lines of a virtual reader, in the format that a TOML file describes."""

from __future__ import annotations

import cmath
import json
import math
from collections.abc import Mapping, Sequence
from typing import Any

from ...reader.line_format import CHECKSUM_DIGITS, LineFormat, ReaderInterface
from ...reader.line_parser import checksum

Values = Mapping[str, Sequence[complex]]
"""Readings by the name of their interface, one for each frequency of the line."""


def line_text(
    line_format: LineFormat,
    frequencies: Sequence[float],
    values: Values,
    count: int,
    sweep: int,
    seconds: float,
) -> str:
    """One line with these readings, ohm or gains, at frequencies in Hz.

    count, sweep: numbers of the line and of the sweep. seconds: since the start of the device.
    """
    fields: dict[str, Any] = {
        line_format.count: count % (line_format.count_limit or count + 1),
        line_format.sweep: sweep,
        line_format.time: round(1e3 * seconds),
    }
    if line_format.frequency:
        sent = [each / line_format.frequency_scale for each in frequencies]
        fields[line_format.frequency] = _listed(sent, line_format)
    for interface in line_format.interface or (None,):
        fields |= _interface_fields(line_format, interface, frequencies, values)
    fields.pop("", None)
    body = _json(fields) if line_format.format == "json" else _csv(fields, line_format)
    return body + _checksum(body, line_format)


def _interface_fields(
    line_format: LineFormat,
    interface: ReaderInterface | None,
    frequencies: Sequence[float],
    values: Values,
) -> dict[str, Any]:
    name = interface.name if interface else next(iter(values))
    if name not in values:
        return {}
    parts = line_format.fields_of(interface)
    sent = [
        _parts(value, frequency, line_format)
        for value, frequency in zip(values[name], frequencies, strict=True)
    ]
    found: dict[str, Any] = {
        field: _listed([each[part] for each in sent], line_format) for part, field in parts.items()
    }
    if interface and interface.label:
        found[line_format.terminal] = interface.label
    return found


def _parts(value: complex, frequency: float, line_format: LineFormat) -> dict[str, float]:
    """All parts of a reading in the units of the lines."""
    shown = value * (line_format.amplitude or 1.0) / line_format.scale
    phase = cmath.phase(value)
    omega = 2 * math.pi * frequency
    parts = {"real": shown.real, "imaginary": shown.imag, "magnitude": abs(shown)}
    if line_format.unit == "bit":
        parts = {part: float(round(each)) for part, each in parts.items()}
    return {
        **parts,
        "phase": math.degrees(phase) if line_format.phase_unit == "deg" else phase,
        "Cp": (1 / value).imag / omega,
    }


def _listed(values: Sequence[float], line_format: LineFormat) -> float | list[float]:
    rounded = [float(f"{value:.9g}") for value in values]
    return rounded if line_format.lines == "sweeps" else rounded[0]


def _json(fields: Mapping[str, Any]) -> str:
    nested: dict[str, Any] = {}
    for name, value in fields.items():
        *outer, last = name.split(".")
        inner = nested
        for key in outer:
            inner = inner.setdefault(key, {})
        inner[last] = value
    return json.dumps(nested)


def _csv(fields: Mapping[str, Any], line_format: LineFormat) -> str:
    columns = [fields.get(name, 0) for name in line_format.cells]
    cells = [each for value in columns for each in (value if isinstance(value, list) else [value])]
    return line_format.separator.join(map(str, cells))


def _checksum(body: str, line_format: LineFormat) -> str:
    kind = line_format.checksum
    return f"*{checksum(body, kind):0{CHECKSUM_DIGITS[kind]}X}" if kind else ""
