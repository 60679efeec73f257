"""What a billion sweeps take on a cluster: simulated workers, workers killed, a slow disk.

A crowd of workers that only sleep shows what the scheduler can do. A small data set, made by real
processes in trouble, shows that its bytes are the same. From both, and from the rate of one real
worker, follows what a hundred of them need.

Run: python benchmarks/scale/cluster.py [--quick]
"""

from __future__ import annotations

import shutil
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
from rcskin.benchmarks.bench import Run, launch, publish
from rcskin.benchmarks.scale.cluster_parts.crowd import Busy, busy
from rcskin.benchmarks.scale.cluster_parts.hostile import Trouble, made
from rcskin.benchmarks.scale.dataset import MEGABYTE, SCENE, digest
from rcskin.simulator.dataset.dataset_plan import DatasetPlan
from rcskin.simulator.dataset.generation import generate
from rcskin.simulator.dataset.workers import MAX_TASK_BLOCKS
from rcskin.simulator.scene.scene_files import load_scene
from scipy.optimize import nnls

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
    "every chunk 20 ms late": Trouble(late=0.02),
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
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        one = alone(DatasetPlan(scene.parts, sweeps, 1, RTOL, sizes[0]), folder)
        table = in_trouble(DatasetPlan(scene.parts, sweeps, 2, RTOL, sizes[1]), folder, troubles)
    publish(run.results, "cluster_trouble", "A data set by two workers of a cluster", table)
    found = [
        Crowd(blocks, busy(workers, blocks * one.seconds, run.sized(TASKS_EACH, FEW_TASKS)))
        for workers in run.sized(CROWDS, FEW_CROWDS)
        for blocks in (1, MAX_TASK_BLOCKS)
    ]
    rows = pd.DataFrame([told_of_crowd(each, one) for each in found])
    publish(run.results, "cluster_crowd", "Scheduling of workers that only wait", rows)
    scheduler = scheduling(found)
    rows = pd.DataFrame([needed(workers, one, scheduler) for workers in WORKERS])
    title = (
        f"A billion sweeps of {SCENE}: {one.bytes / one.sweeps:.0f} bytes and "
        f"{1e6 / one.rate:.0f} µs a sweep, {1e3 * scheduler.task:.2f} ms of the scheduler a task"
    )
    publish(run.results, "cluster", title, rows)


if __name__ == "__main__":
    launch(main)
