"""Virtual impedance analyser Keysight E4990A: sweeps of one channel with up to four traces.

Sources: the SCPI tree of the E4990A's help as public drivers use it (sweep, segment table, data),
and manuals of its family: the programmer's guide of the E5061A/E5062A, chapter 13 and appendix B
(trigger system, registers, queue of 100 errors, 2 to 1601 points), and the user's guide of the
E4981A, page 209 (a number out of range is replaced by the nearest limit).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Any, ClassVar

from ..language import SUFFIX_OUT_OF_RANGE, CommandError, Vocabulary
from .analyser_settings import BAND, AnalyserSettings
from .keysight_instrument import KeysightInstrument
from .lcr_settings import shown_quantity
from .scpi_values import NO_NUMBER, nr3, one_of

QUANTITIES = {"R": "RS", "TZ": "PHASE", "TY": "YPHASE", "D": "DC", "Q": "QC"}
"""Names of quantities in `shown_quantity` that differ from those of the analyser."""


@dataclass
class VirtualE4990A(KeysightInstrument):
    """Virtual E4990A with option 120. waited: True if `*OPC?` waits for the running sweep."""

    model: str = "E4990A"
    firmware: ClassVar[str] = "A.02.12"
    queue_length: ClassVar[int] = 100
    rising: int = 0x4030
    falling: int = 0
    settings: AnalyserSettings = field(default_factory=AnalyserSettings)
    waited: bool = False

    @classmethod
    def vocabulary(cls) -> Vocabulary:
        """All commands of the analyser."""
        return _vocabulary()

    @property
    def band(self) -> tuple[float, float]:
        """Lowest and highest frequency, Hz."""
        return BAND

    @property
    def shown_settings(self) -> dict[str, Any]:
        """Settings that the control port shows. frequency: of the first point, Hz."""
        frequency = self.points()[0].frequency
        return {"frequency": frequency, "range": "auto", "trigger": self.settings.trigger}

    def points(self) -> Sequence[AnalyserSettings]:
        """Settings at each point of the sweep."""
        return self.settings.sweep_points()

    @property
    def seconds(self) -> float:
        """Time of what a trigger starts, at pace 1, s."""
        settings = self.settings
        averaged = settings.sweep_average and settings.average_trigger
        sweeps = settings.sweep_count if averaged else 1
        return sweeps * sum(point.seconds + settings.delay for point in self.points())

    async def trigger(self) -> None:
        """`:TRIGger` or `*TRG`: start a sweep that `*OPC?` does not wait for."""
        await super().trigger()
        self.waited = False

    def set_source(self, text: str) -> None:
        """`:TRIGger:SOURce`, which ends a running sweep."""
        self.settings.trigger = one_of("INTernal", "EXTernal", "MANual", "BUS")(text)
        self.abort()

    async def single(self) -> None:
        """`:TRIGger:SINGle`: start a sweep that `*OPC?` waits for."""
        await self.trigger()
        self.waited = True

    async def finished(self) -> None:
        """Wait for acquisitions, and for a sweep that was started by `:TRIGger:SINGle`."""
        await self.settle_if_done()
        if self.waited or self.pending is None:
            await super().finished()

    async def formatted(self, trace: int) -> str:
        """`:CALCulate:DATA:FDATa?`: value of a trace and 0 for each point of the latest sweep."""
        if trace > len(self.settings.parameters):
            raise CommandError(trace, SUFFIX_OUT_OF_RANGE)
        name = self.settings.parameters[trace - 1]
        return await self._data(
            lambda Z, frequency: (shown_quantity(QUANTITIES.get(name, name), Z, frequency), 0.0)
        )

    async def complex_data(self) -> str:
        """`:CALCulate:DATA:RDATa?`: R and X for each point of the latest sweep."""
        return await self._data(lambda Z, frequency: (Z.real, Z.imag))

    async def _data(self, of: Callable[[complex, float], tuple[float, float]]) -> str:
        """Pairs of the latest sweep, which is old while another one runs; 0 before any sweep."""
        if self.runs_freely:
            await self.newest()
        await self.settle_if_done()
        count = len(self.points())
        if len(self.results) != count:
            return numbers_text([0.0] * 2 * count)
        pairs = [
            of(each.Z, each.conditions.frequency) if each.has_numbers else (NO_NUMBER, NO_NUMBER)
            for each in self.results
        ]
        return numbers_text([value for pair in pairs for value in pair])


def numbers_text(values: Sequence[float]) -> str:
    """Numbers with twelve digits, joined by commas."""
    return ",".join(nr3(value, 11) for value in values)


@cache
def _vocabulary() -> Vocabulary:
    from .analyser_commands import ANALYSER_COMMANDS
    from .keysight_common_commands import COMMON_COMMANDS

    return Vocabulary((*COMMON_COMMANDS, *ANALYSER_COMMANDS))
