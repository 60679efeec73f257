"""Worker processes on this machine that share a command's work and end with it."""

from __future__ import annotations

import multiprocessing
import os
import shutil
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from functools import partial
from multiprocessing.context import BaseContext
from multiprocessing.process import BaseProcess
from typing import TypeVar

from .cleanup import before_end_process, end_process, if_ended_within

Given = TypeVar("Given")
Made = TypeVar("Made")
MAX_ON_WINDOWS = 61
"""Largest number of processes of a pool on Windows, which waits for at most 63 handles at once."""


class WorkerError(RuntimeError):
    """Worker processes were killed; their finished results are kept."""


@contextmanager
def worker_pool(
    workers: int, needed: Sequence[str], advice: str
) -> Iterator[ProcessPoolExecutor | None]:
    """Yields a pool of worker processes; None for a single worker: this process does the work.

    The workers start with the first task; what they import is preloaded while this process works.
    On Windows there are at most MAX_ON_WINDOWS. needed: modules that every task needs. Raises
    WorkerError with the advice if a worker is killed. Unfinished tasks are abandoned when the block
    ends.
    """
    if workers <= 1:
        yield None
        return
    if sys.platform == "win32":
        workers = min(workers, MAX_ON_WINDOWS)
    others = multiprocessing.active_children()
    with (
        _server_ends_early(),
        ProcessPoolExecutor(workers, _preloading_context(needed), _begin) as pool,
    ):

        def abandon() -> None:
            for worker in set(multiprocessing.active_children()) - set(others):
                worker.terminate()
            pool.shutdown(wait=True, cancel_futures=True)

        try:
            with if_ended_within(abandon):
                yield pool
        except BrokenProcessPool:
            raise WorkerError(f"a worker was killed; {advice}") from None
        except BaseException:
            abandon()
            raise


@contextmanager
def _server_ends_early() -> Iterator[None]:
    """Ends the fork server if the block ends early.

    The server may still import for seconds, and would notice only then that this process is gone.
    """
    try:
        yield
    except BaseException:
        server = sys.modules.get("multiprocessing.forkserver")
        pid = server and server._forkserver._forkserver_pid  # nothing documented ends it
        if pid:
            with suppress(ProcessLookupError):
                os.kill(pid, signal.SIGTERM)
        raise


def _preloading_context(needed: Sequence[str]) -> BaseContext:
    """Context whose processes are forked from a server that has imported what is needed.

    The server is started here without waiting, and ends with this process. Each process imports for
    itself on Windows, which has no fork servers, and on macOS, whose libraries may crash in forked
    processes (https://docs.python.org/3/library/multiprocessing.html#contexts-and-start-methods).
    """
    methods = multiprocessing.get_all_start_methods()
    if sys.platform == "darwin" or "forkserver" not in methods:
        return multiprocessing.get_context("spawn")
    from multiprocessing import forkserver, resource_tracker, util

    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([*needed])
    resource_tracker.ensure_running()  # which unblocks Ctrl-C
    with uninterrupted():
        forkserver.ensure_running()
    sockets = util.get_temp_dir()  # which multiprocessing removes by a function of `atexit`
    before_end_process(sockets, partial(shutil.rmtree, sockets, ignore_errors=True))
    return context


def map_in_order(
    pool: ProcessPoolExecutor | None, function: Callable[[Given], Made], given: Sequence[Given]
) -> Iterator[Made]:
    """Applies the function to each item, in order: in the pool, or in this process for None."""
    if pool is None:
        return map(function, given)
    with uninterrupted():
        futures = [pool.submit(function, each) for each in given]
    return (future.result() for future in futures)


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Blocks Ctrl-C within the block, also for processes that are started there.

    These inherit the mask and never receive the signal. Windows has no such mask.
    """
    if sys.platform == "win32" or not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _begin() -> None:
    """Initializes a worker: it ends on SIGTERM or with its parent, but not on Ctrl-C."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, _end)
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_exit_with_parent, args=(parent,), daemon=True).start()


def _end(*_: object) -> None:
    """Abandons the current task at once; SystemExit would be taken for its answer.

    A second signal must not start the cleanup again.
    """
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    end_process(1)


def _exit_with_parent(parent: BaseProcess) -> None:
    parent.join()
    os._exit(1)
