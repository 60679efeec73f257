"""Open and short correction: acquiring takes time, ends in an event, and may fail."""

from __future__ import annotations

import asyncio
from dataclasses import dataclass, field
from typing import Protocol

from .faults import Faults
from .language.parser import ExecutionError
from .meter_state import Measuring, Registers, Settings

SECONDS = {"ALL": 4.0, "SPOT": 1.0}
SETTINGS = {"OPEN": "open_correction", "SHORT": "short_correction"}


class Corrected(Protocol):
    """What correcting touches of a meter."""

    pace: float
    settings: Settings
    registers: Registers
    faults: Faults


@dataclass
class Corrections:
    """What is being acquired, and how the last acquisition of each kind ended (0 is well)."""

    under_way: dict[str, asyncio.Task] = field(default_factory=dict)
    errors: dict[str, int] = field(default_factory=lambda: {"OPEN": 0, "SHORT": 0})

    def start(self, meter: Corrected, kind: str, extent: str) -> None:
        """Acquire a correction. Raises ExecutionError under internal trigger, or if one runs."""
        if meter.settings.trigger != "EXTERNAL" or self.busy:
            raise ExecutionError(kind)
        self.under_way[kind] = asyncio.get_running_loop().create_task(
            self._acquire(meter, kind, extent)
        )

    def cancel(self, kind: str) -> None:
        """Stop acquiring; what was in use before stays in use."""
        task = self.under_way.pop(kind, None)
        if task:
            task.cancel()

    def stop(self) -> None:
        """Stop acquiring anything."""
        for kind in tuple(self.under_way):
            self.cancel(kind)

    @property
    def busy(self) -> bool:
        """Whether one is being acquired."""
        return bool(self.under_way)

    async def finished(self) -> None:
        """Wait until nothing is being acquired."""
        while self.busy:
            await asyncio.wait(self.under_way.values())

    async def _acquire(self, meter: Corrected, kind: str, extent: str) -> None:
        await asyncio.sleep(meter.pace * SECONDS[extent])
        failed = meter.faults.take("correction") is not None
        self.errors[kind] = int(failed)
        if not failed:
            setattr(meter.settings, SETTINGS[kind], extent)
        meter.registers.note(Measuring.CEM)
        self.under_way.pop(kind, None)
