"""Commands of settings: how an argument is read, and how the value is written."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ....simulator.meters.accuracy_table import METER_BANDS, RANGES, VIRTUAL_MODEL
from ..language import CommandError, MeterCommand, engineering, integer, matched_word, number
from .meter_state import PARAMETERS, SPEEDS

if TYPE_CHECKING:
    from .im3523 import VirtualHioki

Read = Callable[[str], Any]
Format = Callable[[Any], str]


def _one_of(*words: str) -> Read:
    def read(text: str) -> str:
        found = matched_word(text, words)
        if found is None:
            raise CommandError(text)
        return found

    return read


def _parse_on_off(text: str) -> bool:
    return _one_of("ON", "1", "OFF", "0")(text) in ("ON", "1")


def _on_off_text(value: bool) -> str:
    return "ON" if value else "OFF"


def _rounded_number(low: float, high: float, digits: int) -> Read:
    return lambda text: float(f"{number(text, low, high):.{digits - 1}E}")


def _parse_averaging(text: str) -> int:
    return 1 if text.upper() == "OFF" else integer(text, 1, 256)


def _averaging_text(value: int) -> str:
    return "OFF" if value == 1 else str(value)


def _setting_command(header: str, name: str, read: Read, show: Format = str) -> MeterCommand:
    def set_value(meter: VirtualHioki, text: str) -> None:
        setattr(meter.settings, name, read(text))
        meter.changed()

    return MeterCommand(header, set_value, lambda meter: show(getattr(meter.settings, name)))


def _set_each(meter: VirtualHioki, which: str, name: str, value: Any) -> None:
    ranges = RANGES if which.upper() == "ALL" else [integer(which, 1, 10)]
    for n in ranges:
        meter.settings.each_range[n] = replace(meter.settings.each_range[n], **{name: value})
    meter.changed()


def _each_range(
    header: str, sibling: str, name: str, read: Read, show: Format
) -> list[MeterCommand]:
    """The IM3523's command with a range, and its siblings' command without."""

    def kept(meter: VirtualHioki, n: int) -> str:
        return show(getattr(meter.settings.each_range[n], name))

    return [
        MeterCommand(
            header,
            lambda meter, which, text: _set_each(meter, which, name, read(text)),
            lambda meter, which: kept(meter, integer(which, 1, 10)),
            set_arguments=2,
            query_arguments=1,
        ),
        MeterCommand(
            sibling,
            lambda meter, text: _set_each(meter, "ALL", name, read(text)),
            lambda meter: kept(meter, meter.settings.range),
            siblings_only=True,
        ),
    ]


def _set_range(meter: VirtualHioki, text: str) -> None:
    meter.settings.range, meter.settings.auto_range = integer(text, 1, 10), False
    meter.changed()


def _parameter(header: str, index: int, siblings_only: bool = False) -> MeterCommand:
    def set_value(meter: VirtualHioki, text: str) -> None:
        pair = list(meter.settings.parameters)
        pair[index] = _one_of(*PARAMETERS)(text)
        meter.settings.parameters = (pair[0], pair[1])

    return MeterCommand(
        header,
        set_value,
        lambda meter: meter.settings.parameters[index],
        siblings_only=siblings_only,
    )


def _volts_text(value: float) -> str:
    return f"{value:.3f}"


SETTING_COMMANDS = (
    _setting_command(":HEADer", "header", _parse_on_off, _on_off_text),
    _setting_command(":MODE", "mode", _one_of("LCR", "CONTinuous")),
    _setting_command(":COMMand:COMPatible", "compatible", _parse_on_off, _on_off_text),
    _setting_command(
        ":FREQuency",
        "frequency",
        _rounded_number(*METER_BANDS[VIRTUAL_MODEL], 5),
        lambda f: engineering(f, 5),
    ),
    _setting_command(":LEVel", "level", _one_of("V", "CV", "CC")),
    _setting_command(":LEVel:VOLTage", "voltage", _rounded_number(5e-3, 5, 4), _volts_text),
    _setting_command(
        ":LEVel:CVOLTage", "constant_voltage", _rounded_number(5e-3, 5, 4), _volts_text
    ),
    _setting_command(
        ":LEVel:CCURRent",
        "constant_current",
        _rounded_number(1e-5, 50e-3, 4),
        lambda i: engineering(i, 4),
    ),
    MeterCommand(":RANGe", _set_range, lambda meter: meter.settings.range),
    _setting_command(":RANGe:AUTO", "auto_range", _parse_on_off, _on_off_text),
    _parameter(":PARameter1", 0),
    _parameter(":PARameter2", 1),
    _parameter(":PARameter3", 1, siblings_only=True),
    _parameter(":PARameter4", 1, siblings_only=True),
    _setting_command(":TRIGger", "trigger", _one_of("INTernal", "EXTernal")),
    _setting_command(":CORRection:CABLe", "cable", lambda text: integer(text, 0, 1)),
    _setting_command(":CORRection:LOAD", "load_correction", _parse_on_off, _on_off_text),
    _setting_command(
        ":TRANsmit:TERMinator",
        "carriage_return_only",
        lambda text: bool(integer(text, 0, 1)),
        lambda value: str(int(value)),
    ),
    *_each_range(":RANGe:SYNC:SPEEd", ":SPEEd", "speed", _one_of(*SPEEDS), str),
    *_each_range(
        ":RANGe:SYNC:AVERaging", ":AVERaging", "averaging", _parse_averaging, _averaging_text
    ),
    *_each_range(
        ":RANGe:SYNC:TRIGger:DELay",
        ":TRIGger:DELay",
        "delay",
        lambda text: number(text, 0, 9.9999),
        lambda value: f"{value:.4f}",
    ),
)
