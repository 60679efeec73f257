"""Common part of all virtual meters: the skin, the clock, the running measurement and faults.

A dialect is a subclass: its identity, settings, commands, errors and times.
"""

from __future__ import annotations

import asyncio
import inspect
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar

from ..meter.conversation import Event
from ..meter.meter_reading import BY_CODE, VIRTUAL_SERIAL
from .language import (
    SYNTAX_ERROR,
    UNDEFINED_HEADER,
    CommandError,
    ExecutionError,
    LanguageError,
    Message,
    MeterCommand,
    Vocabulary,
    messages,
)
from .measurement import NO_RESULT, MeasurementResult, MeasurementSetup, Settings
from .virtual_device import GARBAGE, ON_ANSWERS, Fault, VirtualDevice

if TYPE_CHECKING:
    from .clients import Client
    from .measurement import Skin


@dataclass
class EventRegisters:
    """Standard event register with its mask, and the mask of the status byte."""

    standard: int = Event.POWER_ON
    standard_mask: int = 0
    request_mask: int = 0

    def note(self, event: Event) -> None:
        """Set the bit of an event."""
        self.standard |= event

    def take_standard(self) -> int:
        """Read and clear the standard register."""
        taken, self.standard = int(self.standard), 0
        return taken

    def clear(self) -> None:
        """`*CLS`: clear the events, keep the masks."""
        self.standard = 0

    def status_byte(self, waiting: bool, further: int = 0) -> int:
        """Status byte: ESB 32, MAV 16 with a waiting answer, MSS 64 by the mask.

        further: bits of the dialect.
        """
        byte = 32 * bool(self.standard & self.standard_mask) | 16 * waiting | further
        return byte | 64 * bool(byte & self.request_mask)


async def answer(meter: Instrument, line: str) -> str:
    """Answer of the meter to a line; empty if there is none."""
    answers: list[str] = []
    if meter.faults.take("forget"):
        meter.restart()
    try:
        for message in messages(line):
            meter.waiting = bool(answers)
            answers += await _execute(meter, message)
    except CommandError as error:
        meter.refuse(error)
    return ";".join(answers)


async def _execute(meter: Instrument, message: Message) -> list[str]:
    command, suffixes = meter.command(message.words) or (None, ())
    act = command and (command.on_query if message.query else command.on_set)
    if command is None or act is None:
        raise CommandError(message.words, UNDEFINED_HEADER)
    command.check_arguments(message)
    try:
        said = act(meter, *suffixes, *message.arguments)
        said = await said if inspect.isawaitable(said) else said
    except ExecutionError as error:
        meter.refuse(error)
        return []
    return [] if said is None else [meter.answer_text(command, str(said))]


@dataclass
class PendingMeasurement:
    """A running measurement. done: time of its end, s of the loop's clock.

    points: press, momentary in the middle of the point, and settings of each reading.
    """

    points: tuple[tuple[Any, Settings], ...]
    done: float
    setup: MeasurementSetup


@dataclass
class Instrument(VirtualDevice, ABC):
    """One meter, shared by clients. bench: the connected skin, the readout and the accuracy.

    note: what differs from the real instrument, if a user must know it.
    """

    note: ClassVar[str] = ""
    bench: MeasurementSetup
    model: str = ""
    serial: str = VIRTUAL_SERIAL
    settings: Any = None
    latest: MeasurementResult = NO_RESULT
    pending: PendingMeasurement | None = None
    fresh_from: float = 0.0
    waiting: bool = False

    @property
    def skin(self) -> Skin:
        """The connected skin."""
        return self.bench.skin

    @property
    def shown_reading(self) -> dict[str, Any] | None:
        """The latest reading, for a page; None if it has no numbers."""
        if not self.latest.status.has_values:
            return None
        Z = self.latest.Z.real, self.latest.Z.imag
        return {"frequency": self.latest.conditions.frequency, "Z": Z}

    @classmethod
    @abstractmethod
    def vocabulary(cls) -> Vocabulary:
        """All commands of the model."""

    @property
    @abstractmethod
    def identity(self) -> str:
        """Answer to `*IDN?`."""

    @property
    @abstractmethod
    def band(self) -> tuple[float, float]:
        """Lowest and highest frequency, Hz."""

    @property
    @abstractmethod
    def line_end(self) -> str:
        """End of an answer."""

    @property
    @abstractmethod
    def seconds(self) -> float:
        """Time of a measurement with the present settings at pace 1, s."""

    @property
    def shown_settings(self) -> dict[str, Any]:
        """Settings that the control port shows."""
        names = ("frequency", "range", "trigger")
        return {name: getattr(self.settings, name) for name in names}

    @abstractmethod
    def command(self, words: tuple[str, ...]) -> tuple[MeterCommand, tuple[int, ...]] | None:
        """Command of these words with the numbers of its suffixes; None if unknown."""

    @abstractmethod
    def refuse(self, error: LanguageError) -> None:
        """Note an error of a client, as the dialect reports it."""

    @abstractmethod
    def fail(self) -> None:
        """Note a failure inside the meter, as the dialect reports it."""

    @abstractmethod
    def keep(self, results: Sequence[MeasurementResult]) -> None:
        """Keep the results of a measurement, one for each point."""

    @abstractmethod
    def reset(self) -> None:
        """Set the factory settings, without corrections and readings."""

    @abstractmethod
    def restart(self) -> None:
        """Simulate a power cut."""

    def answer_text(self, command: MeterCommand, said: str) -> str:
        """Answer of a command as it is sent."""
        return said

    async def serve(self, client: Client) -> None:
        """Answer each line of a client."""
        async for line in client.lines():
            if line is None:
                self.refuse(CommandError("line", SYNTAX_ERROR))
                continue
            said = await answer(self, line)
            if said:
                fault = self.faults.take(*ON_ANSWERS)
                await client.say(await _spoilt(f"{said}{self.line_end}".encode("ascii"), fault))

    async def settle(self) -> None:
        """Finish the running measurement, if there is one, and keep its results."""
        pending = self.pending
        if pending is None:
            return
        if (left := pending.done - self.now) > 0:
            await asyncio.sleep(left)
        fault = self.faults.take("status")
        results = [await self._measured(pending.setup, *point) for point in pending.points]
        if fault:
            results = [replace(result, status=BY_CODE[fault.status]) for result in results]
        self.keep(results)
        if self.pending is pending:
            self.pending = None

    def connect(self, interface: str) -> None:
        """Connect one of `skins` by the switch."""
        self.interface, self.bench = interface, replace(self.bench, skin=self.skins[interface])
        self.changed()

    def changed(self) -> None:
        """Note a change that affects readings: the next one needs its whole time."""
        self.fresh_from = self.now + self.pace * self.seconds

    def begin(self, done: float, points: Sequence[Settings] = ()) -> None:
        """Begin a measurement that is done at a time, s, at points or with the present settings."""
        now, each = self.now, tuple(points) or (self.settings.replaced(),)
        step = (done - now) / len(each)
        presses = [
            self.bench.skin.momentary(self.press, now + (n + 0.5) * step) for n in range(len(each))
        ]
        self.pending = PendingMeasurement(tuple(zip(presses, each, strict=True)), done, self.bench)

    async def _measured(
        self, setup: MeasurementSetup, press: Any, settings: Settings
    ) -> MeasurementResult:
        loop = asyncio.get_running_loop()
        try:
            return await loop.run_in_executor(self.worker, setup.measure, press, settings)
        except Exception as failure:
            self.report_failure(f"press {press}: no reading: {failure} ({type(failure).__name__})")
            self.fail()
            return NO_RESULT


async def _spoilt(said: bytes, fault: Fault | None) -> bytes:
    """Answer with a fault, if there is one."""
    if fault is None:
        return said
    if fault.kind == "late":
        await asyncio.sleep(fault.seconds)
    if fault.kind == "drop":
        raise ConnectionAbortedError("the fault `drop` closes the connection")
    instead = {"silent": b"", "garbage": GARBAGE, "half": said[: len(said) // 2]}
    return instead.get(fault.kind, said)
