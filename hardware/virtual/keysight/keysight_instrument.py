"""Common part of Keysight's instruments: identity, errors, registers and the trigger system.

The trigger system is idle, waits for a trigger, or measures: E4980A user's guide, page 249.
"""

from __future__ import annotations

import asyncio
from abc import abstractmethod
from collections.abc import Sequence
from copy import deepcopy
from dataclasses import dataclass, field
from typing import ClassVar

from ..instrument import EventRegisters, Instrument, Standard
from ..language import TRIGGER_IGNORED, ExecutionError, LanguageError, MeterCommand, Vocabulary
from ..measurement import NO_RESULT, MeasurementResult, MeterSettings
from .error_queue import (
    DEVICE_ERROR,
    INIT_IGNORED,
    LENGTH,
    SETTINGS_CONFLICT,
    ErrorQueue,
    register_bit,
)

MEASURING, SWEEPING, CORRECTING = 16, 8, 1
"""Bits of the operation status register: E4980A user's guide, chapter 8."""
ACQUISITION = 20.0
"""Time to acquire a correction, s. Chosen here."""


@dataclass
class KeysightInstrument(Instrument):
    """An instrument of Keysight. initiated: False if the trigger system is idle.

    maker, firmware: in the answer to `*IDN?`. operation: event register of actions, whose bits are
    set when a condition begins (rising) or ends (falling). queue_length: of errors.
    acquiring: correction that is being acquired until the time acquired_at, s.
    """

    maker: ClassVar[str] = "Keysight Technologies"
    firmware: ClassVar[str]
    queue_length: ClassVar[int] = LENGTH
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

    @classmethod
    @abstractmethod
    def vocabulary(cls) -> Vocabulary:
        """All commands of the model."""

    @abstractmethod
    def points(self) -> Sequence[MeterSettings]:
        """Settings of each reading that a trigger starts."""

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
        return self.initiated and self.settings.trigger == "INT" and self.settings.continuous

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
        self.registers.note(Standard.DDE)
        self.errors.add(DEVICE_ERROR)

    def initiate(self) -> None:
        """`:INITiate`: from idle to waiting for a trigger. Raises ExecutionError if not idle."""
        if self.initiated:
            raise ExecutionError("INIT", INIT_IGNORED)
        self.initiated = True
        if self.settings.trigger == "INT":
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
        points = [deepcopy(each) for each in self.points()]
        self.operation |= self.rising & MEASURING
        self.begin(self.now + self.pace * self.seconds if done is None else done, points)
