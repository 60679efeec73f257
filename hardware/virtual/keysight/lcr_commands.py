"""Commands of the LCR meters E4980A, E4980AL and 4284A.

Source: Keysight E4980A/AL user's guide, chapter 10 (SCPI command reference), and what the drivers
of pymeasure and QCoDeS send.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING

from ..language import ExecutionError, MeterCommand, all_forms, matched_word
from .error_queue import ILLEGAL_VALUE, STALE_DATA, TOO_MUCH_DATA
from .keysight_corrections import correction_commands, spot_commands
from .lcr_settings import FUNCTIONS, fitting_range, rounded_frequency
from .scpi_values import (
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
    from .e4980a import VirtualE4980A

PAGES = tuple(
    "MEASurement BNUMber BCOunt LIST MSETup CSETup LTABle LSETup CATAlog SYSTem SELF MLARge".split()
)


def _frequency(meter: VirtualE4980A, text: str) -> float:
    return rounded_frequency(number(text, *meter.limits.frequency, "HZ"))


def _voltage(meter: VirtualE4980A, text: str) -> float:
    return number(text, *meter.limits.voltage, "V")


def _current(meter: VirtualE4980A, text: str) -> float:
    return number(text, *meter.limits.current, "A")


LISTED: dict[str, Callable[..., float]] = {
    "FREQ": _frequency,
    "VOLT": _voltage,
    "CURR": _current,
    "BVOL": within(-40.0, 40.0, "V"),
    "BCUR": within(-0.1, 0.1, "A"),
}
"""Readers of the points of a list, by what varies."""


def _reference(index: int) -> MeterCommand:
    """Command of the reference of a deviation, without unit."""

    def set_reference(meter: VirtualE4980A, text: str) -> None:
        both = list(meter.settings.references)
        both[index] = number(text, -1e15, 1e15)
        meter.settings.references = (both[0], both[1])

    return MeterCommand(
        f":FUNCtion:DEV{index + 1}:REFerence[:VALue]",
        set_reference,
        lambda meter: nr3(meter.settings.references[index]),
    )


def _fill_references(meter: VirtualE4980A) -> None:
    """Take the latest reading as references."""
    if not meter.latest.has_numbers:
        raise ExecutionError("FILL", STALE_DATA)
    meter.settings.references = meter.quantities(meter.latest)


def _learn(meter: VirtualE4980A) -> str:
    """Commands that restore the present settings. What has no value at present is left out."""
    lines = []
    for command in (*SETTINGS, *DELAYS[meter.trigger_delays]):
        header = ":".join(min(all_forms(command.header), key=lambda form: len("".join(form))))
        with suppress(ExecutionError):
            if command.on_query:
                lines.append(f":{header} {command.on_query(meter)}")
    return ";".join(lines)


def _level(header: str, kind: str, name: str, read: Callable[..., float]) -> MeterCommand:
    """Command of a level. A query for the level that is not in use is an error."""

    def set_level(meter: VirtualE4980A, text: str) -> None:
        setattr(meter.settings, name, read(meter, text))
        meter.settings.level = kind
        meter.changed()

    def query(meter: VirtualE4980A) -> str:
        if meter.settings.level != kind:
            raise ExecutionError(header, STALE_DATA)
        return nr3(getattr(meter.settings, name))

    return MeterCommand(header, set_level, query)


def _set_range(meter: VirtualE4980A, text: str) -> None:
    value = fitting_range(number(text, 0.1, 100e3, "OHM"))
    meter.settings.range, meter.settings.auto_range = value, False
    meter.changed()


def _set_aperture(meter: VirtualE4980A, aperture: str, averaging: str = "") -> None:
    speed = one_of("SHORt", "MEDium", "LONG")(aperture)
    if averaging:
        meter.settings.averaging = integer(averaging, 1, 256)
    meter.settings.aperture = speed
    meter.changed()


def _length(meter: VirtualE4980A, text: str) -> int:
    value = number(text, 0, 4, "M")
    if value not in meter.limits.lengths:
        raise ExecutionError(text, ILLEGAL_VALUE)
    return int(value)


def _list(kind: str, header: str) -> MeterCommand:
    """Command of the points of a list sweep, which replace those of another kind."""

    def set_list(meter: VirtualE4980A, *texts: str) -> None:
        _set_points(meter, kind, LISTED[kind], texts)

    def query(meter: VirtualE4980A) -> str:
        if meter.settings.list_kind != kind:
            raise ExecutionError(header, STALE_DATA)
        return _points_text(meter)

    return MeterCommand(header, set_list, query, set_arguments=(1, 1000))


def _set_points(
    meter: VirtualE4980A, kind: str, read: Callable[..., float], texts: Sequence[str]
) -> None:
    if len(texts) > meter.limits.list_points:
        raise ExecutionError(len(texts), TOO_MUCH_DATA)
    meter.settings.list_values = tuple(read(meter, text) for text in texts)
    meter.settings.list_kind, meter.step = kind, 0
    meter.changed()


def _points_text(meter: VirtualE4980A) -> str:
    if not meter.settings.list_values:
        raise ExecutionError("LIST", STALE_DATA)
    return ",".join(nr3(value) for value in meter.settings.list_values)


def _set_stimulus(meter: VirtualE4980A, kind: str, second: str = "NONE") -> None:
    """What a list varies. A second stimulus is refused: the virtual meter varies one."""
    first = one_of("FREQuency", "VOLTage", "CURRent")(kind)
    one_of("NONE")(second)
    if first != meter.settings.list_kind:
        _clear_list(meter)
    meter.settings.list_kind = first


def _stimulus_data(meter: VirtualE4980A, *texts: str) -> None:
    _set_points(meter, meter.settings.list_kind, LISTED[meter.settings.list_kind], texts)


def _clear_list(meter: VirtualE4980A) -> None:
    meter.settings.list_values, meter.step = (), 0
    meter.changed()


def _buffer(text: str) -> None:
    if matched_word(text, ("DBUF",)) is None:
        raise ExecutionError(text, ILLEGAL_VALUE)


def _resize(meter: VirtualE4980A, name: str, size: str) -> None:
    _buffer(name)
    meter.buffer_size = integer(size, 1, 201)
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
    if one_of("ASCii", "REAL")(texts[0]) != "ASC":
        raise ExecutionError(texts, ILLEGAL_VALUE)
    for text in texts[1:]:
        integer(text, 64, 64)


def _continuous(header: str) -> MeterCommand:
    return MeterCommand(
        header,
        lambda meter, text: meter.set_continuous(switch(text)),
        lambda meter: switch_text(meter.settings.continuous),
    )


def _initiate(meter: VirtualE4980A) -> None:
    meter.initiate()


SETTINGS = (
    setting(":FREQuency[:CW]", "frequency", _frequency, nr3),
    _level(":VOLTage[:LEVel]", "VOLT", "voltage", _voltage),
    _level(":CURRent[:LEVel]", "CURR", "current", _current),
    setting(":FUNCtion:IMPedance[:TYPE]", "function", word(*FUNCTIONS)),
    MeterCommand(
        ":FUNCtion:IMPedance:RANGe[:VALue]", _set_range, lambda meter: nr3(meter.settings.range)
    ),
    setting(":FUNCtion:IMPedance:RANGe:AUTO", "auto_range", on_off, switch_text),
    MeterCommand(
        ":APERture",
        _set_aperture,
        lambda meter: f"{meter.settings.aperture},{meter.settings.averaging}",
        set_arguments=(1, 2),
    ),
    setting(":FUNCtion:DEV1:MODE", "deviation_1", word("ABSolute", "PERCent", "OFF")),
    setting(":FUNCtion:DEV2:MODE", "deviation_2", word("ABSolute", "PERCent", "OFF")),
    _reference(0),
    _reference(1),
    setting(":TRIGger:SOURce", "trigger", word("INTernal", "HOLD", "EXTernal", "BUS")),
    setting(":COMParator[:STATe]", "comparator", on_off, switch_text),
    setting(":FORMat:ASCii:LONG", "long_format", on_off, switch_text),
    MeterCommand(
        ":FORMat[:DATA]", _set_format, lambda meter: meter.data_format, set_arguments=(1, 2)
    ),
    setting(":AMPLitude:ALC", "level_control", on_off, switch_text),
    setting(":BIAS:STATe", "bias", on_off, switch_text),
    setting(":BIAS:VOLTage[:LEVel]", "bias_voltage", LISTED["BVOL"], nr3),
    setting(":BIAS:CURRent[:LEVel]", "bias_current", LISTED["BCUR"], nr3),
    setting(":BIAS:RANGe:AUTO", "bias_auto_range", on_off, switch_text),
    setting(":OUTPut:HPOWer", "high_power", on_off, switch_text),
    setting(":DISPlay:PAGE", "page", word(*PAGES)),
    setting(":DISPlay:ENABle", "display", on_off, switch_text),
    setting(":CORRection:OPEN:STATe", "open_correction", on_off, switch_text),
    setting(":CORRection:SHORt:STATe", "short_correction", on_off, switch_text),
    setting(":CORRection:LOAD:STATe", "load_correction", on_off, switch_text),
    setting(":CORRection:LOAD:TYPE", "load_type", word(*FUNCTIONS)),
    setting(":CORRection:LENGth", "length", _length),
    setting(":CORRection:METHod", "method", word("SINGle", "MULTi")),
    setting(":LIST:MODE", "list_mode", word("SEQuence", "STEPped")),
    _list("FREQ", ":LIST:FREQuency"),
    _list("VOLT", ":LIST:VOLTage"),
    _list("CURR", ":LIST:CURRent"),
    _list("BVOL", ":LIST:BIAS:VOLTage"),
    _list("BCUR", ":LIST:BIAS:CURRent"),
    MeterCommand(
        ":LIST:STIMulus:TYPE",
        _set_stimulus,
        lambda meter: f"{meter.settings.list_kind},NONE",
        set_arguments=(1, 2),
    ),
    MeterCommand(":LIST:STIMulus:DATA", _stimulus_data, _points_text, set_arguments=(1, 1000)),
    MeterCommand(":LIST:CLEar:ALL", _clear_list, set_arguments=0),
    _continuous(":INITiate:CONTinuous"),
)
DELAYS = {
    True: (
        setting(":TRIGger:DELay", "step_delay", within(0.0, 999.0, "S"), nr3),
        setting(":TRIGger:TDELay", "delay", within(0.0, 999.0, "S"), nr3),
    ),
    False: (setting(":TRIGger:DELay", "step_delay", within(0.0, 60.0, "S"), nr3),),
}
"""Commands of delays, by whether the trigger has one of its own."""
READINGS = (
    MeterCommand("*TRG", lambda meter: meter.trigger_and_fetch(), set_arguments=0),
    MeterCommand(":TRIGger[:IMMediate]", lambda meter: meter.trigger(), set_arguments=0),
    MeterCommand(":INITiate[:IMMediate]", _initiate, set_arguments=0),
    MeterCommand(":TRIGger:INITiate[:IMMediate]", _initiate, set_arguments=0),  # of pymeasure
    _continuous(":TRIGger:CONTinuous"),  # of pymeasure
    MeterCommand("*LRN", on_query=_learn),
    MeterCommand(":FUNCtion:DEV1:REFerence:FILL", _fill_references, set_arguments=0),
    MeterCommand(":FETCh[:IMPedance][:FORMatted]", on_query=lambda meter: meter.fetch()),
    MeterCommand(":FETCh[:IMPedance]:CORRected", on_query=lambda meter: meter.fetch_corrected()),
    MeterCommand(":MEMory:DIM", _resize, set_arguments=2),
    MeterCommand(":MEMory:FILL", _fill),
    MeterCommand(":MEMory:CLEar", _clear_buffer),
    MeterCommand(":MEMory:READ", on_query=_read_buffer, query_arguments=1),
)
LCR_COMMANDS = (
    *SETTINGS,
    *READINGS,
    *correction_commands(*(f":CORRection:{kind}[:EXECute]" for kind in ("OPEN", "SHORt", "LOAD"))),
    *spot_commands(),
)
