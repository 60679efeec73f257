"""What computes beside the virtual meter's conversation, and never holds up its end."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor, Future
from queue import SimpleQueue
from threading import Thread
from typing import Any, TypeVar

Result = TypeVar("Result")
PARTING = 0.3
"""Seconds that a call may take to end by itself."""


class Worker(Executor):
    """One thread that does one thing after the other; the process ends without waiting for it."""

    def __init__(self) -> None:
        self._tasks: SimpleQueue[tuple[Future, Callable[[], Any]] | None] = SimpleQueue()
        self._thread = Thread(target=self._work, name="virtual skin", daemon=True)
        self._thread.start()

    def submit(self, fn: Callable[..., Result], /, *args: Any, **kwargs: Any) -> Future[Result]:
        """The result of a call that is to come."""
        future: Future[Result] = Future()
        self._tasks.put((future, lambda: fn(*args, **kwargs)))
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Take no further call; wait: until those before are done."""
        if cancel_futures:
            while not self._tasks.empty():
                task = self._tasks.get()
                if task:
                    task[0].cancel()
        self._tasks.put(None)
        if wait:
            self._thread.join()

    def end(self) -> None:
        """Take no further call, and be gone where nothing is being done."""
        self.shutdown(wait=False, cancel_futures=True)
        self._thread.join(PARTING)

    def _work(self) -> None:
        while task := self._tasks.get():
            future, call = task
            if not future.set_running_or_notify_cancel():
                continue
            try:
                future.set_result(call())
            except BaseException as error:
                future.set_exception(error)
