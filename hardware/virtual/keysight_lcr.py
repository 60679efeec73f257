"""Virtual LCR meters Keysight E4980A and E4980AL, and Agilent 4284A, whose dialect they share.

Sources: Keysight E4980A/AL user's guide (pages 242 and 316: syntax, 249 to 252: trigger, 255 to
259: data buffer, 261 to 269: data transfer, 272 to 274: registers), as far as it was at hand, and
public drivers of these meters.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Any, ClassVar

from ...simulator.meters.accuracy_table import (
    OUTPUT_RESISTANCE,
    AccuracyTable,
    ReadingConditions,
)
from ..meter.keysight_dialects import (
    RANGES,
    STATUSES,
    TABLE_SPEEDS,
    E4980ALDialect,
    HP4284ADialect,
    LcrDialect,
)
from ..meter.keysight_lcr import seconds_of
from ..meter.meter_reading import ReadingStatus
from ..meter.setting import NO_NUMBER, MeterProperty, rows
from .keysight_instrument import (
    COMMON_COMMANDS,
    ILLEGAL_VALUE,
    SCPI,
    STALE_DATA,
    TOO_MUCH_DATA,
    TRIGGER_AND_FETCH,
    KeysightInstrument,
    acquisition,
    continuous_command,
    nr3,
    shown_quantity,
)
from .language import (
    SUFFIX_OUT_OF_RANGE,
    CommandError,
    ExecutionError,
    MeterCommand,
    Vocabulary,
    all_forms,
    matched_word,
    setting_commands,
)
from .measurement import MeasurementResult, Settings

OVERLOAD_BELOW = 1 / 3
"""Share of a fixed range below which |Z| overloads it. Chosen here: a low |Z| drives too much
current through the range resistor, but the limit is in no manual that was at hand."""
STATUS_NUMBERS = {status: number for number, status in STATUSES.items()}
SPOT_NUMBERS = range(1, 202)
QUANTITIES = {
    "CPD": ("CP", "DC"),
    "CPQ": ("CP", "QC"),
    "CPG": ("CP", "G"),
    "CPRP": ("CP", "RP"),
    "CSD": ("CS", "DC"),
    "CSQ": ("CS", "QC"),
    "CSRS": ("CS", "RS"),
    "LPD": ("LP", "D"),
    "LPQ": ("LP", "Q"),
    "LPG": ("LP", "G"),
    "LPRP": ("LP", "RP"),
    "LPRD": ("LP", "RDC"),
    "LSD": ("LS", "D"),
    "LSQ": ("LS", "Q"),
    "LSRS": ("LS", "RS"),
    "LSRD": ("LS", "RDC"),
    "RX": ("RS", "X"),
    "ZTD": ("Z", "PHASE"),
    "ZTR": ("Z", "RADIANS"),
    "GB": ("G", "B"),
    "YTD": ("Y", "YPHASE"),
    "YTR": ("Y", "YRADIANS"),
    "VDID": ("VDC", "IDC"),
}
"""Quantities of each function, as `shown_quantity` names them; RDC is not measured."""


NO_DATA = f"{nr3(NO_NUMBER)},{nr3(NO_NUMBER)},-1,+0"
"""An entry of the data buffer that was not filled."""


@dataclass(frozen=True)
class CorrectionSpot:
    """A frequency with a correction of its own, Hz. standard: reference values of the load."""

    state: bool = False
    frequency: float = 1e3
    standard: tuple[float, float] = (0.0, 0.0)


class LcrSettings(Settings):
    """Settings after `*RST`, but continuous.

    level: which of voltage and current was set last. list_values: of the sweep, in the unit of
    list_kind. references: of the deviations, in the unit of the quantity.
    """

    dialect = LcrDialect
    own: ClassVar = {
        "level": "voltage",
        "list_kind": "frequency",
        "list_values": (),
        "references": (0.0, 0.0),
        "spots": {},
    }

    def conditions(self, Z: complex, accuracy: AccuracyTable) -> ReadingConditions:
        """Conditions of a measurement of Z in ohm; range: 1 for 100 mohm to 10 for 100 kohm."""
        used = fitting_range(abs(Z)) if self.auto_range else self.range
        loop = abs(OUTPUT_RESISTANCE + Z)
        speed, averaging = self.aperture
        return ReadingConditions(
            self.frequency,
            RANGES.index(used) + 1,
            TABLE_SPEEDS[speed],
            averaging,
            self.voltage if self.level == "voltage" else self.current * loop,
            int(self.cable > 0),
        )

    def status(self, Z: complex, used: ReadingConditions, accuracy: AccuracyTable) -> ReadingStatus:
        """Overload if |Z| overloads a fixed range."""
        overloaded = abs(Z) < OVERLOAD_BELOW * RANGES[used.range - 1] and not self.auto_range
        return ReadingStatus.OVERLOAD if overloaded else ReadingStatus.NORMAL

    def list_points(self) -> Sequence[LcrSettings]:
        """Settings at each point of the list."""
        levels = {kind: {"level": kind} for kind in ("voltage", "current")}
        kind, more = self.list_kind, levels.get(self.list_kind, {})
        return [self.replaced(**{**more, kind: value}) for value in self.list_values]


def fitting_range(ohms: float) -> float:
    """The highest range that does not exceed |Z|; the lowest one if none does."""
    return max((each for each in RANGES if each <= ohms * (1 + 1e-9)), default=RANGES[0])


@dataclass
class VirtualE4980A(KeysightInstrument):
    """Virtual E4980A. step: next point of a list in the mode STEPped. data_format: of answers.

    buffer: texts of readings in the data buffer. filling: True while readings go there.
    """

    model: str = "E4980A"
    firmware: ClassVar[str] = "A.06.15"
    dialect: ClassVar[type[LcrDialect]] = LcrDialect
    data_format: ClassVar[str] = "ASC,64"
    settings_type: ClassVar = LcrSettings
    step: int = 0
    buffer: list[str] = field(default_factory=list)
    buffer_size: int = 201
    filling: bool = False

    @classmethod
    def vocabulary(cls) -> Vocabulary:
        """All commands of these meters."""
        return _vocabulary(cls.dialect)

    @property
    def lists(self) -> bool:
        """True if a trigger starts a list sweep: only on the page LIST."""
        return self.settings.page == "LIST" and bool(self.settings.list_values)

    def points(self) -> Sequence[LcrSettings]:
        """Settings of each reading that a trigger starts."""
        if not self.lists:
            return [self.settings]
        points = self.settings.list_points()
        if self.settings.list_mode == "SEQUENCE":
            return points
        self.step = self.step % len(points) + 1
        return points[self.step - 1 : self.step]

    @property
    def seconds(self) -> float:
        """Time of what a trigger starts, at pace 1, s."""
        if not self.lists:
            return self.settings.trigger_delay + self._seconds_of(self.settings)
        points = self.settings.list_points()
        some = points if self.settings.list_mode == "SEQUENCE" else points[:1]
        return self.settings.trigger_delay + sum(map(self._seconds_of, some))

    def _seconds_of(self, point: LcrSettings) -> float:
        """Time of one measurement, s, without the trigger's delay."""
        one = seconds_of(self.dialect.seconds_at, point.aperture, point.frequency)
        return point.step_delay + one

    def keep(self, results: Sequence[MeasurementResult]) -> None:
        """Keep the results, also in the data buffer while it is filled."""
        super().keep(results)
        if self.settings.auto_range:
            self.settings.range = RANGES[min(results[-1].conditions.range, len(RANGES)) - 1]
        if self.filling:
            texts = [self.reading_text(each, with_bin=True) for each in results]
            self.buffer = (self.buffer + texts)[: self.buffer_size]
            self.filling = len(self.buffer) < self.buffer_size

    async def fetch_corrected(self) -> str:
        """`:FETCh:IMPedance:CORRected?`: R and X of the latest readings."""
        await self.newest()
        if not self.results:
            raise ExecutionError("FETCh", STALE_DATA)
        digits = self._decimals
        return ",".join(
            f"{nr3(each.Z.real, digits)},{nr3(each.Z.imag, digits)}" for each in self.results
        )

    def reading_text(self, result: MeasurementResult, with_bin: bool | None = None) -> str:
        """`<A>,<B>,<status>[,<bin>]`; an overload is 9.9E37 with status +1: page 261."""
        settings, numbers = self.settings, (NO_NUMBER, NO_NUMBER)
        if result.status.has_values:
            first, second = self.quantities(result)
            numbers = (
                _deviation(first, settings.deviation_1, settings.references[0]),
                _deviation(second, settings.deviation_2, settings.references[1]),
            )
        parts = [nr3(each, self._decimals) for each in numbers]
        parts.append(f"{STATUS_NUMBERS[_shown_status(result)]:+d}")
        if with_bin is None:
            with_bin = settings.comparator or self.lists
        return ",".join([*parts, "+0"] if with_bin else parts)

    def quantities(self, result: MeasurementResult) -> tuple[float, float]:
        """Both quantities of a reading with numbers."""
        at = result.Z, result.conditions.frequency
        first, second = QUANTITIES[self.settings.function]
        return shown_quantity(first, *at), shown_quantity(second, *at)

    def buffer_text(self) -> str:
        """`:MEMory:READ? DBUF`: all entries, those not filled with status -1."""
        missing = self.buffer_size - len(self.buffer)
        return ",".join([*self.buffer, *[NO_DATA] * missing])

    def clear_buffer(self) -> None:
        """`:MEMory:CLEar DBUF`: empty the data buffer and stop filling it."""
        self.buffer, self.filling = [], False

    def reset(self) -> None:
        """`*RST`: factory settings, without list and data buffer."""
        super().reset()
        self.clear_buffer()
        self.step, self.buffer_size = 0, 201

    @property
    def _decimals(self) -> int:
        return 9 if self.settings.long_format else 5


@dataclass
class VirtualE4980AL(VirtualE4980A):
    """Virtual E4980AL with option 102: up to 1 MHz."""

    model: str = "E4980AL"
    dialect: ClassVar[type[LcrDialect]] = E4980ALDialect


@dataclass
class Virtual4284A(VirtualE4980A):
    """Virtual 4284A: up to 1 MHz, ten points in a list, GP-IB only in reality."""

    model: str = "4284A"
    maker: ClassVar[str] = "HEWLETT-PACKARD"
    firmware: ClassVar[str] = "REV01.20"
    dialect: ClassVar[type[LcrDialect]] = HP4284ADialect
    data_format: ClassVar[str] = "ASC"
    note: ClassVar[str] = "a 4284A has GP-IB only; the virtual one answers on TCP instead"


def _deviation(value: float, mode: str, reference: float) -> float:
    """What a deviation measurement shows: the difference, in % of the reference if PERC."""
    if mode == "OFF":
        return value
    difference = value - reference
    return difference if mode == "ABS" else 100 * difference / (reference or math.inf)


def _reference(index: int) -> MeterCommand:
    """Command of the reference of a deviation, without unit."""

    def set_reference(meter: VirtualE4980A, text: str) -> None:
        both = list(meter.settings.references)
        both[index] = SCPI.number(text, -1e15, 1e15)
        meter.settings.references = (both[0], both[1])

    return MeterCommand(
        f":FUNCtion:DEV{index + 1}:REFerence[:VALue]",
        set_reference,
        lambda meter: nr3(meter.settings.references[index]),
    )


def _fill_references(meter: VirtualE4980A) -> None:
    """Take the latest reading as references."""
    if not meter.latest.status.has_values:
        raise ExecutionError("FILL", STALE_DATA)
    meter.settings.references = meter.quantities(meter.latest)


def _learn(meter: VirtualE4980A) -> str:
    """Commands that restore the present settings. What has no value at present is left out."""
    lines = []
    for command in _settings(meter.dialect):
        header = ":".join(min(all_forms(command.header), key=lambda form: len("".join(form))))
        with suppress(ExecutionError):
            if command.on_query:
                lines.append(f":{header} {command.on_query(meter)}")
    return ";".join(lines)


def _level(name: str, row: MeterProperty[Any]) -> MeterCommand:
    """Command of a level. A query for the level that is not in use is an error."""

    def set_level(meter: VirtualE4980A, text: str) -> None:
        setattr(meter.settings, name, SCPI.parse(row.twin, [text]))
        meter.settings.level = name
        meter.changed()

    def query(meter: VirtualE4980A) -> str:
        if meter.settings.level != name:
            raise ExecutionError(row.header, STALE_DATA)
        return nr3(getattr(meter.settings, name))

    return MeterCommand(row.header, set_level, query)


def _set_range(meter: VirtualE4980A, text: str) -> None:
    value = fitting_range(SCPI.number(text, 0.1, 100e3, "OHM"))
    meter.settings.range, meter.settings.auto_range = value, False
    meter.changed()


def _list(kind: str, header: str) -> MeterCommand:
    """Command of the points of a list sweep, which replace those of another kind."""

    def set_list(meter: VirtualE4980A, *texts: str) -> None:
        _set_points(meter, kind, texts)

    def query(meter: VirtualE4980A) -> str:
        if meter.settings.list_kind != kind:
            raise ExecutionError(header, STALE_DATA)
        return _points_text(meter)

    return MeterCommand(header, set_list, query, set_arguments=(1, 1000))


def _set_points(meter: VirtualE4980A, kind: str, texts: Sequence[str]) -> None:
    if len(texts) > meter.dialect.max_points:
        raise ExecutionError(len(texts), TOO_MUCH_DATA)
    allowed = getattr(meter.dialect, kind).twin
    meter.settings.list_values = tuple(SCPI.parse(allowed, [text]) for text in texts)
    meter.settings.list_kind, meter.step = kind, 0
    meter.changed()


def _points_text(meter: VirtualE4980A) -> str:
    if not meter.settings.list_values:
        raise ExecutionError("LIST", STALE_DATA)
    return ",".join(nr3(value) for value in meter.settings.list_values)


def _set_stimulus(meter: VirtualE4980A, kind: str, second: str = "NONE") -> None:
    """What a list varies. A second stimulus is refused: the virtual meter varies one."""
    first = SCPI.word(kind, ("FREQuency", "VOLTage", "CURRent")).lower()
    SCPI.word(second, ("NONE",))
    if first != meter.settings.list_kind:
        _clear_list(meter)
    meter.settings.list_kind = first


def _stimulus(meter: VirtualE4980A) -> str:
    return f"{LIST_WORDS.get(meter.settings.list_kind, 'BVOL')},NONE"


def _clear_list(meter: VirtualE4980A) -> None:
    meter.settings.list_values, meter.step = (), 0
    meter.changed()


def _buffer(text: str) -> None:
    if matched_word(text, ("DBUF",)) is None:
        raise ExecutionError(text, ILLEGAL_VALUE)


def _resize(meter: VirtualE4980A, name: str, size: str) -> None:
    _buffer(name)
    meter.buffer_size = SCPI.integer(size, 1, 201)
    meter.clear_buffer()


def _fill(meter: VirtualE4980A, name: str) -> None:
    _buffer(name)
    meter.buffer, meter.filling = [], True


def _clear_buffer(meter: VirtualE4980A, name: str) -> None:
    _buffer(name)
    meter.clear_buffer()


async def _read_buffer(meter: VirtualE4980A, name: str) -> str:
    _buffer(name)
    await meter.settle()
    return meter.buffer_text()


def _set_format(meter: VirtualE4980A, *texts: str) -> None:
    """Only ASCii: the virtual meter has no binary answers. The length, 64, may follow."""
    if SCPI.parse(LcrDialect.data_format.allowed, texts) != "ASC":
        raise ExecutionError(texts, ILLEGAL_VALUE)
    for text in texts[1:]:
        SCPI.integer(text, 64, 64)


def _initiate(meter: VirtualE4980A) -> None:
    meter.initiate()


def _frequency(meter: VirtualE4980A, text: str) -> float:
    return SCPI.number(text, *meter.band, "HZ")


def _spot(
    words: str, name: str, read: Callable[..., Any], show: Callable[[Any], str], arguments: int = 1
) -> MeterCommand:
    def set_value(meter: VirtualE4980A, spot: int, *texts: str) -> None:
        kept = _checked(meter, spot)
        meter.settings.spots = {
            **meter.settings.spots,
            spot: replace(kept, **{name: read(meter, *texts)}),
        }

    def query(meter: VirtualE4980A, spot: int) -> str:
        return show(getattr(_checked(meter, spot), name))

    return MeterCommand(f":CORRection:SPOT#:{words}", set_value, query, set_arguments=arguments)


def _checked(meter: VirtualE4980A, spot: int) -> CorrectionSpot:
    if spot not in SPOT_NUMBERS:
        raise CommandError(spot, SUFFIX_OUT_OF_RANGE)
    return meter.settings.spots.get(spot, CorrectionSpot())


SPOTS = (
    _spot("STATe", "state", lambda meter, text: SCPI.switch(text), SCPI.switch_text),
    _spot("FREQuency", "frequency", _frequency, nr3),
    _spot(
        "LOAD:STANdard",
        "standard",
        lambda meter, a, b: (SCPI.number(a, -1e15, 1e15), SCPI.number(b, -1e15, 1e15)),
        lambda pair: ",".join(nr3(each) for each in pair),
        arguments=2,
    ),
    *(acquisition(f":CORRection:SPOT#:{k}[:EXECute]") for k in ("OPEN", "SHORt", "LOAD")),
)
READINGS = (
    MeterCommand(LcrDialect.clear_list, _clear_list, set_arguments=0),
    TRIGGER_AND_FETCH,
    MeterCommand(":TRIGger[:IMMediate]", lambda meter: meter.trigger(), set_arguments=0),
    MeterCommand(":INITiate[:IMMediate]", _initiate, set_arguments=0),
    MeterCommand(":TRIGger:INITiate[:IMMediate]", _initiate, set_arguments=0),  # of pymeasure
    continuous_command(":TRIGger:CONTinuous"),  # of pymeasure
    MeterCommand("*LRN", on_query=_learn),
    MeterCommand(":FUNCtion:DEV1:REFerence:FILL", _fill_references, set_arguments=0),
    MeterCommand(":FETCh[:IMPedance][:FORMatted]", on_query=lambda meter: meter.fetch()),
    MeterCommand(":FETCh[:IMPedance]:CORRected", on_query=lambda meter: meter.fetch_corrected()),
    MeterCommand(":MEMory:DIM", _resize, set_arguments=2),
    MeterCommand(":MEMory:FILL", _fill),
    MeterCommand(":MEMory:CLEar", _clear_buffer),
    MeterCommand(":MEMory:READ", on_query=_read_buffer, query_arguments=1),
)
LIST_WORDS = {"frequency": "FREQ", "voltage": "VOLT", "current": "CURR", "bias_current": "BCUR"}
LISTED = {
    "voltage": ":LIST:VOLTage",
    "current": ":LIST:CURRent",
    "bias_voltage": ":LIST:BIAS:VOLTage",
    "bias_current": ":LIST:BIAS:CURRent",
}
"""Commands of lists of what is no frequency."""


def _shown_status(result: MeasurementResult) -> ReadingStatus:
    return ReadingStatus.NORMAL if result.status.has_values else ReadingStatus.OVERLOAD


@cache
def _settings(dialect: type[LcrDialect]) -> tuple[MeterCommand, ...]:
    """Commands of settings, in the order in which `*LRN?` answers them."""
    special = {
        **{name: _level(name, getattr(dialect, name)) for name in ("voltage", "current")},
        "range": MeterCommand(
            dialect.range.header, _set_range, lambda meter: nr3(meter.settings.range)
        ),
        "data_format": MeterCommand(
            dialect.data_format.header,
            _set_format,
            lambda meter: meter.data_format,
            set_arguments=(1, 2),
        ),
        "continuous": continuous_command(dialect.continuous.header),
        "list_frequencies": _list("frequency", dialect.list_frequencies.header),
    }
    return (
        *setting_commands(SCPI, rows(dialect), special),
        _reference(0),
        _reference(1),
        *(_list(kind, header) for kind, header in LISTED.items()),
        MeterCommand(":LIST:STIMulus:TYPE", _set_stimulus, _stimulus, set_arguments=(1, 2)),
        MeterCommand(
            ":LIST:STIMulus:DATA",
            lambda meter, *texts: _set_points(meter, meter.settings.list_kind, texts),
            _points_text,
            set_arguments=(1, 1000),
        ),
    )


@cache
def _vocabulary(dialect: type[LcrDialect]) -> Vocabulary:
    acquisitions = map(acquisition, dialect.acquire.values())
    return Vocabulary((*COMMON_COMMANDS, *_settings(dialect), *READINGS, *acquisitions, *SPOTS))
