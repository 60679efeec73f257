"""Virtual LCR meter of Hioki: the IM3523 and, without further ranges, its siblings.

Source: Hioki's communication commands of the IM3523.
"""

from __future__ import annotations

import asyncio
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from enum import IntFlag
from typing import Any

from ...simulator.meters.accuracy_table import (
    METER_BANDS,
    RANGES,
    VIRTUAL_MODEL,
    AccuracyTable,
    GeneratorLevel,
    ReadingConditions,
    full_scale,
)
from ..meter.conversation import Event
from ..meter.hioki_dialect import CORRECTIONS, ITEMS, HiokiDialect, HiokiSiblingDialect
from ..meter.meter_reading import ReadingStatus
from ..meter.setting import MeterProperty, Setting, rows
from .instrument import EventRegisters, Instrument
from .language import (
    DATA_OUT_OF_RANGE,
    NUMERIC_DATA_ERROR,
    CommandError,
    ExecutionError,
    Language,
    LanguageError,
    MeterCommand,
    Vocabulary,
    engineering,
    setting_command,
    setting_commands,
)
from .measurement import NO_RESULT, MeasurementResult, Settings, quantity

NUMBER = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d{1,3})?", re.ASCII)
OVER, UNDER = " 999999E+28", "-999999E+28"
DECIMALS = {"PHASE": 3, "Q": 3, "D": 6}
CORRECTION_SECONDS = {"ALL": 4.0, "SPOT": 1.0}


class HiokiLanguage(Language):
    """Numbers without units; a word that is none is a command error; answers in long form."""

    def number(self, text: str, low: float, high: float, unit: str = "") -> float:
        """Number in an argument, without a unit."""
        if NUMBER.fullmatch(text) is None:
            raise CommandError(text, NUMERIC_DATA_ERROR)
        if not low <= float(text) <= high:
            raise ExecutionError(text, DATA_OUT_OF_RANGE)
        return float(text)

    def integer(self, text: str, low: int, high: int) -> int:
        """Number in an argument, rounded before it is compared with the limits."""
        value = self.number(text, -math.inf, math.inf)
        if not low - 0.5 <= value < high + 0.5:
            raise ExecutionError(text, DATA_OUT_OF_RANGE)
        return math.floor(value + 0.5)

    def unknown_word(self, text: str) -> LanguageError:
        """A command error."""
        return CommandError(text)

    def word_text(self, word: str) -> str:
        """The long form."""
        return word.upper()

    def switch_text(self, on: bool) -> str:
        """ON or OFF."""
        return "ON" if on else "OFF"


LANGUAGE = HiokiLanguage()


class Measuring(IntFlag):
    """Bits of `:ESR0?`."""

    REF = 128
    COF = 64
    LOF = 32
    MOF = 16
    MUF = 8
    IDX = 4
    EOM = 2
    CEM = 1


@dataclass
class Registers(EventRegisters):
    """Both event registers with their masks, and the mask of the status byte."""

    measuring: int = 0
    measuring_mask: int = 0

    def note(self, event: Event | Measuring) -> None:
        """Set the bit of an event."""
        if isinstance(event, Event):
            super().note(event)
        else:
            self.measuring |= event

    def take_measuring(self) -> int:
        """Read and clear the measuring register."""
        taken, self.measuring = int(self.measuring), 0
        return taken

    def clear(self) -> None:
        """`*CLS`: clear the events, keep the masks."""
        super().clear()
        self.measuring = 0

    def status_byte(self, waiting: bool, further: int = 0) -> int:
        """Status byte with ESB0 1 of the measuring register."""
        return super().status_byte(waiting, further | bool(self.measuring & self.measuring_mask))


class HiokiSettings(Settings):
    """Settings of a virtual IM3523. The range is the last one set or chosen."""

    dialect = HiokiDialect

    def conditions(self, Z: complex, accuracy: AccuracyTable) -> ReadingConditions:
        """Conditions of a measurement of Z in ohm, with the range that the meter uses."""
        return self.in_range(accuracy.fitting_range(Z) if self.auto_range else self.range, Z)

    def in_range(self, number: int, Z: complex) -> ReadingConditions:
        """Conditions of a measurement of Z in ohm in a range."""
        return ReadingConditions(
            self.frequency,
            number,
            self.speed[number - 1],
            self.averaging[number - 1],
            GeneratorLevel.of(vars(self)).open_voltage(Z),
            self.cable,
        )

    def status(self, Z: complex, used: ReadingConditions, accuracy: AccuracyTable) -> ReadingStatus:
        """Status of a reading that shows Z in ohm under these conditions."""
        low, high = accuracy.span.displayed
        size = abs(Z) / full_scale(used.range)
        if size > high:
            return ReadingStatus.OVERFLOW
        if size < low:
            return ReadingStatus.UNDERFLOW
        outside = accuracy.is_outside_guarantee(Z, used)
        return ReadingStatus.OUTSIDE_GUARANTEE if outside else ReadingStatus.NORMAL


@dataclass
class CorrectionRuns:
    """Running acquisitions, and the error code of the last one of each kind (0: success)."""

    under_way: dict[str, asyncio.Task] = field(default_factory=dict)
    errors: dict[str, int] = field(default_factory=lambda: {"open": 0, "short": 0})

    def start(self, meter: VirtualHioki, kind: str, extent: str) -> None:
        """Acquire a correction. Raises ExecutionError with internal trigger, or if one runs."""
        if meter.settings.trigger != "EXTERNAL" or self.busy:
            raise ExecutionError(kind)
        self.under_way[kind] = asyncio.get_running_loop().create_task(
            self._acquire(meter, kind, extent)
        )

    def cancel(self, kind: str) -> None:
        """Stop acquiring; the correction before stays in use."""
        task = self.under_way.pop(kind, None)
        if task:
            task.cancel()

    def stop(self) -> None:
        """Stop all acquisitions."""
        for kind in tuple(self.under_way):
            self.cancel(kind)

    @property
    def busy(self) -> bool:
        """True while an acquisition runs."""
        return bool(self.under_way)

    async def finished(self) -> None:
        """Wait until no acquisition runs."""
        while self.busy:
            await asyncio.wait(self.under_way.values())

    async def _acquire(self, meter: VirtualHioki, kind: str, extent: str) -> None:
        await asyncio.sleep(meter.pace * CORRECTION_SECONDS[extent])
        failed = meter.faults.take("correction") is not None
        self.errors[kind] = int(failed)
        if not failed:
            setattr(meter.settings, f"{kind}_correction", extent)
        meter.registers.note(Measuring.CEM)
        self.under_way.pop(kind, None)


def measurement_text(result: MeasurementResult, settings: HiokiSettings) -> str:
    """Answer to `:MEASure?` in the form that `:MEASure:VALid` and `:MEASure:ITEM` set."""
    parts = [str(result.status.code)] if settings.valid & 16 else []
    if settings.valid & 2:
        parts += [_value(result, name) for name in requested_quantities(settings)]
    if settings.valid & 1:
        parts.append("0")
    return ",".join(parts)


def requested_quantities(settings: HiokiSettings) -> list[str]:
    """Names in the order of the registers; the displayed pair if both registers are 0."""
    if settings.items == (0, 0):
        pair = settings.parameter_1, settings.parameter_2
        return [name for name in pair if name != "OFF"]
    return [
        name
        for register, names in zip(settings.items, ITEMS, strict=True)
        for bit, name in enumerate(names)
        if register >> bit & 1
    ]


def _value(result: MeasurementResult, name: str) -> str:
    if result.status is ReadingStatus.UNDERFLOW:
        return UNDER
    if not result.status.has_values:
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
    setattr(meter.registers, name, LANGUAGE.integer(text, 0, 255))


async def _complete(meter: VirtualHioki) -> int:
    await meter.wait()
    return 1


async def _note_completion(meter: VirtualHioki) -> None:
    await meter.wait()
    meter.registers.note(Event.COMPLETE)


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


def _correct(meter: VirtualHioki, kind: str, text: str) -> None:
    requested = LANGUAGE.word(text, (*CORRECTIONS, "CANCel")).upper()
    if requested == "CANCEL":
        meter.corrections.cancel(kind)
    elif requested == "OFF":
        setattr(meter.settings, f"{kind}_correction", "OFF")
    else:
        meter.corrections.start(meter, kind, requested)


def _correction(row: MeterProperty[Any], kind: str) -> MeterCommand:
    return MeterCommand(
        row.header,
        lambda meter, text: _correct(meter, kind, text),
        lambda meter: getattr(meter.settings, f"{kind}_correction"),
    )


def _error(row: MeterProperty[Any], kind: str) -> MeterCommand:
    return MeterCommand(
        f"{row.header}:ERRor", on_query=lambda meter: meter.corrections.errors[kind]
    )


def _set_range(meter: VirtualHioki, text: str) -> None:
    meter.settings.range, meter.settings.auto_range = LANGUAGE.integer(text, 1, 10), False
    meter.changed()


def _set_each(meter: VirtualHioki, which: str, name: str, row: Setting[Any], text: str) -> None:
    value = LANGUAGE.parse(row.allowed, [text])
    chosen = RANGES if which.upper() == "ALL" else [LANGUAGE.integer(which, 1, 10)]
    values = getattr(meter.settings, name)
    now = tuple(value if n in chosen else values[n - 1] for n in RANGES)
    setattr(meter.settings, name, now)
    meter.changed()


def _each_range(name: str) -> tuple[MeterCommand, MeterCommand]:
    """The IM3523's command with a range, and its siblings' command without."""
    row, sibling = (getattr(each, name) for each in (HiokiDialect, HiokiSiblingDialect))

    def kept(meter: VirtualHioki, n: int) -> str:
        return LANGUAGE.show(row.allowed, getattr(meter.settings, name)[n - 1])

    return (
        MeterCommand(
            row.header,
            lambda meter, which, text: _set_each(meter, which, name, row, text),
            lambda meter, which: kept(meter, LANGUAGE.integer(which, 1, 10)),
            set_arguments=2,
            query_arguments=1,
        ),
        MeterCommand(
            sibling.header,
            lambda meter, text: _set_each(meter, "ALL", name, row, text),
            lambda meter: kept(meter, meter.settings.range),
            siblings_only=True,
        ),
    )


def _older_parameter(header: str) -> MeterCommand:
    """Command of the 3522-50 for the second quantity."""
    as_second = setting_command(LANGUAGE, "parameter_2", HiokiDialect.parameter_2, False)
    return replace(as_second, header=header, siblings_only=True)


PER_RANGE = {name: _each_range(name) for name in ("speed", "averaging", "trigger_delay")}
OPEN, SHORT = HiokiDialect.open_correction, HiokiDialect.short_correction
SETTING_COMMANDS = (
    *setting_commands(
        LANGUAGE,
        rows(HiokiDialect),
        {
            "range": MeterCommand(
                HiokiDialect.range.header, _set_range, lambda meter: meter.settings.range
            ),
            "open_correction": _correction(OPEN, "open"),
            "short_correction": _correction(SHORT, "short"),
            **{name: own for name, (own, _) in PER_RANGE.items()},
        },
        shown_only=("items", "valid", "parameter_1", "parameter_2"),
    ),
    *(sibling for _, sibling in PER_RANGE.values()),
    *map(_older_parameter, (":PARameter3", ":PARameter4")),
    _error(OPEN, "open"),
    _error(SHORT, "short"),
    MeterCommand(":MEASure", on_query=lambda meter: meter.measure(), has_header=False),
)

VOCABULARY = Vocabulary((*COMMON_COMMANDS, *SETTING_COMMANDS))
STATUS_EVENTS = {
    ReadingStatus.OVERFLOW: Measuring.MOF,
    ReadingStatus.UNDERFLOW: Measuring.MUF,
    ReadingStatus.OUTSIDE_GUARANTEE: Measuring.REF,
}


@dataclass
class VirtualHioki(Instrument):
    """Virtual meter that speaks Hioki's language."""

    model: str = VIRTUAL_MODEL
    settings: HiokiSettings = field(default_factory=HiokiSettings)
    registers: Registers = field(default_factory=Registers)
    corrections: CorrectionRuns = field(default_factory=CorrectionRuns)

    @classmethod
    def vocabulary(cls) -> Vocabulary:
        """All commands of Hioki's meters."""
        return VOCABULARY

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
        return "\r" if self.settings.terminator else "\r\n"

    @property
    def seconds(self) -> float:
        """Time of a measurement with the present settings at pace 1, s."""
        settings = self.settings
        delay = settings.trigger_delay[settings.range - 1]
        return delay + settings.in_range(settings.range, 0j).seconds

    def command(self, words: tuple[str, ...]) -> tuple[MeterCommand, tuple[int, ...]] | None:
        """Command of these words; None if unknown to the model."""
        found = VOCABULARY.find(words)
        compatible = self.model != VIRTUAL_MODEL or self.settings.compatible
        return None if found and found[0].siblings_only and not compatible else found

    def refuse(self, error: LanguageError) -> None:
        """Set the bit of the error; nothing is answered."""
        self.registers.note(Event.COMMAND if isinstance(error, CommandError) else Event.EXECUTION)

    def fail(self) -> None:
        """Set the bit of a failure inside the meter."""
        self.registers.note(Event.DEVICE)

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
        self.settings, self.corrections = HiokiSettings(), CorrectionRuns()
        self.latest, self.pending = NO_RESULT, None
        self.changed()

    def restart(self) -> None:
        """Simulate a power cut: a reset, and a power-on event."""
        self.reset()
        self.registers = Registers()
