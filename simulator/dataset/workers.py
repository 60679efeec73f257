"""Who makes the blocks: this process, several on this machine, or a Dask cluster."""

from __future__ import annotations

import atexit
import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from itertools import islice
from multiprocessing.context import BaseContext
from multiprocessing.process import BaseProcess
from typing import Any

from ..sweeps import InputError, check_needs
from .block import Workshop, make_block

NEEDED = (
    "numcodecs.blosc",
    "numcodecs.vlen",
    "rcskin.simulator.cli",
    "rcskin.simulator.dataset.block",
    "rcskin.simulator.dataset.warmed",
)
"""What every block needs, and what starts the command: imported once, by the process that all
workers are copies of."""
AHEAD = 4
"""Blocks handed out beforehand, for each worker."""
RETRIES = 10
MOST_TOGETHER, TASKS_EACH = 16, 20
"""Blocks in one task of a cluster at most; tasks for each of its workers at least, where blocks
suffice: a scheduler takes as long for a small task as for a large one."""
SECONDS_TO_CONNECT = 10
SECONDS_TO_END = 1.0


class WorkerError(RuntimeError):
    """Workers were lost; what they finished is kept."""


def here(workshop: Workshop, blocks: Sequence[int]) -> Iterator[int]:
    """Make the blocks one after the other in this process; yields each when it is finished."""
    return map(partial(make_block, workshop), blocks)


@contextmanager
def hired(workers: int) -> Iterator[Processes | None]:
    """So many processes on this machine, for which all is made ready while this one works.

    They begin with the first blocks. None where one is asked for: there is work for this process
    alone. Raises WorkerError where a process is killed. What is unfinished when this ends is given
    up.
    """
    if workers <= 1:
        yield None
        return
    others = multiprocessing.active_children()
    with ProcessPoolExecutor(workers, _copies(), _begin) as pool:
        try:
            yield Processes(pool, workers)
        except BrokenProcessPool:
            raise WorkerError("a worker was killed; the same command goes on from here") from None
        except BaseException:
            for worker in set(multiprocessing.active_children()) - set(others):
                worker.terminate()
            pool.shutdown(wait=True, cancel_futures=True)
            raise


def _copies() -> BaseContext:
    """Of this, processes are copies of one that has imported what is NEEDED.

    That is begun here, not waited for, and ends with this process. Where the system has none of its
    kind (Windows), each process imports for itself.
    """
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    from multiprocessing import forkserver

    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([*NEEDED])
    with _uninterrupted():
        forkserver.ensure_running()
    return context


@dataclass(frozen=True)
class Processes:
    """Processes on this machine, and how many."""

    pool: ProcessPoolExecutor
    workers: int

    def make(self, workshop: Workshop, blocks: Sequence[int]) -> Iterator[int]:
        """Make the blocks, of which the first are begun now; yields each when it is finished."""
        waiting = iter(blocks)

        def begin(block: int) -> Future[int]:
            return self.pool.submit(make_block, workshop, block)

        with _uninterrupted():
            running = {begin(block) for block in islice(waiting, AHEAD * self.workers)}
        return _finished(running, begin, waiting)


Begin = Callable[[int], Future[int]]


def _finished(running: set[Future[int]], begin: Begin, waiting: Iterator[int]) -> Iterator[int]:
    """Each block when it is finished, another one begun for it."""
    while running:
        done, running = wait(running, return_when=FIRST_COMPLETED)
        running |= {begin(block) for block in islice(waiting, len(done))}
        yield from sorted(future.result() for future in done)


@contextmanager
def _uninterrupted() -> Iterator[None]:
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
    atexit._run_exitfuncs()
    os._exit(1)


def _outlive(parent: BaseProcess) -> None:
    parent.join()
    os._exit(1)


def cluster(
    workshop: Workshop,
    blocks: Sequence[int],
    address: str,
    make: Callable[[Workshop, int], int] = make_block,
) -> Iterator[int]:
    """Make the blocks on a Dask cluster whose workers see the same disk; yields each when finished.

    Blocks of workers that die are made again by others. make: makes one of them. Raises InputError
    where the scheduler cannot be reached, WorkerError where blocks are lost again and again.
    """
    check_needs(f"--scheduler {address}", "scale", "distributed")
    from distributed import Client, KilledWorker, as_completed

    try:
        client: Any = Client(address, timeout=SECONDS_TO_CONNECT)
    except (OSError, ValueError) as error:
        raise InputError(f"--scheduler {address}: cannot be reached: {error}") from error
    with client:
        workers = max(1, sum(client.nthreads().values()))
        waiting = iter(tasks_of(blocks, workers))
        submit = partial(client.submit, _make_all, make, workshop, pure=False, retries=RETRIES)
        running = as_completed([submit(task) for task in islice(waiting, AHEAD * workers)])
        try:
            for future in running:
                yield from future.result()
                running.update([submit(task) for task in islice(waiting, 1)])
        except KilledWorker as error:
            raise WorkerError(f"{error}; the same command goes on from here") from None


def tasks_of(blocks: Sequence[int], workers: int) -> list[Sequence[int]]:
    """The blocks in tasks of equally many, fewer where workers would have too few tasks."""
    together = min(MOST_TOGETHER, max(1, len(blocks) // (TASKS_EACH * workers)))
    return [blocks[first : first + together] for first in range(0, len(blocks), together)]


def _make_all(
    make: Callable[[Workshop, int], int], workshop: Workshop, blocks: Sequence[int]
) -> list[int]:
    return [make(workshop, block) for block in blocks]
