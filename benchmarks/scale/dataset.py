"""Sweeps a second of `rcskin dataset` against workers, peak memory, and whether bytes agree.

Run: python benchmarks/scale/dataset.py [--quick] [SWEEPS]

Two data sets made at once, by a process each, tell how much a second core of this machine can gain
at most: they share nothing but memory and disk.

Memory is the sum over all processes of what each has for itself and its share of common pages,
sampled twice a second. Bytecode is kept, as an installation keeps it, and made before anything is
timed.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from hashlib import sha256
from pathlib import Path

import psutil
from rcskin.benchmarks.bench import Run, launch, rcskin_command

SCENE = "sheet-5x5"
SWEEPS, FEW_SWEEPS = 1_000_000, 500
PROCESSES = (1, 2)
MEGABYTE = 2**20


def measured(sweeps: int, options: list[str], output: Path) -> dict[str, float]:
    """One run from start to end: seconds until the model is trained, in all, and peak memory."""
    words = rcskin_command("dataset", SCENE, "--sweeps", sweeps, "-o", output, *options)
    start, trained, peak = time.perf_counter(), 0.0, 0
    run = subprocess.Popen(words, stdout=subprocess.DEVNULL)
    plan = output.with_name(f".{output.name}.unfinished") / "plan.json"
    while run.poll() is None:
        if not trained and plan.exists():
            trained = time.perf_counter() - start
        peak = max(peak, memory() if trained else 0)
        time.sleep(0.5 if trained else 0.05)
    if run.returncode != 0:
        raise RuntimeError(f"{' '.join(words)} ended with code {run.returncode}")
    return {"start": trained, "all": time.perf_counter() - start, "peak": peak / MEGABYTE}


def memory() -> int:
    """Bytes that the processes started here take, without this one."""
    return sum(_bytes_of(child) for child in psutil.Process().children(recursive=True))


def _bytes_of(process: psutil.Process) -> int:
    try:
        return process.memory_full_info().pss
    except psutil.Error:
        return 0


@contextmanager
def cluster(workers: int) -> Iterator[list[str]]:
    """Options that let a local Dask cluster of so many processes make the data set."""
    from distributed import LocalCluster

    with LocalCluster(
        n_workers=workers, threads_per_worker=1, processes=True, dashboard_address=None
    ) as made:
        yield ["--scheduler", made.scheduler_address]


@contextmanager
def processes(workers: int) -> Iterator[list[str]]:
    """Options for so many processes on this machine."""
    yield ["--workers", str(workers)]


def keep_bytecode(folder: Path) -> None:
    """Let all processes that are started from here on keep their bytecode below a folder."""
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    os.environ["PYTHONPYCACHEPREFIX"] = str(folder / "bytecode")
    with processes(PROCESSES[-1]) as options:
        measured(FEW_SWEEPS, options, folder / "first.zarr")


def at_once(sweeps: int, runs: int, folder: Path) -> tuple[dict[str, float], list[Path]]:
    """So many runs of one process beside each other: of all of them, and where each wrote."""
    outputs = [folder / f"beside-{k}.zarr" for k in range(runs)]
    with processes(1) as options, ThreadPoolExecutor(runs) as runners:
        told = list(runners.map(lambda output: measured(sweeps, options, output), outputs))
    return {key: max(each[key] for each in told) for key in told[0]}, outputs


def digest(folder: Path) -> str:
    """Of all paths and bytes below a folder."""
    found = sha256()
    for path in sorted(path for path in folder.rglob("*") if path.is_file()):
        found.update(str(path.relative_to(folder)).encode())
        found.update(path.read_bytes())
    return found.hexdigest()


def runs(
    sweeps: int, counts: tuple[int, ...], folder: Path
) -> Iterator[tuple[str, int, dict[str, float], list[Path]]]:
    """By what, by how many workers, what was measured, and where the data sets are."""
    output = folder / "out.zarr"
    kinds: dict[str, Callable] = {"processes": processes, "Dask cluster": cluster}
    for kind, made in kinds.items():
        for workers in counts:
            with made(workers) as options:
                yield kind, workers, measured(sweeps, options, output), [output]
        if kind == "processes":
            yield "two runs at once", 1, *at_once(sweeps, 2, folder)


def rows(sweeps: int, counts: tuple[int, ...], folder: Path) -> Iterator[dict[str, str]]:
    """A row of the table for each kind and number of workers."""
    found: set[str] = set()
    for kind, workers, run, outputs in runs(sweeps, counts, folder):
        found |= {digest(output) for output in outputs}
        if len(found) > 1:
            raise RuntimeError(f"{kind}: {workers} workers gave other bytes")
        made, files = sweeps * len(outputs), [p for output in outputs for p in output.rglob("*")]
        size = sum(path.stat().st_size for path in files if path.is_file())
        for output in outputs:
            shutil.rmtree(output)
        yield {
            "made by": kind,
            "workers": str(workers),
            "sweeps": f"{made:,}",
            "all of it (s)": f"{run['all']:.1f}",
            "of this until the model is trained (s)": f"{run['start']:.1f}",
            "sweeps a second after that": f"{made / (run['all'] - run['start']):,.0f}",
            "peak memory (MB)": f"{run['peak']:.0f}",
            "on disk (MB)": f"{size / MEGABYTE:.0f}",
        }


def main(run: Run) -> None:
    """Measure, check and publish."""
    sweeps = run.asked.sweeps or run.sized(SWEEPS, FEW_SWEEPS)
    counts = run.sized(PROCESSES, PROCESSES[1:])
    with run.kept() as folder:
        keep_bytecode(folder)
        table = list(rows(sweeps, counts, folder))
    title = f"Data sets of {SCENE} with readout noise: the same bytes each time"
    run.publish("dataset", title, table)


if __name__ == "__main__":
    launch(main, {"sweeps": {"nargs": "?", "type": int, "metavar": "SWEEPS"}})
