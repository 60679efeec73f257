"""Processes on this machine that share a command's work, and end when it ends."""

from __future__ import annotations

import atexit
import multiprocessing
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from multiprocessing.context import BaseContext
from multiprocessing.process import BaseProcess
from typing import TypeVar

Given = TypeVar("Given")
Made = TypeVar("Made")
SECONDS_TO_END = 1.0


class WorkerError(RuntimeError):
    """Workers were lost; what they finished is kept."""


@contextmanager
def worker_pool(
    workers: int, needed: Sequence[str], advice: str
) -> Iterator[ProcessPoolExecutor | None]:
    """So many processes on this machine, for which all is made ready while this one works.

    They begin with the first task. None where one is asked for: there is work for this process
    alone. needed: modules that every task needs. Raises WorkerError with the advice where a process
    is killed. What is unfinished when this ends is given up.
    """
    if workers <= 1:
        yield None
        return
    others = multiprocessing.active_children()
    with _server_ended(), ProcessPoolExecutor(workers, _copies(needed), _begin) as pool:
        try:
            yield pool
        except BrokenProcessPool:
            raise WorkerError(f"a worker was killed; {advice}") from None
        except BaseException:
            for worker in set(multiprocessing.active_children()) - set(others):
                worker.terminate()
            pool.shutdown(wait=True, cancel_futures=True)
            raise


@contextmanager
def _server_ended() -> Iterator[None]:
    """Where the block ends early, so does the process that workers are copies of.

    It may import for seconds yet, and hears only then that this process is gone.
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


def _copies(needed: Sequence[str]) -> BaseContext:
    """Of this, processes are copies of one that has imported what is needed.

    That is begun here, not waited for, and ends with this process. Where the system has none of its
    kind (Windows), each process imports for itself.
    """
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    from multiprocessing import forkserver, resource_tracker

    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([*needed])
    resource_tracker.ensure_running()  # which unblocks Ctrl-C
    with uninterrupted():
        forkserver.ensure_running()
    return context


def map_in_order(
    pool: ProcessPoolExecutor | None, function: Callable[[Given], Made], given: Sequence[Given]
) -> Iterator[Made]:
    """The function of each item, in order: by processes, or in this one for None."""
    if pool is None:
        return map(function, given)
    with uninterrupted():
        futures = [pool.submit(function, each) for each in given]
    return (future.result() for future in futures)


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Ctrl-C waits; processes started within never hear of it, as they inherit the mask.

    Windows knows of no mask.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _begin() -> None:
    """Ends this process as soon as the one that started it is gone, or says so; Ctrl-C does not."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, _end)
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_outlive, args=(parent,), daemon=True).start()


def _end(*_: object) -> None:
    """Give up the block at work, at once, and only remove locks that other processes know of.

    Within a second: what is interrupted may hold a lock that the exit functions wait for, and to be
    told a second time must not begin them anew.
    """
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    timer = threading.Timer(SECONDS_TO_END, os._exit, (1,))
    timer.daemon = True
    timer.start()
    atexit._run_exitfuncs()  # SystemExit would be taken for an answer of the task at work
    os._exit(1)


def _outlive(parent: BaseProcess) -> None:
    parent.join()
    os._exit(1)
