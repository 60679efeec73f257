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

from ...simulator.sweeps import UNPRESSED
from ..event_counter import Report
from .faults import Faults

if TYPE_CHECKING:
    from .clients import Client
    from .measurement import Skin

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
