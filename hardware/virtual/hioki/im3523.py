"""Virtual LCR meter of Hioki: the IM3523 and, without further ranges, its siblings.

Source: Hioki's communication commands of the IM3523.
"""

from __future__ import annotations

import asyncio
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache

from ....simulator.meters.accuracy_table import METER_BANDS, VIRTUAL_MODEL
from ..event_registers import Standard
from ..instrument import Instrument
from ..language import CommandError, ExecutionError, LanguageError, MeterCommand, Vocabulary
from ..measurement import NO_RESULT, OVERFLOW, UNDERFLOW, MeasurementResult
from .meter_state import Measuring, Registers, Settings, conditions
from .reading_text import measurement_text
from .virtual_corrections import CorrectionRuns

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
    from .common_commands import COMMON_COMMANDS
    from .measuring_commands import MEASURING_COMMANDS
    from .setting_commands import SETTING_COMMANDS

    return Vocabulary((*COMMON_COMMANDS, *SETTING_COMMANDS, *MEASURING_COMMANDS))
