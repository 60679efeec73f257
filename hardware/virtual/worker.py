"""Background thread for the virtual meter's computations; it never delays the process's end."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor, Future
from queue import SimpleQueue
from threading import Thread
from typing import Any, TypeVar

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
