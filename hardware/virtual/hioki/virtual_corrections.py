"""Open and short correction of Hioki's meters: takes time, ends in an event, may fail."""

from __future__ import annotations

import asyncio
from dataclasses import dataclass, field
from typing import Protocol

from ..faults import Faults
from ..language import ExecutionError
from .meter_state import Measuring, Registers, Settings

SECONDS = {"ALL": 4.0, "SPOT": 1.0}
SETTINGS = {"OPEN": "open_correction", "SHORT": "short_correction"}


class CorrectedMeter(Protocol):
    """The parts of a meter that a correction uses."""

    pace: float
    settings: Settings
    registers: Registers
    faults: Faults


@dataclass
class CorrectionRuns:
    """Running acquisitions, and the error code of the last one of each kind (0: success)."""

    under_way: dict[str, asyncio.Task] = field(default_factory=dict)
    errors: dict[str, int] = field(default_factory=lambda: {"OPEN": 0, "SHORT": 0})

    def start(self, meter: CorrectedMeter, kind: str, extent: str) -> None:
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

    async def _acquire(self, meter: CorrectedMeter, kind: str, extent: str) -> None:
        await asyncio.sleep(meter.pace * SECONDS[extent])
        failed = meter.faults.take("correction") is not None
        self.errors[kind] = int(failed)
        if not failed:
            setattr(meter.settings, SETTINGS[kind], extent)
        meter.registers.note(Measuring.CEM)
        self.under_way.pop(kind, None)
