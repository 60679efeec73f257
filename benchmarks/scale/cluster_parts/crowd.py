"""A scheduler in a process of its own, and as many workers as asked in another, which only sleep.

What a real worker computes takes a core; a worker that sleeps as long takes none. So a hundred fit
on one machine, and the scheduler has as much to do as with a hundred real ones.
"""

from __future__ import annotations

import asyncio
import multiprocessing
import time
from collections.abc import Callable, Coroutine, Iterator
from contextlib import contextmanager
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import NamedTuple

import psutil
from rcskin.simulator.dataset.skin_model import REDUCED
from rcskin.simulator.dataset.work_block import WorkFolder
from rcskin.simulator.dataset.workers import cluster

Begun = Callable[..., Coroutine[object, object, None]]
NOWHERE = WorkFolder(Path(), "", REDUCED.load)
SECONDS_TO_BEGIN = 60
WARMING = 2
"""Tasks of each worker that are not counted."""


class Busy(NamedTuple):
    """By so many workers: tasks, finished in `clock` s.

    scheduler, client: s of the processor that they took.
    """

    workers: int
    tasks: int
    clock: float
    scheduler: float
    client: float


class Sleep(NamedTuple):
    """What a sleeping worker does with a block."""

    seconds: float

    def __call__(self, workshop: WorkFolder, block: int) -> int:
        """The block's number, later."""
        time.sleep(self.seconds)
        return block


def busy(workers: int, seconds: float, tasks_each: int) -> Busy:
    """Let so many workers sleep through tasks of so many seconds, some each."""
    with _scheduler() as (address, scheduler), _crowd(address, workers):
        blocks, client = range(workers * tasks_each), psutil.Process()
        warm = range(WARMING * workers)
        for _ in cluster(NOWHERE, warm, address, Sleep(min(seconds, 0.1))):
            pass
        before = (time.perf_counter(), _used(scheduler), _used(client))
        done = sum(1 for _ in cluster(NOWHERE, blocks, address, Sleep(seconds)))
        after = (time.perf_counter(), _used(scheduler), _used(client))
    if done != len(blocks):
        raise RuntimeError(f"{done} of {len(blocks)} blocks came back")
    return Busy(workers, done, *(late - early for early, late in zip(before, after, strict=True)))


def _used(process: psutil.Process) -> float:
    times = process.cpu_times()
    return times.user + times.system


@contextmanager
def _scheduler() -> Iterator[tuple[str, psutil.Process]]:
    with _begun(_schedule) as (process, address):
        yield address, psutil.Process(process.pid)


@contextmanager
def _crowd(address: str, workers: int) -> Iterator[None]:
    with _begun(_work, address, workers):
        yield


@contextmanager
def _begun(work: Begun, *given: object) -> Iterator[tuple[BaseProcess, str]]:
    """A process that does this, once it has said that it is ready, and what it said."""
    context = multiprocessing.get_context("spawn")
    here, there = context.Pipe()
    process = context.Process(target=_run, args=(work, there, *given), daemon=True)
    process.start()
    try:
        if not here.poll(SECONDS_TO_BEGIN):
            raise RuntimeError(f"{work} did not begin within {SECONDS_TO_BEGIN} s")
        yield process, here.recv()
    finally:
        process.kill()
        process.join()


def _run(work: Begun, said: Connection, *given: object) -> None:
    import dask

    dask.config.set({"logging.distributed": "error"})
    asyncio.run(work(said, *given))


async def _schedule(said: Connection) -> None:
    from distributed import Scheduler

    async with Scheduler(port=0, dashboard=False, host="127.0.0.1") as scheduler:
        said.send(scheduler.address)
        await scheduler.finished()


async def _work(said: Connection, address: str, workers: int) -> None:
    from distributed import Worker

    crowd = [Worker(address, nthreads=1, dashboard=False, memory_limit=0) for _ in range(workers)]
    await asyncio.gather(*crowd)
    said.send("ready")
    await asyncio.gather(*(worker.finished() for worker in crowd))
