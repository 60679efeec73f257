"""Virtual LCR meter of Hioki: the IM3523 and, without further ranges, its siblings.

Source: Hioki's communication commands of the IM3523.
"""

from __future__ import annotations

import asyncio
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Any

from ....simulator.meters.accuracy_table import METER_BANDS, RANGES, VIRTUAL_MODEL
from ..instrument import Instrument, Standard
from ..language import (
    CommandError,
    ExecutionError,
    LanguageError,
    MeterCommand,
    Vocabulary,
    engineering,
    integer,
    matched_word,
    number,
)
from ..measurement import (
    NO_RESULT,
    OVERFLOW,
    UNDERFLOW,
    WITHOUT_NUMBERS,
    MeasurementResult,
    quantity,
)
from .meter_state import ITEMS, PARAMETERS, SPEEDS, Measuring, Registers, Settings, conditions
from .virtual_corrections import SETTINGS, CorrectionRuns

OVER, UNDER = " 999999E+28", "-999999E+28"
DECIMALS = {"PHASE": 3, "Q": 3, "D": 6}


def measurement_text(result: MeasurementResult, settings: Settings) -> str:
    """Answer to `:MEASure?` in the form that `:MEASure:VALid` and `:MEASure:ITEM` set."""
    parts = [str(result.status)] if settings.valid & 16 else []
    if settings.valid & 2:
        parts += [_value(result, name) for name in requested_quantities(settings)]
    if settings.valid & 1:
        parts.append("0")
    return ",".join(parts)


def requested_quantities(settings: Settings) -> list[str]:
    """Names in the order of the registers; the displayed pair if both registers are 0."""
    if settings.items == (0, 0):
        return [name for name in settings.parameters if name != "OFF"]
    return [
        name
        for register, names in zip(settings.items, ITEMS, strict=True)
        for bit, name in enumerate(names)
        if register >> bit & 1
    ]


def _value(result: MeasurementResult, name: str) -> str:
    if result.status == UNDERFLOW:
        return UNDER
    if result.status in WITHOUT_NUMBERS:
        return OVER
    return measured_text(quantity(name, result.Z, result.conditions.frequency), DECIMALS.get(name))


def measured_text(value: float, decimals: int | None = None) -> str:
    """A measured value after a space or a minus: six digits, or `decimals` (phase, Q, D).

    A value beyond any display is written as overflow.
    """
    if not (math.isfinite(value) and abs(value) < 1e30):
        return OVER
    if decimals is not None:
        return f"{value: 8.{decimals}f}"
    text = engineering(value, 6)
    return text if text.startswith("-") else f" {text}"


def _set_mask(name: str, text: str, meter: VirtualHioki) -> None:
    setattr(meter.registers, name, integer(text, 0, 255))


async def _complete(meter: VirtualHioki) -> int:
    await meter.wait()
    return 1


async def _note_completion(meter: VirtualHioki) -> None:
    await meter.wait()
    meter.registers.note(Standard.OPC)


def _mask(header: str, name: str) -> MeterCommand:
    return MeterCommand(
        header,
        on_set=lambda meter, text: _set_mask(name, text, meter),
        on_query=lambda meter: getattr(meter.registers, name),
        has_header=False,
    )


COMMON_COMMANDS = (
    MeterCommand("*IDN", on_query=lambda meter: meter.identity, has_header=False),
    MeterCommand("*RST", on_set=lambda meter: meter.reset(), set_arguments=0),
    MeterCommand(":PRESet", on_set=lambda meter: meter.reset(), set_arguments=0),
    MeterCommand("*CLS", on_set=lambda meter: meter.registers.clear(), set_arguments=0),
    MeterCommand(
        "*OPC", on_set=_note_completion, on_query=_complete, set_arguments=0, has_header=False
    ),
    MeterCommand("*WAI", on_set=lambda meter: meter.wait(), set_arguments=0),
    MeterCommand("*TST", on_query=lambda meter: 0, has_header=False),
    MeterCommand("*TRG", on_set=lambda meter: meter.trigger(), set_arguments=0),
    MeterCommand("*ESR", on_query=lambda meter: meter.registers.take_standard(), has_header=False),
    MeterCommand(
        "*STB", on_query=lambda meter: meter.registers.status_byte(meter.waiting), has_header=False
    ),
    MeterCommand(
        ":ESR0", on_query=lambda meter: meter.registers.take_measuring(), has_header=False
    ),
    _mask("*ESE", "standard_mask"),
    _mask("*SRE", "request_mask"),
    _mask(":ESE0", "measuring_mask"),
)


def _set_items(meter: VirtualHioki, first: str, second: str) -> None:
    meter.settings.items = (integer(first, 0, 255), integer(second, 0, 127))


def _set_valid(meter: VirtualHioki, text: str) -> None:
    meter.settings.valid = integer(text, 1, 31)


def _correct(meter: VirtualHioki, kind: str, text: str) -> None:
    requested = matched_word(text, ("OFF", "ALL", "SPOT", "CANCel"))
    if requested is None:
        raise CommandError(text)
    if requested == "CANCEL":
        meter.corrections.cancel(kind)
    elif requested == "OFF":
        setattr(meter.settings, SETTINGS[kind], "OFF")
    else:
        meter.corrections.start(meter, kind, requested)


def _correction(header: str, kind: str) -> tuple[MeterCommand, MeterCommand]:
    return (
        MeterCommand(
            header,
            lambda meter, text: _correct(meter, kind, text),
            lambda meter: getattr(meter.settings, SETTINGS[kind]),
        ),
        MeterCommand(f"{header}:ERRor", on_query=lambda meter: meter.corrections.errors[kind]),
    )


MEASURING_COMMANDS = (
    MeterCommand(":MEASure", on_query=lambda meter: meter.measure(), has_header=False),
    MeterCommand(
        ":MEASure:ITEM",
        _set_items,
        lambda meter: ",".join(map(str, meter.settings.items)),
        set_arguments=2,
    ),
    MeterCommand(":MEASure:VALid", _set_valid, lambda meter: meter.settings.valid),
    *_correction(":CORRection:OPEN", "OPEN"),
    *_correction(":CORRection:SHORt", "SHORT"),
)


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


STATUS_EVENTS = {OVERFLOW: Measuring.MOF, UNDERFLOW: Measuring.MUF, 2: Measuring.REF}


@dataclass
class VirtualHioki(Instrument):
    """Virtual meter that speaks Hioki's language."""

    model: str = VIRTUAL_MODEL
    settings: Settings = field(default_factory=Settings)
    registers: Registers = field(default_factory=Registers)
    corrections: CorrectionRuns = field(default_factory=CorrectionRuns)

    @property
    def identity(self) -> str:
        """Answer to `*IDN?`."""
        return f"HIOKI,{self.model},{self.serial},V1.00"

    @property
    def band(self) -> tuple[float, float]:
        """Lowest and highest frequency of an IM3523, Hz."""
        return METER_BANDS[VIRTUAL_MODEL]

    @property
    def line_end(self) -> str:
        """CR+LF, or CR alone by `:TRANsmit:TERMinator 1`."""
        return "\r" if self.settings.carriage_return_only else "\r\n"

    @property
    def seconds(self) -> float:
        """Time of a measurement with the present settings at pace 1, s."""
        settings = self.settings
        delay = settings.each_range[settings.range].delay
        return delay + conditions(settings, settings.range, 0j).seconds

    def command(self, words: tuple[str, ...]) -> tuple[MeterCommand, tuple[int, ...]] | None:
        """Command of these words; None if unknown to the model."""
        found = vocabulary().find(words)
        compatible = self.model != VIRTUAL_MODEL or self.settings.compatible
        return None if found and found[0].siblings_only and not compatible else found

    def refuse(self, error: LanguageError) -> None:
        """Set the bit of the error; nothing is answered."""
        self.registers.note(Standard.CME if isinstance(error, CommandError) else Standard.EXE)

    def fail(self) -> None:
        """Set the bit of a failure inside the meter."""
        self.registers.note(Standard.DDE)

    def answer_text(self, command: MeterCommand, said: str) -> str:
        """Answer after its header, if headers are on and the command has one."""
        named = self.settings.header and command.has_header
        return f"{command.header.upper()} {said}" if named else said

    async def trigger(self) -> None:
        """`*TRG`: start a measurement. Raises ExecutionError with internal trigger."""
        if self.settings.trigger != "EXTERNAL":
            raise ExecutionError("*TRG")
        self.begin(self.now + self.pace * self.seconds)

    async def measure(self) -> str:
        """`:MEASure?`: the latest measurement, which may be stale with internal trigger."""
        if self.settings.trigger == "INTERNAL" and self.now >= self.fresh_from:
            self.begin(self.now)
        await self.settle()
        return measurement_text(self.latest, self.settings)

    async def wait(self) -> None:
        """`*WAI`: wait for running actions; with internal trigger, for a new reading."""
        if self.settings.trigger == "INTERNAL":
            await asyncio.sleep(max(0.0, self.fresh_from - self.now))
        await self.settle()
        await self.corrections.finished()

    def keep(self, results: Sequence[MeasurementResult]) -> None:
        """Keep the result, and set the bits of its events."""
        self.latest = result = results[-1]
        if self.settings.auto_range:
            self.settings.range = result.conditions.range
        for event in (Measuring.IDX, Measuring.EOM, STATUS_EVENTS.get(result.status)):
            if event:
                self.registers.note(event)

    def reset(self) -> None:
        """`*RST`: factory settings, without corrections and readings."""
        self.corrections.stop()
        self.settings, self.corrections = Settings(), CorrectionRuns()
        self.latest, self.pending = NO_RESULT, None
        self.changed()

    def restart(self) -> None:
        """Simulate a power cut: a reset, and a power-on event."""
        self.reset()
        self.registers = Registers()


@cache
def vocabulary() -> Vocabulary:
    """All commands of Hioki's meters."""

    return Vocabulary((*COMMON_COMMANDS, *SETTING_COMMANDS, *MEASURING_COMMANDS))
