"""Common part of virtual meters and readers: the press of the skin, the clock and faults."""

from __future__ import annotations

import asyncio
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from concurrent.futures import Executor, Future
from dataclasses import dataclass, field
from queue import SimpleQueue
from threading import Thread
from typing import TYPE_CHECKING, Any, TypeVar

from ...simulator.sweeps import UNPRESSED, InputError
from ..event_counter import Report
from ..meter.meter_reading import FAILURES

if TYPE_CHECKING:
    from .clients import Client
    from .measurement import Skin

KINDS = {
    "drop": "close the connection instead of answering",
    "late": "answer late",
    "silent": "do not answer",
    "garbage": "answer with bytes that are no text",
    "half": "send half an answer and no end of line",
    "status": "report a failed reading, by default 7 (overflow)",
    "correction": "fail an open or short correction",
    "forget": "lose all settings, as after a power cut",
    "slow": "have the switch turn late",
    "stuck": "have the switch stay where it is",
    "restart": "restart a reader in the middle of a number",
    "miscount": "have the count of a reader's lines jump",
    "repeat": "send a line of a reader twice",
    "interleave": "send a line of a reader again after the next one",
    "endless": "send a line without an end",
    "nan": "send a number that is not finite",
}
GARBAGE = b"\xff\x00\x9c,,;;\x07\xe9\r\n"
ON_ANSWERS = ("drop", "late", "silent", "garbage", "half")
ON_LINES = (*ON_ANSWERS, "restart", "miscount", "repeat", "interleave", "endless", "nan")
"""Faults of a reader's lines."""


@dataclass
class Fault:
    """A kind of fault, and how many times it is still to occur."""

    kind: str
    times: int = 1
    seconds: float = 2.0
    status: int = 7

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise InputError(f"`kind` must be one of {', '.join(KINDS)}, got {self.kind!r}")
        if type(self.times) is not int or not 1 <= self.times <= 10**6:
            raise InputError(f"`times` must be a whole number in 1..1000000, got {self.times!r}")
        if type(self.seconds) not in (int, float) or not 0 <= self.seconds <= 3600:
            raise InputError(f"`seconds` must be in [0, 3600] s, got {self.seconds!r}")
        if self.status not in FAILURES:
            raise InputError(f"`status` must be 1, 7, -7, 9 or 12 to 17, got {self.status}")


@dataclass
class Faults:
    """Pending faults, in order."""

    waiting: list[Fault] = field(default_factory=list)

    def add(self, fault: Fault) -> None:
        """Add a fault for the next occasion."""
        self.waiting.append(fault)

    def take(self, *kinds: str) -> Fault | None:
        """Take the first fault of these kinds, and count it; None if there is none."""
        fault = next((each for each in self.waiting if each.kind in kinds), None)
        if fault:
            fault.times -= 1
            self.waiting = [each for each in self.waiting if each.times]
        return fault


Result = TypeVar("Result")
END_TIMEOUT = 0.3
"""Time for a running call to end, s."""


class Worker(Executor):
    """One thread that executes calls in order. The process ends without waiting for it."""

    def __init__(self) -> None:
        self._tasks: SimpleQueue[tuple[Future, Callable[[], Any]] | None] = SimpleQueue()
        self._thread = Thread(target=self._work, name="virtual skin", daemon=True)
        self._thread.start()

    def submit(self, fn: Callable[..., Result], /, *args: Any, **kwargs: Any) -> Future[Result]:
        """Queue a call, and return its future."""
        future: Future[Result] = Future()
        self._tasks.put((future, lambda: fn(*args, **kwargs)))
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Accept no further call. wait: True to wait for those before."""
        if cancel_futures:
            while not self._tasks.empty():
                task = self._tasks.get()
                if task:
                    task[0].cancel()
        self._tasks.put(None)
        if wait:
            self._thread.join()

    def end(self) -> None:
        """Accept no further call, and wait shortly for the running one."""
        self.shutdown(wait=False, cancel_futures=True)
        self._thread.join(END_TIMEOUT)

    def _work(self) -> None:
        while task := self._tasks.get():
            future, call = task
            if not future.set_running_or_notify_cancel():
                continue
            try:
                future.set_result(call())
            except BaseException as error:
                future.set_exception(error)


@dataclass(kw_only=True)
class VirtualDevice(ABC):
    """A device at a skin, shared by clients. pace: factor on all times; 1: real, 0: none.

    skins: by interface, for a switch; interface: the connected one. report_failure: reports why the
    skin has no reading. report: takes faults of clients.
    """

    pace: float = 1.0
    press: str = UNPRESSED
    faults: Faults = field(default_factory=Faults)
    worker: Worker = field(default_factory=Worker)
    skins: Mapping[str, Skin] = field(default_factory=dict)
    interface: str = ""
    report_failure: Callable[[str], None] = lambda text: None
    report: Report = lambda kind, text: None

    @property
    @abstractmethod
    def skin(self) -> Skin:
        """A skin, by which a press is checked."""

    @property
    @abstractmethod
    def shown_settings(self) -> dict[str, Any]:
        """Settings that the control port shows."""

    @property
    @abstractmethod
    def shown_reading(self) -> dict[str, Any] | None:
        """The latest reading, for a page; None if there is none."""

    @abstractmethod
    async def serve(self, client: Client) -> None:
        """Serve one client until it leaves."""

    @abstractmethod
    def connect(self, interface: str) -> None:
        """Connect one of `skins`. Raises InputError if the device has no switch."""

    @abstractmethod
    def changed(self) -> None:
        """Note a change that affects readings."""

    @property
    def now(self) -> float:
        """Time of the loop's clock, s."""
        return asyncio.get_running_loop().time()
