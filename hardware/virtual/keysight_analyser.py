"""Virtual impedance analyser Keysight E4990A: sweeps of one channel with up to four traces.

Sources: the SCPI tree of the E4990A's help as public drivers use it (sweep, segment table, data),
and manuals of its family: the programmer's guide of the E5061A/E5062A, chapter 13 and appendix B
(trigger system, registers, queue of 100 errors, 2 to 1601 points), and the user's guide of the
E4981A, page 209 (a number out of range is replaced by the nearest limit).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, ClassVar

import numpy as np

from ...simulator.meters.accuracy_table import (
    METER_BANDS,
    OUTPUT_RESISTANCE,
    AccuracyTable,
    ReadingConditions,
)
from ..meter.keysight_dialects import AnalyserDialect
from ..meter.setting import NO_NUMBER, rows
from .keysight_instrument import (
    CLIPPING,
    COMMON_COMMANDS,
    ILLEGAL_VALUE,
    SCPI,
    KeysightInstrument,
    acquisition,
    continuous_command,
    nr3,
    operation_register,
    shown_quantity,
)
from .language import (
    PARAMETER_NOT_ALLOWED,
    SUFFIX_OUT_OF_RANGE,
    CommandError,
    ExecutionError,
    MeterCommand,
    Vocabulary,
    check_suffixes,
    setting_commands,
)
from .measurement import Settings

BAND = METER_BANDS["E4990A"]
"""Lowest and highest frequency with option 120, Hz."""
SEGMENTS = (1, 201)
"""Limits of the number of segments."""
SEGMENT_HEADER = 9
OPTIONAL_COLUMNS = (2, 2, 1, 1, 1, 1)
"""Columns of a segment for each switch: oscillator, bias, time, averaging, segment time, delay."""


@dataclass(frozen=True)
class Segment:
    """A part of a segment sweep. start, stop: Hz. volts: level of the oscillator, if its own.

    time: 1 to 5. averaging: number of readings. Each is None if the segment has none of its own.
    """

    start: float
    stop: float
    points: int
    volts: float | None = None
    time: int | None = None
    averaging: int | None = None


class AnalyserSettings(Settings):
    """Settings after `*RST`, but continuous. start, stop: Hz.

    segments: of a sweep of type SEGM, as they were sent in segment_table.
    """

    dialect = AnalyserDialect
    own: ClassVar = {
        "start": BAND[0],
        "stop": BAND[1],
        "segments": (Segment(*BAND, 2),),
        "segment_table": (7, 0, 0, 0, 0, 0, 0, 0, 1, *BAND, 2),
        "frequency": BAND[0],
        "parameters": ("Z", "TZ"),
        "selected": 1,
    }

    @property
    def frequencies(self) -> list[float]:
        """Frequency of each point, Hz."""
        return [point.frequency for point in self.sweep_points()]

    @property
    def averaging(self) -> int:
        """Readings of a point that are averaged, in all sweeps of a trigger."""
        return self.averaging_count if self.averages else 1

    def sweep_points(self) -> Sequence[AnalyserSettings]:
        """Settings at each point of the sweep."""
        if self.sweep_type == "SEGM":
            return [point for segment in self.segments for point in self._segment_points(segment)]
        spaced = np.geomspace if self.sweep_type == "LOG" else np.linspace
        values = spaced(self.start, self.stop, self.points).tolist()
        return [self.replaced(frequency=value) for value in values]

    def _segment_points(self, segment: Segment) -> list[AnalyserSettings]:
        own = self.replaced(
            voltage=self.voltage if segment.volts is None else segment.volts,
            speed=segment.time or self.speed,
            averages=self.averages or segment.averaging is not None,
            averaging_count=segment.averaging or self.averaging_count,
        )
        values = np.linspace(segment.start, segment.stop, segment.points).tolist()
        return [own.replaced(frequency=value) for value in values]

    @property
    def seconds(self) -> float:
        """Time of one point, s; at least a period of its frequency."""
        return self.averaging * max(
            self.dialect.typical_seconds[self.speed - 1], 1 / self.frequency
        )

    def conditions(self, Z: complex, accuracy: AccuracyTable) -> ReadingConditions:
        """Conditions of a measurement of Z in ohm; the analyser has one range."""
        loop = abs(OUTPUT_RESISTANCE + Z)
        level = self.voltage if self.source_mode == "VOLTAGE" else self.constant_current * loop
        speed = AnalyserDialect.table_speeds[self.speed - 1]
        return ReadingConditions(self.frequency, 1, speed, self.averaging, level)


def parse_segments(texts: Sequence[str]) -> tuple[tuple[Segment, ...], tuple[float, ...]]:
    """Segments in the arguments of `:SENSe:SEGMent:DATA`, and these arguments as numbers.

    7, mode (0: start and stop, 1: center and span), six switches of further columns, number of
    segments, and for each segment start, stop, points and these columns. Raises CommandError for
    another number of arguments, ExecutionError for values out of range.
    """
    head = [SCPI.integer(text, 0, 201) for text in texts[:SEGMENT_HEADER]]
    if len(head) < SEGMENT_HEADER or head[0] != 7 or max(head[1:8]) > 1 or head[8] < SEGMENTS[0]:
        raise CommandError(texts, ILLEGAL_VALUE)
    widths = [width * on for width, on in zip(OPTIONAL_COLUMNS, head[2:8], strict=True)]
    width = 3 + sum(widths)
    rest = texts[SEGMENT_HEADER:]
    if len(rest) != head[8] * width:
        raise CommandError(texts, PARAMETER_NOT_ALLOWED)
    rows = [rest[n : n + width] for n in range(0, len(rest), width)]
    segments = tuple(_segment(row, head[1] == 1, widths) for row in rows)
    return segments, tuple(SCPI.number(text, -1e15, 1e15) for text in texts)


def _segment(row: Sequence[str], centred: bool, widths: Sequence[int]) -> Segment:
    first, second = (SCPI.number(text, 0, BAND[1], "HZ") for text in row[:2])
    start, stop = (first - second / 2, first + second / 2) if centred else (first, second)
    for edge in (start, stop):
        SCPI.number(repr(edge), *BAND)
    oscillator, bias, time, averaging, *_ = widths
    at = 3 + oscillator
    dialect = AnalyserDialect
    volts = SCPI.parse(dialect.voltage.twin, [row[4]]) if oscillator else None
    at += bias
    seconds = SCPI.parse(dialect.speed.twin, [row[at]]) if time else None
    count = SCPI.parse(dialect.averaging_count.twin, [row[at + time]]) if averaging else None
    points = SCPI.parse(dialect.points.twin, [row[2]])
    return Segment(start, stop, points, volts, seconds, count)


QUANTITIES = {"R": "RS", "TZ": "PHASE", "TY": "YPHASE", "D": "DC", "Q": "QC"}
"""Names of quantities in `shown_quantity` that differ from those of the analyser."""


@dataclass
class VirtualE4990A(KeysightInstrument):
    """Virtual E4990A with option 120. waited: True if `*OPC?` waits for the running sweep."""

    model: str = "E4990A"
    firmware: ClassVar[str] = "A.02.12"
    queue_length: ClassVar[int] = 100
    rising: int = 0x4030
    falling: int = 0
    settings_type: ClassVar = AnalyserSettings
    waited: bool = False

    @classmethod
    def vocabulary(cls) -> Vocabulary:
        """All commands of the analyser."""
        return _vocabulary()

    @property
    def shown_settings(self) -> dict[str, Any]:
        """Settings that the control port shows. frequency: of the first point, Hz."""
        frequency = self.points()[0].frequency
        return {"frequency": frequency, "range": "auto", "trigger": self.settings.trigger}

    def points(self) -> Sequence[AnalyserSettings]:
        """Settings at each point of the sweep."""
        return self.settings.sweep_points()

    @property
    def seconds(self) -> float:
        """Time of what a trigger starts, at pace 1, s."""
        settings = self.settings
        averaged = settings.sweep_averages and settings.average_trigger
        sweeps = settings.sweep_count if averaged else 1
        return sweeps * sum(point.seconds + settings.sweep_delay for point in self.points())

    async def trigger(self) -> None:
        """`:TRIGger` or `*TRG`: start a sweep that `*OPC?` does not wait for."""
        await super().trigger()
        self.waited = False

    def set_source(self, text: str) -> None:
        """`:TRIGger:SOURce`, which ends a running sweep."""
        self.settings.trigger = SCPI.parse(AnalyserDialect.trigger.twin, [text])
        self.abort()

    async def single(self) -> None:
        """`:TRIGger:SINGle`: start a sweep that `*OPC?` waits for."""
        await self.trigger()
        self.waited = True

    async def finished(self) -> None:
        """Wait for acquisitions, and for a sweep that was started by `:TRIGger:SINGle`."""
        await self.settle_if_done()
        if self.waited or self.pending is None:
            await super().finished()

    async def formatted(self, trace: int) -> str:
        """`:CALCulate:DATA:FDATa?`: value of a trace and 0 for each point of the latest sweep."""
        if trace > len(self.settings.parameters):
            raise CommandError(trace, SUFFIX_OUT_OF_RANGE)
        name = self.settings.parameters[trace - 1]
        quantity_name = str(QUANTITIES.get(name, name))
        return await self._data(
            lambda Z, frequency: (shown_quantity(quantity_name, Z, frequency), 0.0)
        )

    async def complex_data(self) -> str:
        """`:CALCulate:DATA:RDATa?`: R and X for each point of the latest sweep."""
        return await self._data(lambda Z, frequency: (Z.real, Z.imag))

    async def _data(self, of: Callable[[complex, float], tuple[float, float]]) -> str:
        """Pairs of the latest sweep, which is old while another one runs; 0 before any sweep."""
        if self.runs_freely:
            await self.newest()
        await self.settle_if_done()
        count = len(self.points())
        if len(self.results) != count:
            return numbers_text([0.0] * 2 * count)
        pairs = [
            of(each.Z, each.conditions.frequency)
            if each.status.has_values
            else (NO_NUMBER, NO_NUMBER)
            for each in self.results
        ]
        return numbers_text([value for pair in pairs for value in pair])


def numbers_text(values: Sequence[float]) -> str:
    """Numbers with twelve digits, joined by commas."""
    return ",".join(nr3(value, 11) for value in values)


MAX_TRACES = 4
PARAMETERS = tuple("Z Y R X G B LS LP CS CP RS RP Q D TZ TY".split())


def _on_channel(act: Callable[..., Any]) -> Callable[..., Any]:
    """Action of a command with the number of a channel, of which there is one."""

    def on_channel(meter: VirtualE4990A, channel: int, *given: Any) -> Any:
        check_suffixes((channel,))
        return act(meter, *given)

    return on_channel


def _sweep_edge(name: str) -> Callable[..., None]:
    """Setter of start, stop, center or span, in terms of start and stop."""

    def set_edge(meter: VirtualE4990A, text: str) -> None:
        settings = meter.settings
        value = CLIPPING.number(text, 0.0 if name == "span" else BAND[0], BAND[1], "HZ")
        start, stop = settings.start, settings.stop
        if name == "start":
            start, stop = value, max(value, stop)
        elif name == "stop":
            start, stop = min(start, value), value
        else:
            center, span = (start + stop) / 2, stop - start
            center, span = (value, span) if name == "center" else (center, value)
            span = min(span, 2 * (center - BAND[0]), 2 * (BAND[1] - center))
            start, stop = center - span / 2, center + span / 2
        settings.start, settings.stop = start, stop
        meter.changed()

    return set_edge


def _edge(header: str, name: str, query: Callable[[AnalyserSettings], float]) -> MeterCommand:
    return MeterCommand(
        header,
        _on_channel(_sweep_edge(name)),
        _on_channel(lambda meter: nr3(query(meter.settings), 11)),
    )


def _set_segments(meter: VirtualE4990A, *texts: str) -> None:
    meter.settings.segments, meter.settings.segment_table = parse_segments(texts)
    meter.changed()


def _define(meter: VirtualE4990A, channel: int, trace: int, text: str) -> None:
    check_suffixes((channel,))
    parameters = list(meter.settings.parameters)
    if trace > len(parameters):
        raise CommandError(trace, SUFFIX_OUT_OF_RANGE)
    parameters[trace - 1] = SCPI.word(text, PARAMETERS)
    meter.settings.parameters = tuple(parameters)


def _defined(meter: VirtualE4990A, channel: int, trace: int) -> str:
    check_suffixes((channel,))
    if trace > len(meter.settings.parameters):
        raise CommandError(trace, SUFFIX_OUT_OF_RANGE)
    return meter.settings.parameters[trace - 1]


def _count_traces(meter: VirtualE4990A, text: str) -> None:
    count = CLIPPING.integer(text, 1, MAX_TRACES)
    meter.settings.parameters = (*meter.settings.parameters, *("Z",) * count)[:count]
    meter.settings.selected = min(meter.settings.selected, count)


def _select(meter: VirtualE4990A, channel: int, trace: int) -> None:
    check_suffixes((channel,))
    if trace > len(meter.settings.parameters):
        raise CommandError(trace, SUFFIX_OUT_OF_RANGE)
    meter.settings.selected = trace


def _ascii_only(meter: VirtualE4990A, text: str) -> None:
    """Only ASCii: the virtual analyser has no binary answers."""
    if SCPI.parse(AnalyserDialect.data_format.allowed, [text]) != "ASC":
        raise ExecutionError(text, ILLEGAL_VALUE)


def _nothing(meter: VirtualE4990A, *given: Any) -> None:
    """Accept what only changes the display."""


D = AnalyserDialect
SPECIAL = {
    "trace_count": MeterCommand(
        D.trace_count.header,
        _on_channel(_count_traces),
        _on_channel(lambda meter: len(meter.settings.parameters)),
    ),
    "trace_1": MeterCommand(":CALCulate#:PARameter#:DEFine", _define, _defined),
    "swept": MeterCommand(
        D.swept.header, on_query=_on_channel(lambda meter: numbers_text(meter.settings.frequencies))
    ),
    "segments": MeterCommand(
        D.segments.header,
        _on_channel(_set_segments),
        _on_channel(lambda meter: numbers_text(meter.settings.segment_table)),
        set_arguments=(1, 3000),
    ),
    "data_format": MeterCommand(D.data_format.header, _ascii_only, lambda meter: "ASC"),
    "trigger": MeterCommand(
        D.trigger.header,
        lambda meter, text: meter.set_source(text),
        lambda meter: SCPI.show(D.trigger.twin, meter.settings.trigger),
    ),
    "continuous": continuous_command(D.continuous.header),
}
ANALYSER_COMMANDS = (
    *setting_commands(CLIPPING, rows(AnalyserDialect), SPECIAL),
    _edge(":SENSe#:FREQuency:STARt", "start", lambda settings: settings.start),
    _edge(":SENSe#:FREQuency:STOP", "stop", lambda settings: settings.stop),
    _edge(
        ":SENSe#:FREQuency:CENTer", "center", lambda settings: (settings.start + settings.stop) / 2
    ),
    _edge(":SENSe#:FREQuency:SPAN", "span", lambda settings: settings.stop - settings.start),
    MeterCommand(
        ":SENSe#:SEGMent:COUNt", on_query=_on_channel(lambda meter: len(meter.settings.segments))
    ),
    MeterCommand(
        ":SENSe#:SEGMent:SWEep:POINts",
        on_query=_on_channel(
            lambda meter: sum(segment.points for segment in meter.settings.segments)
        ),
    ),
    MeterCommand(":CALCulate#:AVERage:CLEar", _on_channel(_nothing), set_arguments=0),
    *map(acquisition, D.acquire.values()),
    MeterCommand(":CALCulate#:PARameter#:SELect", _select, set_arguments=0),
    MeterCommand(
        ":CALCulate#[:SELected]:DATA:FDATa",
        on_query=_on_channel(lambda meter: meter.formatted(meter.settings.selected)),
    ),
    MeterCommand(
        ":CALCulate#[:SELected]:DATA:RDATa",
        on_query=_on_channel(lambda meter: meter.complex_data()),
    ),
    MeterCommand(":DISPlay:WINDow#:TRACe#:Y[:SCALe]:AUTO", _nothing, set_arguments=0),
    MeterCommand(":DISPlay:ENABle", _nothing),
    MeterCommand(":DISPlay:CCLear", _nothing, set_arguments=0),
    operation_register("PTRansition", "rising"),
    operation_register("NTRansition", "falling"),
    MeterCommand(":TRIGger[:SEQuence]:SINGle", lambda meter: meter.single(), set_arguments=0),
    MeterCommand(":TRIGger[:SEQuence][:IMMediate]", lambda meter: meter.trigger(), set_arguments=0),
    MeterCommand("*TRG", lambda meter: meter.bus_trigger(), set_arguments=0),
    MeterCommand(
        ":INITiate#[:IMMediate]", _on_channel(lambda meter: meter.initiate()), set_arguments=0
    ),
)


@cache
def _vocabulary() -> Vocabulary:
    return Vocabulary((*COMMON_COMMANDS, *ANALYSER_COMMANDS))
