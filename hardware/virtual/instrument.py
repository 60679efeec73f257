"""The virtual meter: settings, registers, trigger and readings."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from ...simulator.sweeps import UNPRESSED
from ...simulator.sweeps.meter_bands import VIRTUAL_MODEL
from ..event_counter import Report
from ..meter.meter_identity import VIRTUAL_SERIAL
from .faults import Faults
from .language.parser import ExecutionError
from .measurement import (
    NO_RESULT,
    OVERFLOW,
    UNDERFLOW,
    MeasurementResult,
    MeasurementSetup,
    conditions,
    measurement_text,
)
from .meter_state import Measuring, Registers, Settings, Standard
from .virtual_corrections import CorrectionRuns
from .worker import Worker

if TYPE_CHECKING:
    from .measurement import Skin

STATUS_EVENTS = {OVERFLOW: Measuring.MOF, UNDERFLOW: Measuring.MUF, 2: Measuring.REF}


@dataclass
class PendingMeasurement:
    """A running measurement. done: time of its end, s of the loop's clock.

    press: of the skin in the middle of the measurement.
    """

    press: Any
    settings: Settings
    done: float
    setup: MeasurementSetup


@dataclass
class Instrument:
    """One meter, shared by clients. pace: factor on all times; 1: as a real meter, 0: none.

    skins: by interface, for a switch; interface: the connected one. report_failure: reports why the
    skin has no reading, which a client sees as a failure inside the meter. report: takes faults of
    clients.
    """

    bench: MeasurementSetup
    model: str = VIRTUAL_MODEL
    serial: str = VIRTUAL_SERIAL
    pace: float = 1.0
    press: str = UNPRESSED
    settings: Settings = field(default_factory=Settings)
    registers: Registers = field(default_factory=Registers)
    faults: Faults = field(default_factory=Faults)
    corrections: CorrectionRuns = field(default_factory=CorrectionRuns)
    latest: MeasurementResult = NO_RESULT
    pending: PendingMeasurement | None = None
    fresh_from: float = 0.0
    waiting: bool = False
    worker: Worker = field(default_factory=Worker)
    skins: Mapping[str, Skin] = field(default_factory=dict)
    interface: str = ""
    report_failure: Callable[[str], None] = lambda text: None
    report: Report = lambda kind, text: None

    @property
    def identity(self) -> str:
        """Answer to `*IDN?`."""
        return f"HIOKI,{self.model},{self.serial},V1.00"

    async def trigger(self) -> None:
        """`*TRG`: start a measurement. Raises ExecutionError with internal trigger."""
        if self.settings.trigger != "EXTERNAL":
            raise ExecutionError("*TRG")
        self.pending = self._begun(self.now + self._seconds())

    async def measure(self) -> str:
        """`:MEASure?`: the latest measurement, which may be stale with internal trigger."""
        if self.settings.trigger == "INTERNAL" and self.now >= self.fresh_from:
            self.pending = self._begun(self.now)
        await self.settle()
        return measurement_text(self.latest, self.settings)

    async def wait(self) -> None:
        """`*WAI`: wait for running actions; with internal trigger, for a new reading."""
        if self.settings.trigger == "INTERNAL":
            await asyncio.sleep(max(0.0, self.fresh_from - self.now))
        await self.settle()
        await self.corrections.finished()

    async def settle(self) -> None:
        """Finish the running measurement, if there is one, and keep its result."""
        pending = self.pending
        if pending is None:
            return
        if (left := pending.done - self.now) > 0:
            await asyncio.sleep(left)
        fault = self.faults.take("status")
        loop = asyncio.get_running_loop()
        try:
            result = await loop.run_in_executor(
                self.worker, pending.setup.measure, pending.press, pending.settings
            )
        except Exception as failure:
            self.report_failure(
                f"press {pending.press}: no reading: {failure} ({type(failure).__name__})"
            )
            self.registers.note(Standard.DDE)
            result = NO_RESULT
        self._keep(replace(result, status=fault.status) if fault else result)
        if self.pending is pending:
            self.pending = None

    def connect(self, interface: str) -> None:
        """Connect one of `skins` by the switch."""
        self.interface, self.bench = interface, replace(self.bench, skin=self.skins[interface])
        self.changed()

    def changed(self) -> None:
        """Note a change that affects readings: the next one needs its whole time."""
        self.fresh_from = self.now + self._seconds()

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

    @property
    def now(self) -> float:
        """Time of the loop's clock, s."""
        return asyncio.get_running_loop().time()

    def _keep(self, result: MeasurementResult) -> None:
        self.latest = result
        if self.settings.auto_range:
            self.settings.range = result.conditions.range
        for event in (Measuring.IDX, Measuring.EOM, STATUS_EVENTS.get(result.status)):
            if event:
                self.registers.note(event)

    def _begun(self, done: float) -> PendingMeasurement:
        settings = replace(self.settings, each_range=dict(self.settings.each_range))
        press = self.bench.skin.momentary(self.press, (self.now + done) / 2)
        return PendingMeasurement(press, settings, done, self.bench)

    def _seconds(self) -> float:
        delay = self.settings.each_range[self.settings.range].delay
        return self.pace * (delay + conditions(self.settings, self.settings.range, 0j).seconds)
