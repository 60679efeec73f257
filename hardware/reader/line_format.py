"""Lines of a reader: their description in TOML, and the readings in a line of JSON or CSV."""

from __future__ import annotations

import binascii
import cmath
import json
import math
import re
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property, reduce
from operator import xor
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from ...simulator.meters.accuracy_table import ReadingConditions
from ...simulator.sweeps import InputError, checked_output, inputs, whole_file
from ...simulator.sweeps.reading_quantities import GAIN, IMPEDANCE, MAGNITUDE, ReadingKind

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Text = Annotated[str, Field(max_length=100, pattern=r"^[ -~]*$")]
NEW_READER = Path(__file__).with_name("new-reader.toml")
REPEATED_COLUMN = re.compile(r"(?P<name>.+)\[(?P<length>\d{1,5})\]")
PARTS = ({"real", "imaginary"}, {"magnitude", "phase"}, {"magnitude"})
"""Parts of a reading that a line may hold."""
CHECKSUM_DIGITS = {"xor": 2, "sum": 2, "crc16": 4, "crc32": 8}
"""Kinds of checksum, with their hexadecimal digits after the last `*` of a line."""


class _ReaderModel(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class ReadingFields(_ReaderModel):
    """Names of the fields or columns of a reading.

    real, imaginary: Rs and X of an impedance, or the parts of a gain. Cp: capacitance of an
    impedance, F; it must follow from the other two.
    """

    real: Text = ""
    imaginary: Text = ""
    magnitude: Text = ""
    phase: Text = ""
    Cp: Text = ""

    @property
    def named(self) -> dict[str, str]:
        """Fields by the part of a reading that they hold."""
        return {part: name for part, name in self.model_dump().items() if name}


class ReaderInterface(ReadingFields):
    """One interface of the skin at the reader.

    name: of the scene. label: value of the field `terminal` in its lines. Fields that only this
    interface has replace those of the whole file.
    """

    name: Annotated[str, Field(min_length=1, max_length=100)]
    label: Text = ""

    @property
    def own_fields(self) -> dict[str, str]:
        """Fields of this interface alone, by part."""
        return {part: name for part, name in self.named.items() if part not in ("name", "label")}


class LineFormat(ReadingFields):
    """Format of a reader's lines, as its TOML file describes it. Keys: see the how-to page.

    `frequencies`: Hz. `rate`: lines per second. `boot`: s from the opening to the start command.
    `error`: bound on the error of the magnitude, a fraction; `phase_error`: of the phase, degrees.
    """

    name: Annotated[str, Field(min_length=1, max_length=100, pattern=r"^[^,\x00-\x1f]*$")]
    format: Literal["json", "csv"]
    quantity: Literal["impedance", "gain"] = "impedance"
    lines: Literal["readings", "sweeps"] = "readings"
    columns: tuple[Text, ...] = ()
    separator: Annotated[str, Field(min_length=1, max_length=1)] = ","
    interface: tuple[ReaderInterface, ...] = ()
    terminal: Text = ""
    frequency: Text = ""
    frequency_scale: Positive = 1.0
    frequencies: tuple[Positive, ...] = ()
    begins: Literal["lowest", "highest"] = "lowest"
    unit: Literal["ohm", "V", "bit", "share"] = "ohm"
    scale: Positive = 1.0
    amplitude: Positive | None = None
    phase_unit: Literal["deg", "rad"] = "deg"
    range: tuple[float, float] | None = None
    count: Text = ""
    count_limit: Annotated[int, Field(ge=2)] | None = None
    sweep: Text = ""
    time: Text = ""
    checksum: Literal["", "xor", "sum", "crc16", "crc32"] = ""
    comment: Text = "#"
    banner: Text = ""
    baud: Annotated[int, Field(ge=300, le=10_000_000)] = 115_200
    boot: Annotated[float, Field(ge=0, le=60)] = 0.0
    start: Text = ""
    stop: Text = ""
    rate: Annotated[float, Field(gt=0, le=1e6)]
    error: Annotated[float, Field(gt=0, lt=1)] | None = None
    phase_error: Annotated[float, Field(gt=0, lt=90)] | None = None

    @cached_property
    def cells(self) -> dict[str, slice]:
        """Cells of each column of CSV; `name[96]` are 96 cells."""
        found: dict[str, slice] = {}
        begun = 0
        for column in self.columns:
            repeated = REPEATED_COLUMN.fullmatch(column)
            name, length = (repeated["name"], int(repeated["length"])) if repeated else (column, 1)
            found[name] = slice(begun, begun + length)
            begun += length
        return found

    @property
    def cell_count(self) -> int:
        """Number of cells of a line of CSV."""
        return max((cells.stop for cells in self.cells.values()), default=0)

    def fields_of(self, interface: ReaderInterface | None) -> dict[str, str]:
        """Fields of a reading at an interface by part: its own, or those of the whole file."""
        common = {part: getattr(self, part) for part in ReadingFields.model_fields}
        own = interface.own_fields if interface else {}
        return {part: name for part, name in {**common, **own}.items() if name}

    @property
    def kind(self) -> ReadingKind:
        """Kind of the readings that the lines hold."""
        if self.quantity == "impedance":
            return IMPEDANCE
        first = self.interface[0] if self.interface else None
        return MAGNITUDE if set(self.fields_of(first)) == {"magnitude"} else GAIN

    @property
    def counters(self) -> tuple[str, ...]:
        """Fields that each line has next to its readings."""
        names = self.count, self.sweep, self.time, self.terminal, self.frequency
        return tuple(name for name in names if name)

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        for fault in (
            _fault_of_fields(self),
            _fault_of_units(self),
            _fault_of_interfaces(self),
            _fault_of_frequencies(self),
            _fault_of_columns(self),
        ):
            if fault:
                raise ValueError(fault)
        return self


def read_line_format(path: Path) -> LineFormat:
    """Line format of a TOML file. Raises InputError with the file, the key and the fault."""
    try:
        return LineFormat.model_validate(inputs.tables(inputs.text(path, inputs.SETTINGS)))
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: is no description of a reader in TOML: {error}") from error
    except ValidationError as error:
        raise InputError(f"{path}: {_first_fault(error)}") from error


def write_new_format(path: Path) -> None:
    """Write a commented file with every key, to edit.

    Raises InputError for another ending than .toml, a missing folder, a protected file.
    """
    with whole_file(checked_output(path, (".toml",))) as unfinished:
        unfinished.write_text(NEW_READER.read_text(encoding="utf-8"), encoding="utf-8")


def _first_fault(error: ValidationError) -> str:
    first = error.errors()[0]
    message = first["msg"].removeprefix("Value error, ")
    if not first["loc"]:
        return message
    key = ".".join(map(str, first["loc"]))
    got = "" if first["type"] == "missing" else f", got {first['input']!r}"
    return f"`{key}`: {message}{got}"


def _fault_of_fields(given: LineFormat) -> str:
    for interface in given.interface or (None,):
        parts = set(given.fields_of(interface))
        where = f"interface {interface.name!r}: " if interface else ""
        if parts - {"Cp"} not in PARTS:
            return (
                f"{where}a reading needs `real` and `imaginary`, or `magnitude` and `phase`, or "
                f"`magnitude` alone; got {', '.join(sorted(parts)) or 'none of them'}"
            )
        if given.quantity == "impedance" and parts == {"magnitude"}:
            return f"{where}`magnitude` alone is possible for a gain only; add `phase`"
        if given.quantity == "gain" and "Cp" in parts:
            return f"{where}`Cp` belongs to an impedance, and `quantity` is 'gain'"
    return ""


def _fault_of_units(given: LineFormat) -> str:
    units = ("ohm",) if given.quantity == "impedance" else ("V", "bit", "share")
    if given.unit not in units:
        allowed = " or ".join(repr(unit) for unit in units)
        return f"`unit` of `quantity` {given.quantity!r} must be {allowed}, got {given.unit!r}"
    if (given.amplitude is None) == (given.unit in ("V", "bit")):
        return (
            f"`amplitude` (of the source, V) is needed for the units 'V' and 'bit' and for no "
            f"other; `unit` is {given.unit!r} and `amplitude` is {given.amplitude}"
        )
    if given.range and not given.range[0] < given.range[1]:
        return f"`range` must ascend, got {list(given.range)}"
    if (given.error is None) != (given.phase_error is None):
        return "`error` and `phase_error` are given together or not at all"
    return ""


def _fault_of_interfaces(given: LineFormat) -> str:
    labels = [interface.label for interface in given.interface]
    names = [interface.name for interface in given.interface]
    if len(set(names)) < len(names):
        return f"`interface`: names must differ, got {', '.join(names)}"
    if given.terminal and (not all(labels) or len(set(labels)) < len(labels) or not labels):
        return "`terminal` needs `[[interface]]` tables, each with a `label` of its own"
    if not given.terminal and any(labels):
        return "`label` of an interface needs `terminal`, the field that holds the labels"
    fields = [tuple(sorted(given.fields_of(each).items())) for each in given.interface]
    if not given.terminal and len(set(fields)) < len(fields):
        return "interfaces without `label` need fields of their own, such as `magnitude`"
    return ""


def _fault_of_frequencies(given: LineFormat) -> str:
    if given.lines == "readings" and (given.frequencies or not given.frequency):
        return '`lines = "readings"` needs `frequency`, the field that holds it, and no list'
    if given.lines == "sweeps" and bool(given.frequencies) == bool(given.frequency):
        return '`lines = "sweeps"` needs `frequency` or the list `frequencies`, and not both'
    if len(set(given.frequencies)) < len(given.frequencies):
        return "`frequencies` must differ from each other"
    return ""


def _fault_of_columns(given: LineFormat) -> str:
    if given.format == "json":
        return "`columns` belongs to csv, and `format` is 'json'" if given.columns else ""
    if len(given.cells) < len(given.columns) or "" in given.columns:
        return "`columns` must have different names"
    needed: set[Any] = set(given.counters)
    for interface in given.interface or (None,):
        needed |= set(given.fields_of(interface).values())
    missing = sorted(needed - given.cells.keys())
    return f"`columns` must name {', '.join(missing)}" if missing else ""


@dataclass(frozen=True)
class ReaderErrors:
    """Bounds that the file of a reader states: `error` and `phase_error`."""

    line_format: LineFormat

    @property
    def name(self) -> str:
        """Name for the attribute `accuracy` of a recording."""
        return f"as the file of reader {self.line_format.name} states"

    @property
    def known(self) -> bool:
        """True if the file states bounds of an impedance, so that laws can be checked."""
        return self.line_format.quantity == "impedance" and self.line_format.error is not None

    def has_range(self, range_number: int) -> bool:
        """True: a reader has one range."""
        return True

    def error_bounds(self, Z: complex, conditions: ReadingConditions) -> tuple[float, float]:
        """Bounds on the errors of |Z| (a fraction) and of the phase (rad)."""
        given = self.line_format
        return given.error or 0.0, math.radians(given.phase_error or 0.0)

    @staticmethod
    def conditions(
        settings: Mapping[str, Any], frequency: float, Z: complex, table: Any
    ) -> ReadingConditions:
        """Conditions of a reading: only the frequency matters."""
        return ReadingConditions(frequency, 1)


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
