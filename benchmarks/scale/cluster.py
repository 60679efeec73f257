"""What a billion sweeps take on a cluster: simulated workers, workers killed, a slow disk.

A crowd of workers that only sleep shows what the scheduler can do. A small data set, made by real
processes in trouble, shows that its bytes are the same. From both, and from the rate of one real
worker, follows what a hundred of them need.

Run: python benchmarks/scale/cluster.py [--quick]
"""

from __future__ import annotations

import asyncio
import multiprocessing
import os
import random
import shutil
import signal
import tempfile
import time
from collections.abc import Callable, Coroutine, Iterator
from contextlib import contextmanager
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import psutil
from rcskin.benchmarks.bench import Run, launch
from rcskin.benchmarks.scale.dataset import MEGABYTE, SCENE, digest
from rcskin.simulator.dataset.dataset_plan import DatasetPlan
from rcskin.simulator.dataset.generation import generate
from rcskin.simulator.dataset.skin_model import REDUCED
from rcskin.simulator.dataset.work_block import WorkFolder
from rcskin.simulator.dataset.workers import MAX_TASK_BLOCKS, WorkerError, cluster
from rcskin.simulator.scene.scene_files import load_scene
from scipy.optimize import nnls

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


SLOW_DISK = """
import time
from rcskin.simulator.dataset import store

prompt = store.prompt = getattr(store, "prompt", store.write)

def late(*block):
    prompt(*block)
    time.sleep({seconds})

store.write = late
"""
"""Loaded by each worker, and loaded again by some."""


class Trouble(NamedTuple):
    """kills: workers to kill, evenly over the work. late: s that every block is written late."""

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


BILLION = 10**9
CROWDS, FEW_CROWDS = (10, 30, 100), (5,)
TASKS_EACH, FEW_TASKS = 6, 2
SWEEPS, FEW_SWEEPS = 100_000, 2000
RTOL = 1e-4
FIRST_WHOLE = 2
"""Calls of `advance` before the first one that comes after a whole block."""
TROUBLES = {
    "none": Trouble(),
    "workers killed": Trouble(kills=8),
    "every block 20 ms late": Trouble(late=0.02),
    "both": Trouble(kills=8, late=0.02),
}
FEW_TROUBLES = {"both": Trouble(kills=2, late=0.005)}
WORKERS = (1, 2, 10, 100, 1000)


class Alone(NamedTuple):
    """One worker: sweeps a second; and of a block: sweeps, bytes and files."""

    rate: float
    sweeps: int
    bytes: float
    files: float

    @property
    def seconds(self) -> float:
        """That a block takes."""
        return self.sweeps / self.rate


class Crowd(NamedTuple):
    """What was found of workers that sleep through tasks of so many blocks."""

    blocks: int
    found: Busy


class Scheduling(NamedTuple):
    """What a scheduler takes of its processor: s for a task, and share for each worker besides."""

    task: float
    worker: float

    def busy(self, workers: int, tasks: float) -> float:
        """Share of its processor by so many workers and tasks a second."""
        return self.task * tasks + self.worker * workers


def alone(plan: DatasetPlan, folder: Path) -> Alone:
    """Measured on the blocks of a plan but the first, which begins after the training."""
    output, ends = folder / "alone.zarr", list[float]()
    generate(plan, output, progress=lambda *told: ends.append(time.perf_counter()))
    counted = ends[FIRST_WHOLE:]
    chunks = [path for path in output.rglob("c.*") if path.is_file()]
    if len(chunks) < plan.blocks:
        raise RuntimeError(f"{len(chunks)} files for {plan.blocks} blocks")
    sweeps = plan.block_sessions * plan.session_sweeps
    return Alone(
        rate=sweeps * (len(counted) - 1) / (counted[-1] - counted[0]),
        sweeps=sweeps,
        bytes=sum(path.stat().st_size for path in chunks) / plan.blocks,
        files=len(chunks) / plan.blocks,
    )


def told_of_crowd(crowd: Crowd, one: Alone) -> dict[str, str]:
    """A row of the table."""
    seconds, found = crowd.blocks * one.seconds, crowd.found
    ideal = found.tasks * seconds / found.workers
    return {
        "workers that sleep": str(found.workers),
        "blocks a task": str(crowd.blocks),
        "s a task": f"{seconds:.2f}",
        "tasks a second": f"{found.tasks / found.clock:.0f}",
        "scheduler busy": f"{100 * found.scheduler / found.clock:.0f} %",
        "client busy": f"{100 * found.client / found.clock:.0f} %",
        "of the rate without waiting": f"{100 * ideal / found.clock:.0f} %",
    }


def scheduling(crowds: list[Crowd]) -> Scheduling:
    """By least squares over all crowds; nothing less than nothing."""
    found = [each.found for each in crowds]
    A = np.array([[each.tasks, each.workers * each.clock] for each in found], dtype=float)
    return Scheduling(*nnls(A, np.array([each.scheduler for each in found]))[0])


def needed(workers: int, one: Alone, scheduler: Scheduling) -> dict[str, str]:
    """A billion sweeps by so many workers: what each part has to do."""
    whole = workers / one.seconds
    busy = {k: scheduler.busy(workers, whole / k) for k in (1, MAX_TASK_BLOCKS)}
    blocks = whole / max(1.0, busy[MAX_TASK_BLOCKS])
    return {
        "workers": f"{workers:,}",
        "hours": f"{BILLION / (blocks * one.sweeps) / 3600:.2g}",
        "scheduler busy, 1 block a task": f"{100 * busy[1]:,.0f} %",
        f"{MAX_TASK_BLOCKS} blocks a task": f"{100 * busy[MAX_TASK_BLOCKS]:,.0f} %",
        "MB a second": f"{blocks * one.bytes / MEGABYTE:,.0f}",
        "files a second": f"{blocks * one.files:,.0f}",
    }


def in_trouble(plan: DatasetPlan, folder: Path, troubles: dict[str, Trouble]) -> pd.DataFrame:
    """The same plan made by a cluster of two workers in every trouble; RuntimeError where bytes
    differ from those of one process alone."""
    generate(plan, folder / "true.zarr")
    true, rows = digest(folder / "true.zarr"), []
    for name, trouble in troubles.items():
        output = folder / "out.zarr"
        found = made(plan, output, 2, trouble)
        if digest(output) != true:
            raise RuntimeError(f"{name}: other bytes")
        shutil.rmtree(output)
        rows.append(
            {
                "trouble": name,
                "all of it (s)": f"{found.clock:.1f}",
                "workers killed": str(found.killed),
                "calls of the command": str(found.calls),
                "bytes": "the same",
            }
        )
    return pd.DataFrame(rows)


def main(run: Run) -> None:
    """Measure, check and publish."""
    scene, sweeps = load_scene(SCENE), run.sized(SWEEPS, FEW_SWEEPS)
    sizes, troubles = run.sized((2**17, 2**15), (2**14, 2**14)), run.sized(TROUBLES, FEW_TROUBLES)
    with run.kept() as folder:
        one = alone(DatasetPlan(scene.parts, sweeps, 1, RTOL, sizes[0]), folder)
        table = in_trouble(DatasetPlan(scene.parts, sweeps, 2, RTOL, sizes[1]), folder, troubles)
    run.publish("cluster_trouble", "A data set by two workers of a cluster", table)
    found = [
        Crowd(blocks, busy(workers, blocks * one.seconds, run.sized(TASKS_EACH, FEW_TASKS)))
        for workers in run.sized(CROWDS, FEW_CROWDS)
        for blocks in (1, MAX_TASK_BLOCKS)
    ]
    rows = pd.DataFrame([told_of_crowd(each, one) for each in found])
    run.publish("cluster_crowd", "Scheduling of workers that only wait", rows)
    scheduler = scheduling(found)
    rows = pd.DataFrame([needed(workers, one, scheduler) for workers in WORKERS])
    title = (
        f"A billion sweeps of {SCENE}: {one.bytes / one.sweeps:.0f} bytes and "
        f"{1e6 / one.rate:.0f} µs a sweep, {1e3 * scheduler.task:.2f} ms of the scheduler a task"
    )
    run.publish("cluster", title, rows)


if __name__ == "__main__":
    launch(main)
