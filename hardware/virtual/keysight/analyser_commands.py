"""Commands of the impedance analyser E4990A.

Source: the SCPI tree of the E4990A's help, as public drivers of the analyser use it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from ..language import SUFFIX_OUT_OF_RANGE, CommandError, ExecutionError, MeterCommand
from .analyser_settings import BAND, CURRENT, POINTS, VOLTAGE, AnalyserSettings, parse_segments
from .e4990a import numbers_text
from .error_queue import ILLEGAL_VALUE
from .keysight_common_commands import operation_register
from .keysight_corrections import correction_commands
from .scpi_values import (
    check_suffixes,
    integer,
    nr3,
    number,
    on_off,
    one_of,
    setting,
    switch,
    switch_text,
    within,
    word,
)

if TYPE_CHECKING:
    from .e4990a import VirtualE4990A

MAX_TRACES = 4
PARAMETERS = tuple("Z Y R X G B LS LP CS CP RS RP Q D TZ TY".split())


def _on_channel(act: Callable[..., Any]) -> Callable[..., Any]:
    """Action of a command with the number of a channel, of which there is one."""

    def on_channel(meter: VirtualE4990A, channel: int, *given: Any) -> Any:
        check_suffixes((channel,))
        return act(meter, *given)

    return on_channel


def _integer(low: int, high: int) -> Callable[[Any, str], int]:
    return lambda meter, text: integer(text, low, high, clip=True)


def _sweep_edge(name: str) -> Callable[..., None]:
    """Setter of start, stop, center or span, in terms of start and stop."""

    def set_edge(meter: VirtualE4990A, text: str) -> None:
        settings = meter.settings
        value = number(text, 0.0 if name == "span" else BAND[0], BAND[1], "HZ", clip=True)
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
    parameters[trace - 1] = one_of(*PARAMETERS)(text)
    meter.settings.parameters = tuple(parameters)


def _defined(meter: VirtualE4990A, channel: int, trace: int) -> str:
    check_suffixes((channel,))
    if trace > len(meter.settings.parameters):
        raise CommandError(trace, SUFFIX_OUT_OF_RANGE)
    return meter.settings.parameters[trace - 1]


def _count_traces(meter: VirtualE4990A, text: str) -> None:
    count = integer(text, 1, MAX_TRACES, clip=True)
    meter.settings.parameters = (*meter.settings.parameters, *("Z",) * count)[:count]
    meter.settings.selected = min(meter.settings.selected, count)


def _select(meter: VirtualE4990A, channel: int, trace: int) -> None:
    check_suffixes((channel,))
    if trace > len(meter.settings.parameters):
        raise CommandError(trace, SUFFIX_OUT_OF_RANGE)
    meter.settings.selected = trace


def _ascii_only(meter: VirtualE4990A, text: str) -> None:
    """Only ASCii: the virtual analyser has no binary answers."""
    if one_of("ASCii", "REAL", "REAL32")(text) != "ASC":
        raise ExecutionError(text, ILLEGAL_VALUE)


def _nothing(meter: VirtualE4990A, *given: Any) -> None:
    """Accept what only changes the display."""


SWEEP = (
    _edge(":SENSe#:FREQuency:STARt", "start", lambda settings: settings.start),
    _edge(":SENSe#:FREQuency:STOP", "stop", lambda settings: settings.stop),
    _edge(
        ":SENSe#:FREQuency:CENTer", "center", lambda settings: (settings.start + settings.stop) / 2
    ),
    _edge(":SENSe#:FREQuency:SPAN", "span", lambda settings: settings.stop - settings.start),
    MeterCommand(
        ":SENSe#:FREQuency:DATA",
        on_query=_on_channel(lambda meter: numbers_text(meter.settings.frequencies)),
    ),
    setting(":SENSe#:SWEep:POINts", "points", _integer(*POINTS)),
    setting(":SENSe#:SWEep:TYPE", "sweep_type", word("LINear", "LOGarithmic", "SEGMent")),
    setting(":SENSe#:SWEep:DELay", "delay", within(0.0, 30.0, "S", clip=True), nr3),
    MeterCommand(
        ":SENSe#:SEGMent:DATA",
        _on_channel(_set_segments),
        _on_channel(lambda meter: numbers_text(meter.settings.segment_table)),
        set_arguments=(1, 3000),
    ),
    MeterCommand(
        ":SENSe#:SEGMent:COUNt",
        on_query=_on_channel(lambda meter: len(meter.settings.segments)),
    ),
    MeterCommand(
        ":SENSe#:SEGMent:SWEep:POINts",
        on_query=_on_channel(
            lambda meter: sum(segment.points for segment in meter.settings.segments)
        ),
    ),
    setting(":SENSe#:APERture[:TIME]", "time", _integer(1, 5)),
    setting(":SENSe#:AVERage[:STATe]", "point_average", on_off, switch_text),
    setting(":SENSe#:AVERage:COUNt", "point_count", _integer(1, 999)),
    setting(":CALCulate#:AVERage[:STATe]", "sweep_average", on_off, switch_text),
    setting(":CALCulate#:AVERage:COUNt", "sweep_count", _integer(1, 999)),
    MeterCommand(":CALCulate#:AVERage:CLEar", _on_channel(_nothing), set_arguments=0),
    setting(":SOURce#:MODE", "level", word("VOLTage", "CURRent")),
    setting(":SOURce#:VOLTage[:LEVel]", "voltage", within(*VOLTAGE, "V", clip=True), nr3),
    setting(":SOURce#:CURRent[:LEVel]", "current", within(*CURRENT, "A", clip=True), nr3),
    setting(":SOURce#:BIAS:STATe", "bias", on_off, switch_text),
)
CORRECTIONS = (
    setting(":SENSe#:CORRection2:OPEN", "open_correction", on_off, switch_text),
    setting(":SENSe#:CORRection2:SHORt", "short_correction", on_off, switch_text),
    setting(":SENSe#:CORRection2:LOAD", "load_correction", on_off, switch_text),
    setting(":SENSe#:CORRection:COLLect:FPOints", "fixture_points", word("FIXed", "USER")),
    setting(":SENSe#:FIXTure:SELect", "fixture", word("NONE", "ARBitrary")),
    *correction_commands(
        *(f":SENSe#:CORRection2:COLLect:ACQuire:{kind}" for kind in ("OPEN", "SHORt", "LOAD"))
    ),
)
DATA = (
    MeterCommand(":CALCulate#:PARameter#:DEFine", _define, _defined),
    MeterCommand(":CALCulate#:PARameter#:SELect", _select, set_arguments=0),
    MeterCommand(
        ":CALCulate#:PARameter:COUNt",
        _on_channel(_count_traces),
        _on_channel(lambda meter: len(meter.settings.parameters)),
    ),
    MeterCommand(
        ":CALCulate#[:SELected]:DATA:FDATa",
        on_query=_on_channel(lambda meter: meter.formatted(meter.settings.selected)),
    ),
    MeterCommand(
        ":CALCulate#[:SELected]:DATA:RDATa",
        on_query=_on_channel(lambda meter: meter.complex_data()),
    ),
    MeterCommand(":FORMat:DATA", _ascii_only, lambda meter: "ASC"),
    setting(":FORMat:BORDer", "byte_order", word("NORMal", "SWAPped")),
    MeterCommand(":DISPlay:WINDow#:TRACe#:Y[:SCALe]:AUTO", _nothing, set_arguments=0),
    MeterCommand(":DISPlay:ENABle", _nothing),
    MeterCommand(":DISPlay:CCLear", _nothing, set_arguments=0),
)
TRIGGERS = (
    operation_register("PTRansition", "rising"),
    operation_register("NTRansition", "falling"),
    MeterCommand(
        ":TRIGger[:SEQuence]:SOURce",
        lambda meter, text: meter.set_source(text),
        lambda meter: meter.settings.trigger,
    ),
    setting(":TRIGger[:SEQuence]:AVERage", "average_trigger", on_off, switch_text),
    MeterCommand(":TRIGger[:SEQuence]:SINGle", lambda meter: meter.single(), set_arguments=0),
    MeterCommand(":TRIGger[:SEQuence][:IMMediate]", lambda meter: meter.trigger(), set_arguments=0),
    MeterCommand("*TRG", lambda meter: meter.bus_trigger(), set_arguments=0),
    MeterCommand(
        ":INITiate#[:IMMediate]", _on_channel(lambda meter: meter.initiate()), set_arguments=0
    ),
    MeterCommand(
        ":INITiate#:CONTinuous",
        _on_channel(lambda meter, text: meter.set_continuous(switch(text))),
        _on_channel(lambda meter: switch_text(meter.settings.continuous)),
    ),
)
ANALYSER_COMMANDS = (*SWEEP, *CORRECTIONS, *DATA, *TRIGGERS)
