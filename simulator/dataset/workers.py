"""Makes blocks in this process, in several processes on this machine, or on a Dask cluster."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from dataclasses import dataclass
from functools import partial
from itertools import islice
from typing import Any

from ..processes import WorkerError, uninterrupted
from ..sweeps import InputError, require_packages
from .work_block import WorkFolder, make_block

NEEDED = (
    "rcskin.simulator.cli",
    "rcskin.simulator.dataset.work_block",
    "rcskin.simulator.dataset.preload",
    "zarr",
)
"""Modules that every block and the command need; the server from which workers are forked imports
them once."""
RESUME_ADVICE = "the same command continues from here"
AHEAD = 4
"""Number of blocks submitted in advance for each worker."""
RETRIES = 10
MAX_TASK_BLOCKS, TASKS_EACH = 16, 20
"""Largest number of blocks in a cluster task, and desired number of tasks per worker: a scheduler
takes as long for a small task as for a large one."""
SECONDS_TO_CONNECT = 10


def in_this_process(workshop: WorkFolder, blocks: Sequence[int]) -> Iterator[int]:
    """Makes the blocks one after the other in this process; yields each when it is finished."""
    return map(partial(make_block, workshop), blocks)


@dataclass(frozen=True)
class Processes:
    """Pool of worker processes on this machine, and their number."""

    pool: ProcessPoolExecutor
    workers: int

    def make(self, workshop: WorkFolder, blocks: Sequence[int]) -> Iterator[int]:
        """Makes the blocks and starts the first ones now; yields each when it is finished."""
        waiting = iter(blocks)

        def begin(block: int) -> Future[int]:
            return self.pool.submit(make_block, workshop, block)

        with uninterrupted():
            running = {begin(block) for block in islice(waiting, AHEAD * self.workers)}
        return _finished(running, begin, waiting)


Begin = Callable[[int], Future[int]]


def _finished(running: set[Future[int]], begin: Begin, waiting: Iterator[int]) -> Iterator[int]:
    """Yields each finished block and starts another one in its place."""
    while running:
        done, running = wait(running, return_when=FIRST_COMPLETED)
        running |= {begin(block) for block in islice(waiting, len(done))}
        yield from sorted(future.result() for future in done)


def cluster(
    workshop: WorkFolder,
    blocks: Sequence[int],
    address: str,
    make: Callable[[WorkFolder, int], int] = make_block,
) -> Iterator[int]:
    """Makes the blocks on a Dask cluster whose workers see the same disk; yields finished ones.

    Blocks of workers that die are made again by others. make: makes one block. Raises InputError if
    the scheduler cannot be reached, WorkerError if blocks are lost repeatedly.
    """
    require_packages(f"--scheduler {address}", "scale", "distributed")
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
            raise WorkerError(f"{error}; {RESUME_ADVICE}") from None


def tasks_of(blocks: Sequence[int], workers: int) -> list[Sequence[int]]:
    """Divides the blocks into equal tasks, smaller ones if workers would have too few tasks."""
    together = min(MAX_TASK_BLOCKS, max(1, len(blocks) // (TASKS_EACH * workers)))
    return [blocks[first : first + together] for first in range(0, len(blocks), together)]


def _make_all(
    make: Callable[[WorkFolder, int], int], workshop: WorkFolder, blocks: Sequence[int]
) -> list[int]:
    return [make(workshop, block) for block in blocks]
