"""What every benchmark does: time, say on which machine, write a table."""

from __future__ import annotations

import os
import platform
import time
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path

import pandas as pd

RESULTS = Path(__file__).parent / "results"
PACKAGES = ("rcskin", "numpy", "scipy", "scikit-fem", "numba", "scikit-rf")


def best_time(work: Callable[[], object], repetitions: int = 7) -> float:
    """Shortest time of some runs in s, after one that is not counted."""
    work()
    times = []
    for _ in range(repetitions):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return min(times)


def machine() -> str:
    """Processor, Python and package versions, as one line."""
    packages = ", ".join(f"{name} {version(name)}" for name in PACKAGES)
    return f"{_processor()}, {os.cpu_count()} cores; Python {platform.python_version()}, {packages}"


def publish(name: str, title: str, table: pd.DataFrame) -> None:
    """Print a table and write it to `results/NAME.md` and `results/NAME.csv`."""
    header, *rows = [list(table.columns), *table.astype(str).to_numpy().tolist()]
    lines = [" | ".join(row) for row in [header, ["---"] * len(header), *rows]]
    text = "\n".join([f"# {title}", "", machine(), "", *(f"| {line} |" for line in lines), ""])
    RESULTS.mkdir(exist_ok=True)
    (RESULTS / f"{name}.md").write_text(text, encoding="utf-8")
    table.to_csv(RESULTS / f"{name}.csv", index=False, lineterminator="\n")
    print(text)


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    names = (line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    return next(names, platform.machine())
