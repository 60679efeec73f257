"""A cluster of processes that loses workers at random and writes to a slow disk."""

from __future__ import annotations

import os
import random
import signal
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

from rcskin.simulator.dataset.dataset_plan import DatasetPlan
from rcskin.simulator.dataset.generation import generate
from rcskin.simulator.dataset.workers import WorkerError

SLOW_DISK = """
import time
from rcskin.simulator.dataset import chunks, store

prompt = chunks.put

def late(*chunk):
    prompt(*chunk)
    time.sleep({seconds})

store.put = late
"""


class Trouble(NamedTuple):
    """kills: workers to kill, evenly over the work. late: s that every chunk is written late."""

    kills: int = 0
    late: float = 0.0


class Made(NamedTuple):
    """A data set: in `clock` s, with so many workers killed, by so many calls of the command."""

    clock: float
    killed: int
    calls: int


class Killer:
    """Kills a worker of a cluster, drawn at random, after every so many sweeps."""

    def __init__(self, cluster: Any, plan: DatasetPlan, kills: int) -> None:
        """kills: in all of the plan."""
        self._cluster, self._chance = cluster, random.Random(1)
        self._at = [plan.sweeps * (k + 1) / (kills + 1) for k in range(kills)]
        self.killed = 0

    def progress(self, work: str, done: float | None = None, total: float = 1.0, /) -> None:
        """Called after every block that is finished, with the sweeps that are done."""
        while self.killed < len(self._at) and (done or 0) >= self._at[self.killed]:
            alive = [worker.pid for worker in self._cluster.workers.values() if worker.pid]
            self.killed += 1
            if alive:
                os.kill(self._chance.choice(alive), signal.SIGKILL)


def made(plan: DatasetPlan, output: Path, workers: int, trouble: Trouble) -> Made:
    """Make the data set in trouble, and go on as a user would where the command gives up."""
    with _cluster(workers, trouble.late) as cluster:
        killer = Killer(cluster, plan, trouble.kills)
        start, calls = time.perf_counter(), 1
        while True:
            try:
                address = cluster.scheduler_address
                generate(plan, output, scheduler=address, progress=killer.progress)
                return Made(time.perf_counter() - start, killer.killed, calls)
            except WorkerError:
                calls += 1


@contextmanager
def _cluster(workers: int, late: float) -> Iterator[Any]:
    import dask
    from distributed import LocalCluster

    with tempfile.TemporaryDirectory() as folder:
        slow = Path(folder) / "slow_disk.py"
        slow.write_text(SLOW_DISK.format(seconds=late), encoding="utf-8")
        settings = {
            "distributed.worker.preload": [str(slow)] if late else [],
            "distributed.logging.distributed": "error",
        }
        with (
            dask.config.set(settings),
            LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                processes=True,
                dashboard_address=None,
                silence_logs="ERROR",
            ) as cluster,
        ):
            yield cluster
