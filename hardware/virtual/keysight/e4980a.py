"""Virtual LCR meters Keysight E4980A and E4980AL, and Agilent 4284A, whose dialect they share.

Sources: Keysight E4980A/AL user's guide (pages 242 and 316: syntax, 249 to 252: trigger, 255 to
259: data buffer, 261 to 269: data transfer, 272 to 274: registers), as far as it was at hand, and
public drivers of these meters.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import ClassVar

from ..language import ExecutionError, Vocabulary
from ..measurement import MeasurementResult
from .error_queue import STALE_DATA
from .keysight_instrument import KeysightInstrument
from .lcr_settings import FUNCTIONS, RANGES, LcrLimits, LcrSettings, shown_quantity
from .scpi_values import NO_NUMBER, nr3

NO_DATA = f"{nr3(NO_NUMBER)},{nr3(NO_NUMBER)},-1,+0"
"""An entry of the data buffer that was not filled."""


@dataclass
class VirtualE4980A(KeysightInstrument):
    """Virtual E4980A. step: next point of a list in the mode STEPped. data_format: of answers.

    trigger_delays: True if the trigger has a delay of its own, `:TRIGger:TDELay`, beside that of
    each step of a list, `:TRIGger:DELay`.

    buffer: texts of readings in the data buffer. filling: True while readings go there.
    """

    model: str = "E4980A"
    firmware: ClassVar[str] = "A.06.15"
    limits: ClassVar[LcrLimits] = LcrLimits((20.0, 2e6), 201)
    data_format: ClassVar[str] = "ASC,64"
    trigger_delays: ClassVar[bool] = True
    settings: LcrSettings = field(default_factory=LcrSettings)
    step: int = 0
    buffer: list[str] = field(default_factory=list)
    buffer_size: int = 201
    filling: bool = False

    @classmethod
    def vocabulary(cls) -> Vocabulary:
        """All commands of these meters."""
        return _vocabulary(cls.trigger_delays)

    @property
    def band(self) -> tuple[float, float]:
        """Lowest and highest frequency, Hz."""
        return self.limits.frequency

    @property
    def lists(self) -> bool:
        """True if a trigger starts a list sweep: only on the page LIST."""
        return self.settings.page == "LIST" and bool(self.settings.list_values)

    def points(self) -> Sequence[LcrSettings]:
        """Settings of each reading that a trigger starts."""
        if not self.lists:
            return [self.settings]
        points = self.settings.list_points()
        if self.settings.list_mode == "SEQ":
            return points
        self.step = self.step % len(points) + 1
        return points[self.step - 1 : self.step]

    @property
    def seconds(self) -> float:
        """Time of what a trigger starts, at pace 1, s."""
        if not self.lists:
            return self.settings.delay + self.settings.seconds
        points = self.settings.list_points()
        some = points if self.settings.list_mode == "SEQ" else points[:1]
        return self.settings.delay + sum(point.seconds for point in some)

    def keep(self, results: Sequence[MeasurementResult]) -> None:
        """Keep the results, also in the data buffer while it is filled."""
        super().keep(results)
        if self.settings.auto_range:
            self.settings.range = RANGES[min(results[-1].conditions.range, len(RANGES)) - 1]
        if self.filling:
            texts = [self.reading_text(each, with_bin=True) for each in results]
            self.buffer = (self.buffer + texts)[: self.buffer_size]
            self.filling = len(self.buffer) < self.buffer_size

    async def fetch(self) -> str:
        """`:FETCh?`: the latest readings, which are old if nothing triggered new ones.

        Raises ExecutionError if there are none.
        """
        await self.newest()
        if not self.results:
            raise ExecutionError("FETCh", STALE_DATA)
        with_bin = self.settings.comparator or self.lists
        return ",".join(self.reading_text(each, with_bin) for each in self.results)

    async def fetch_corrected(self) -> str:
        """`:FETCh:IMPedance:CORRected?`: R and X of the latest readings."""
        await self.newest()
        if not self.results:
            raise ExecutionError("FETCh", STALE_DATA)
        digits = self._decimals
        return ",".join(
            f"{nr3(each.Z.real, digits)},{nr3(each.Z.imag, digits)}" for each in self.results
        )

    async def trigger_and_fetch(self) -> str:
        """`*TRG`: `:TRIGger;:FETCh?` in one; user's guide, pages 250 to 252."""
        await self.bus_trigger()
        return await self.fetch()

    def reading_text(self, result: MeasurementResult, with_bin: bool) -> str:
        """`<A>,<B>,<status>[,<bin>]`; an overload is 9.9E37 with status +1: page 261."""
        settings, numbers = self.settings, (NO_NUMBER, NO_NUMBER)
        if result.has_numbers:
            first, second = self.quantities(result)
            numbers = (
                _deviation(first, settings.deviation_1, settings.references[0]),
                _deviation(second, settings.deviation_2, settings.references[1]),
            )
        parts = [nr3(each, self._decimals) for each in numbers]
        parts.append(f"{0 if result.has_numbers else 1:+d}")
        return ",".join([*parts, "+0"] if with_bin else parts)

    def quantities(self, result: MeasurementResult) -> tuple[float, float]:
        """Both quantities of a reading with numbers."""
        at = result.Z, result.conditions.frequency
        first, second = FUNCTIONS[self.settings.function]
        return shown_quantity(first, *at), shown_quantity(second, *at)

    def buffer_text(self) -> str:
        """`:MEMory:READ? DBUF`: all entries, those not filled with status -1."""
        missing = self.buffer_size - len(self.buffer)
        return ",".join([*self.buffer, *[NO_DATA] * missing])

    def clear_buffer(self) -> None:
        """`:MEMory:CLEar DBUF`: empty the data buffer and stop filling it."""
        self.buffer, self.filling = [], False

    def reset(self) -> None:
        """`*RST`: factory settings, without list and data buffer."""
        super().reset()
        self.clear_buffer()
        self.step, self.buffer_size = 0, 201

    @property
    def _decimals(self) -> int:
        return 9 if self.settings.long_format else 5


@dataclass
class VirtualE4980AL(VirtualE4980A):
    """Virtual E4980AL with option 102: up to 1 MHz."""

    model: str = "E4980AL"
    limits: ClassVar[LcrLimits] = LcrLimits((20.0, 1e6), 201)


@dataclass
class Virtual4284A(VirtualE4980A):
    """Virtual 4284A: up to 1 MHz, ten points in a list, GP-IB only in reality."""

    model: str = "4284A"
    maker: ClassVar[str] = "HEWLETT-PACKARD"
    firmware: ClassVar[str] = "REV01.20"
    limits: ClassVar[LcrLimits] = LcrLimits(
        (20.0, 1e6), 10, (0, 1, 2), voltage=(5e-3, 2.0), current=(50e-6, 20e-3)
    )
    data_format: ClassVar[str] = "ASC"
    trigger_delays: ClassVar[bool] = False
    note: ClassVar[str] = "a 4284A has GP-IB only; the virtual one answers on TCP instead"


def _deviation(value: float, mode: str, reference: float) -> float:
    """What a deviation measurement shows: the difference, in % of the reference if PERC."""
    if mode == "OFF":
        return value
    difference = value - reference
    return difference if mode == "ABS" else 100 * difference / (reference or math.inf)


@cache
def _vocabulary(trigger_delays: bool) -> Vocabulary:
    from .keysight_common_commands import COMMON_COMMANDS
    from .lcr_commands import DELAYS, LCR_COMMANDS

    return Vocabulary((*COMMON_COMMANDS, *LCR_COMMANDS, *DELAYS[trigger_delays]))
