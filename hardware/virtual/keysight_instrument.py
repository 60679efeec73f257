"""Common part of Keysight's virtual instruments: SCPI, errors, registers and the trigger system.

The trigger system is idle, waits for a trigger, or measures: E4980A user's guide, page 249.
"""

from __future__ import annotations

import asyncio
import math
import re
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Any, ClassVar

from ...simulator.meters.accuracy_table import METER_BANDS
from ..meter.conversation import Event
from ..meter.keysight_dialects import CORRECTING, MEASURING, SWEEPING
from ..meter.setting import NO_NUMBER, rows
from .instrument import EventRegisters, Instrument
from .language import (
    DATA_OUT_OF_RANGE,
    TRIGGER_IGNORED,
    CommandError,
    ExecutionError,
    Language,
    LanguageError,
    MeterCommand,
    Vocabulary,
    check_suffixes,
    manual_form,
    matched_word,
    setting_commands,
    short_form,
)
from .measurement import NO_RESULT, MeasurementResult, Settings, quantity

NUMBER = re.compile(r"([+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:E[+-]?\d{1,3})?)\s*([A-Z]*)", re.ASCII)
MULTIPLIERS = {"T": 1e12, "G": 1e9, "MA": 1e6, "K": 1e3, "": 1.0, "M": 1e-3, "U": 1e-6, "N": 1e-9}
"""Multipliers of units; source: SCPI 1999, volume 1, section 7.3."""
MEGA_UNITS = ("HZ", "OHM")
"""Units before which M means mega."""
TEXTS = {
    0: "No error",
    -100: "Command error",
    -102: "Syntax error",
    -104: "Data type error",
    -108: "Parameter not allowed",
    -109: "Missing parameter",
    -113: "Undefined header",
    -114: "Header suffix out of range",
    -120: "Numeric data error",
    -131: "Invalid suffix",
    -200: "Execution error",
    -211: "Trigger ignored",
    -213: "Init ignored",
    -221: "Settings conflict",
    -222: "Data out of range",
    -223: "Too much data",
    -224: "Illegal parameter value",
    -230: "Data corrupt or stale",
    -300: "Device-specific error",
    -350: "Queue overflow",
}
"""Numbers and texts of errors; source: SCPI 1999, volume 2, chapter 21.8."""
DATA_TYPE, INVALID_SUFFIX, INIT_IGNORED, SETTINGS_CONFLICT = -104, -131, -213, -221
TOO_MUCH_DATA, ILLEGAL_VALUE, STALE_DATA, DEVICE_ERROR, OVERFLOW = -223, -224, -230, -300, -350
QUEUE_LENGTH = 20
"""Errors that the queue of an LCR meter holds. Chosen here: it is in no manual that was at hand."""


@dataclass
class ErrorQueue:
    """Errors, the oldest first. The last one of a full queue is -350."""

    length: int = QUEUE_LENGTH
    codes: deque[int] = field(default_factory=deque)

    def add(self, code: int) -> None:
        """Add an error."""
        if len(self.codes) < self.length:
            self.codes.append(code)
        else:
            self.codes[-1] = OVERFLOW

    def take(self) -> str:
        """Read and remove the oldest error, such as `-113,"Undefined header"`."""
        code = self.codes.popleft() if self.codes else 0
        return f'{code:+d},"{TEXTS[code]}"'

    def clear(self) -> None:
        """Remove all errors."""
        self.codes.clear()


def nr3(value: float, decimals: int = 5) -> str:
    """Number such as `+1.00000E+03`; what is not finite is 9.9E37."""
    return f"{value if math.isfinite(value) else NO_NUMBER:+.{decimals}E}"


class ScpiLanguage(Language):
    """Numbers with units, MIN and MAX; words in short form; switches as 1 or 0.

    clip: True to replace a number out of range by the nearest one.
    """

    def __init__(self, clip: bool = False) -> None:
        self.clip = clip

    def number(self, text: str, low: float, high: float, unit: str = "") -> float:
        """Number in an argument, with or without its unit, or MIN or MAX."""
        word = matched_word(text, ("MINimum", "MAXimum"))
        if word:
            return low if word == "MINIMUM" else high
        match = NUMBER.fullmatch(text.upper())
        if match is None:
            raise CommandError(text, DATA_TYPE)
        value = float(match[1]) * _multiplier(match[2], unit)
        if not low <= value <= high:
            if not self.clip:
                raise ExecutionError(text, DATA_OUT_OF_RANGE)
            return low if value < low else high
        return value

    def unknown_word(self, text: str) -> LanguageError:
        """An illegal parameter value."""
        return ExecutionError(text, ILLEGAL_VALUE)

    def word_text(self, word: str) -> str:
        """The short form."""
        return short_form(word)

    def switch_text(self, on: bool) -> str:
        """1 or 0."""
        return str(int(on))


SCPI, CLIPPING = ScpiLanguage(), ScpiLanguage(clip=True)


def _multiplier(suffix: str, unit: str) -> float:
    prefix = suffix.removesuffix(unit) if unit else suffix
    if prefix == "M" and unit in MEGA_UNITS:
        return 1e6
    if (suffix and not suffix.endswith(unit or " ")) or prefix not in MULTIPLIERS:
        raise CommandError(suffix, INVALID_SUFFIX)
    return MULTIPLIERS[prefix]


def register_bit(code: int) -> Event:
    """Bit of the standard event register for an error: E4980A user's guide, page 272."""
    if code <= -400:
        return Event.QUERY
    if code <= -300 or code > 0:
        return Event.DEVICE
    return Event.EXECUTION if code <= -200 else Event.COMMAND


ACQUISITION = 20.0
"""Time to acquire a correction, s. Chosen here."""


@dataclass
class KeysightInstrument(Instrument):
    """An instrument of Keysight. initiated: False if the trigger system is idle.

    maker, firmware: in the answer to `*IDN?`. settings_type: its settings. operation: event
    register of actions, whose bits are set when a condition begins (rising) or ends (falling).
    queue_length: of errors.
    acquiring: correction that is being acquired until the time acquired_at, s.
    """

    maker: ClassVar[str] = "Keysight Technologies"
    firmware: ClassVar[str]
    settings_type: ClassVar[type[Settings]]
    queue_length: ClassVar[int] = QUEUE_LENGTH
    registers: EventRegisters = field(default_factory=EventRegisters)
    errors: ErrorQueue = field(init=False)
    results: list[MeasurementResult] = field(default_factory=list)
    initiated: bool = True
    operation: int = 0
    operation_mask: int = 0
    rising: int = 0
    falling: int = 0xFFFF
    acquiring: tuple[tuple[int, ...], str] | None = None
    acquired_at: float = 0.0
    beeper: bool = True

    def __post_init__(self) -> None:
        self.errors = ErrorQueue(self.queue_length)
        self.settings = self.settings or self.settings_type()

    @classmethod
    def vocabulary(cls) -> Vocabulary:
        """All commands of the model: of SCPI, of its dialect, of the trigger, of corrections."""
        return _vocabulary(cls.settings_type.dialect)

    @property
    def band(self) -> tuple[float, float]:
        """Lowest and highest frequency, Hz."""
        return METER_BANDS[self.model]

    def points(self) -> Sequence[Any]:
        """Settings of each reading that a trigger starts."""
        return [self.settings]

    def reading_text(self, result: MeasurementResult) -> str:
        """A reading in an answer: R, X and a status, by default."""
        R, X = (result.Z.real, result.Z.imag) if result.status.has_values else (NO_NUMBER,) * 2
        return f"{nr3(R)},{nr3(X)},{1 - result.status.has_values:+d}"

    async def fetch(self) -> str:
        """`:FETCh?`: the latest readings, which are old if nothing triggered new ones.

        Raises ExecutionError if there are none.
        """
        await self.newest()
        if not self.results:
            raise ExecutionError("FETCh", STALE_DATA)
        return ",".join(map(self.reading_text, self.results))

    async def trigger_and_fetch(self) -> str:
        """`*TRG`: `:TRIGger;:FETCh?` in one; user's guide, pages 250 to 252."""
        await self.bus_trigger()
        return await self.fetch()

    @property
    def identity(self) -> str:
        """Answer to `*IDN?`."""
        return f"{self.maker},{self.model},{self.serial},{self.firmware}"

    @property
    def line_end(self) -> str:
        """LF."""
        return "\n"

    @property
    def runs_freely(self) -> bool:
        """True if the instrument triggers itself again and again."""
        return self.initiated and self.settings.trigger == "INTERNAL" and self.settings.continuous

    def command(self, words: tuple[str, ...]) -> tuple[MeterCommand, tuple[int, ...]] | None:
        """Command of these words with the numbers of its suffixes; None if unknown."""
        self._end_acquisition()
        return self.vocabulary().find(words)

    def refuse(self, error: LanguageError) -> None:
        """Set the bit of the error and add it to the queue; nothing is answered."""
        self.registers.note(register_bit(error.code))
        self.errors.add(error.code)

    def fail(self) -> None:
        """Note a failure inside the instrument."""
        self.registers.note(Event.DEVICE)
        self.errors.add(DEVICE_ERROR)

    def initiate(self) -> None:
        """`:INITiate`: from idle to waiting for a trigger. Raises ExecutionError if not idle."""
        if self.initiated:
            raise ExecutionError("INIT", INIT_IGNORED)
        self.initiated = True
        if self.settings.trigger == "INTERNAL":
            self._measure_points()

    def set_continuous(self, on: bool) -> None:
        """`:INITiate:CONTinuous`: waits for triggers again and again, or becomes idle."""
        self.settings.continuous = on
        self.initiated = on or self.pending is not None
        self.changed()

    def abort(self) -> None:
        """`:ABORt`: end a measurement or an acquisition, then wait if continuous, else be idle."""
        self.pending, self.acquiring = None, None
        self.initiated = self.settings.continuous
        self.changed()

    async def trigger(self) -> None:
        """Start a measurement. Raises ExecutionError unless the instrument waits for a trigger."""
        await self.settle_if_done()
        busy = self.pending is not None or self.runs_freely or self.acquiring is not None
        if busy or not self.initiated:
            raise ExecutionError("trigger", TRIGGER_IGNORED)
        self._measure_points()

    async def bus_trigger(self) -> None:
        """`*TRG`: as `trigger`, for the source BUS only."""
        if self.settings.trigger != "BUS":
            raise ExecutionError("*TRG", TRIGGER_IGNORED)
        await self.trigger()

    async def settle_if_done(self) -> None:
        """Finish a measurement whose time is over."""
        if self.pending is not None and self.pending.done <= self.now:
            await self.settle()

    async def newest(self) -> None:
        """Wait for a running measurement; if the instrument runs freely, take what it has."""
        if self.runs_freely and self.now >= self.fresh_from:
            self._measure_points(self.now)
        await self.settle()

    async def finished(self) -> None:
        """Wait for all running actions."""
        await self.settle()
        if self.acquiring is not None:
            await asyncio.sleep(max(0.0, self.acquired_at - self.now))
            self._end_acquisition()

    def acquire(self, suffixes: tuple[int, ...], header: str) -> None:
        """Begin to acquire a correction. Raises ExecutionError while another one is acquired."""
        if self.acquiring is not None:
            raise ExecutionError(header, SETTINGS_CONFLICT)
        self.acquiring = suffixes, header
        self.acquired_at = self.now + self.pace * ACQUISITION

    def keep(self, results: Sequence[MeasurementResult]) -> None:
        """Keep the results, and leave the measuring state."""
        self.results, self.latest = list(results), results[-1]
        self.operation |= self.falling & (MEASURING | (SWEEPING if len(results) > 1 else 0))
        self.initiated = self.settings.continuous

    def reset(self) -> None:
        """`*RST`: factory settings, idle, without readings."""
        self.settings = type(self.settings)()
        self.results, self.latest, self.pending, self.acquiring = [], NO_RESULT, None, None
        self.initiated = self.settings.continuous = False
        self.changed()

    def preset(self) -> None:
        """`:SYSTem:PRESet`: as `*RST`, but it runs freely."""
        self.reset()
        self.initiated = self.settings.continuous = True

    def restart(self) -> None:
        """Simulate a power cut: it runs freely, and the power-on event is set."""
        self.preset()
        self.registers, self.operation = EventRegisters(), 0
        self.errors.clear()

    @property
    def status_byte(self) -> int:
        """Answer to `*STB?`; 128: an event of the operation register that its mask lets pass."""
        further = 128 * bool(self.operation & self.operation_mask)
        return self.registers.status_byte(self.waiting, further)

    def take_operation(self) -> int:
        """Read and clear the operation event register."""
        taken, self.operation = self.operation, 0
        return taken

    def _end_acquisition(self) -> None:
        if self.acquiring is not None and self.now >= self.acquired_at:
            self.acquiring = None
            self.operation |= self.falling & CORRECTING
            if self.faults.take("correction"):
                self.fail()

    def _measure_points(self, done: float | None = None) -> None:
        points = [each.replaced() for each in self.points()]
        self.operation |= self.rising & MEASURING
        self.begin(self.now + self.pace * self.seconds if done is None else done, points)


def acquisition(header: str) -> MeterCommand:
    """Command that acquires a correction. It does not switch its use on or off."""
    return MeterCommand(
        manual_form(header),
        lambda meter, *suffixes: meter.acquire(suffixes, header),
        set_arguments=0,
    )


async def _complete(meter: KeysightInstrument) -> int:
    await meter.finished()
    return 1


async def _note_completion(meter: KeysightInstrument) -> None:
    await meter.finished()
    meter.registers.note(Event.COMPLETE)


def _clear(meter: KeysightInstrument) -> None:
    meter.registers.clear()
    meter.errors.clear()
    meter.operation = 0


async def _operation(meter: KeysightInstrument) -> int:
    await meter.settle_if_done()
    return meter.take_operation()


async def _operation_condition(meter: KeysightInstrument) -> int:
    await meter.settle_if_done()
    measuring = meter.pending is not None or meter.runs_freely
    return MEASURING * measuring | CORRECTING * (meter.acquiring is not None)


def _set_beeper(meter: KeysightInstrument, text: str) -> None:
    meter.beeper = SCPI.switch(text)


def _mask(header: str, name: str) -> MeterCommand:
    def set_mask(meter: KeysightInstrument, text: str) -> None:
        setattr(meter.registers, name, SCPI.integer(text, 0, 255))

    return MeterCommand(header, set_mask, lambda meter: getattr(meter.registers, name))


def operation_register(word: str, name: str) -> MeterCommand:
    """Command of a mask of the operation register."""

    def set_register(meter: KeysightInstrument, text: str) -> None:
        setattr(meter, name, SCPI.integer(text, 0, 0xFFFF))

    return MeterCommand(
        f":STATus:OPERation:{word}", set_register, lambda meter: getattr(meter, name)
    )


COMMON_COMMANDS = (
    MeterCommand("*IDN", on_query=lambda meter: meter.identity),
    MeterCommand("*RST", lambda meter: meter.reset(), set_arguments=0),
    MeterCommand("*CLS", _clear, set_arguments=0),
    MeterCommand("*OPC", _note_completion, _complete, set_arguments=0),
    MeterCommand("*WAI", lambda meter: meter.finished(), set_arguments=0),
    MeterCommand("*TST", on_query=lambda meter: 0),
    MeterCommand("*OPT", on_query=lambda meter: 0),
    MeterCommand("*ESR", on_query=lambda meter: meter.registers.take_standard()),
    MeterCommand("*STB", on_query=lambda meter: meter.status_byte),
    _mask("*ESE", "standard_mask"),
    _mask("*SRE", "request_mask"),
    MeterCommand(":ABORt", lambda meter: meter.abort(), set_arguments=0),
    MeterCommand(":SYSTem:ERRor[:NEXT]", on_query=lambda meter: meter.errors.take()),
    MeterCommand(":SYSTem:BEEPer[:IMMediate]", lambda meter: None, set_arguments=0),
    MeterCommand(":SYSTem:BEEPer:COMPlete:IMMediate", lambda meter: None, set_arguments=0),
    MeterCommand(":SYSTem:BEEPer:STATe", _set_beeper, lambda meter: SCPI.switch_text(meter.beeper)),
    MeterCommand(":SYSTem:PRESet", lambda meter: meter.preset(), set_arguments=0),
    MeterCommand(":STATus:OPERation[:EVENt]", on_query=_operation),
    MeterCommand(":STATus:OPERation:CONDition", on_query=_operation_condition),
    operation_register("ENABle", "operation_mask"),
)


def continuous_command(header: str) -> MeterCommand:
    """Command that lets the instrument wait for triggers again and again."""

    def set_continuous(meter: KeysightInstrument, *given: Any) -> None:
        check_suffixes(given[:-1])
        meter.set_continuous(SCPI.switch(given[-1]))

    def query(meter: KeysightInstrument, *given: int) -> str:
        check_suffixes(given)
        return SCPI.switch_text(meter.settings.continuous)

    return MeterCommand(header, set_continuous, query)


TRIGGER_AND_FETCH = MeterCommand("*TRG", lambda meter: meter.trigger_and_fetch(), set_arguments=0)


@cache
def _vocabulary(dialect: Any) -> Vocabulary:
    special = {"continuous": continuous_command(dialect.continuous.header)}
    settings = setting_commands(SCPI, rows(dialect), special)
    acquisitions = map(acquisition, dialect.acquire.values())
    return Vocabulary((*COMMON_COMMANDS, *settings, TRIGGER_AND_FETCH, *acquisitions))


def shown_quantity(name: str, Z: complex, frequency: float) -> float:
    """Quantity by name from Z in ohm. D and Q of a capacitor are positive, angles in degrees."""
    if name in ("VDC", "IDC"):
        return 0.0
    if name in ("DC", "QC"):
        return -quantity(name[0], Z, frequency)
    if name.endswith("RADIANS"):
        name, factor = name.replace("RADIANS", "PHASE"), math.pi / 180
        return factor * shown_quantity(name, Z, frequency)
    return -quantity("PHASE", Z, frequency) if name == "YPHASE" else quantity(name, Z, frequency)
