"""Every benchmark that the pages quote, one after the other, and whether the pages are up to date.

A benchmark that ended well is noted with its times in `results/all.csv`, and is not run again on
the same commit: what was stopped goes on. A quick pass runs every script on its smallest sizes,
keeps none of their figures, and notes its times in `results/quick.csv` at the root, which is no
part of the repository. Ends with code 1 where a benchmark fails or a page quotes another table than
the one that was written.

Run: python benchmarks/all.py [--quick] [--only FOLDER/NAME] [--again]
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import pandas as pd
from rcskin.benchmarks.bench import HERE, RESULTS, commit, publish
from rcskin.benchmarks.quoted import differing

NOTED = RESULTS / "all.csv"
NOTED_QUICKLY = HERE.parent / "results" / "quick.csv"
TITLE = "Every benchmark: how long it took"
LINES, LINES_IN_TURN = "campaign.jsonl", "in_turn.jsonl"
"""Of campaigns, which go on where they were stopped; beside the pages."""


class Benchmark(NamedTuple):
    """A script and its options; quick: those of its quick pass."""

    name: str
    options: tuple[str, ...] = ()
    quick: tuple[str, ...] = ()

    @property
    def script(self) -> Path:
        """The file."""
        return HERE / f"{self.name}.py"


IN_ORDER = (
    Benchmark("speed/assembly"),
    Benchmark("speed/work_precision"),
    Benchmark("speed/answers"),
    Benchmark("speed/reduction"),
    Benchmark("speed/skins"),
    Benchmark("speed/skins_reduced"),
    Benchmark("speed/skins_commands"),
    Benchmark("accuracy/stability"),
    Benchmark("accuracy/campaign", ("-o", LINES, "--workers", "2", "--timeout", "60")),
    Benchmark(
        "accuracy/campaign",
        ("-o", LINES_IN_TURN, "--in-turn", "--workers", "2", "--timeout", "25"),
    ),
    Benchmark("accuracy/verification"),
    Benchmark("accuracy/calibration_coverage"),
    Benchmark("accuracy/calibration_coverage", ("--prior", "wide", "--twins", "200")),
    Benchmark("accuracy/uneven_calibration"),
    Benchmark("scale/dataset"),
    Benchmark("scale/cluster"),
    Benchmark("scale/training"),
    Benchmark("localization/class_zero"),
    Benchmark("localization/localizers"),
    Benchmark("localization/twin"),
    Benchmark("localization/twin_limits"),
    Benchmark("localization/twin_design"),
    Benchmark("localization/twin_design", ("--second",)),
    Benchmark("localization/twin_design", ("--target", "column"), ("--target", "column")),
    Benchmark("localization/twin_design", ("--target", "position"), ("--target", "position")),
    Benchmark("localization/twin_design", ("--target", "pair"), ("--target", "pair")),
    Benchmark("localization/twin_design_others"),
    Benchmark("localization/design_goals"),
    Benchmark("localization/design"),
    Benchmark("localization/training_spread"),
    Benchmark("localization/adaptation"),
    Benchmark("localization/filtering"),
    Benchmark("localization/several_touches"),
    Benchmark("localization/choosing"),
    Benchmark("live/live_interfaces"),
    Benchmark("live/live_page"),
    Benchmark("live/killed"),
    Benchmark("pictures/gallery"),
    Benchmark("pictures/page"),
    Benchmark("pictures/wiring"),
)


class Times(NamedTuple):
    """Of a benchmark: s on the clock, s of all its processes, and its exit code."""

    clock: float
    processor: float
    code: int


def timed(command: Sequence[str], folder: Path = HERE.parent) -> Times:
    """Run a command in a folder, on one thread for each process."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    surroundings = {**os.environ, "OMP_NUM_THREADS": "1"}
    code = subprocess.run(command, cwd=folder, env=surroundings).returncode
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return Times(time.perf_counter() - start, used, code)


def command_of(benchmark: Benchmark, quick: bool) -> list[str]:
    """Its command line."""
    own = ("--quick", *benchmark.quick) if quick else benchmark.options
    return [sys.executable, str(benchmark.script), *own]


def noted(path: Path) -> pd.DataFrame:
    """Benchmarks that ended well on this commit."""
    if not path.exists():
        return pd.DataFrame(columns=["benchmark", "clock (s)", "processor (s)", "commit"])
    there = pd.read_csv(path, dtype=str)
    return there[there["commit"] == commit()]


def _row(name: str, times: Times) -> dict[str, str]:
    return {
        "benchmark": name,
        "clock (s)": f"{times.clock:.0f}",
        "processor (s)": f"{times.processor:.0f}",
        "commit": commit(),
    }


def main() -> int:
    """Run what is asked for; returns the exit code."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--quick", action="store_true", help="smallest sizes, no figures kept")
    parser.add_argument("--only", metavar="FOLDER/NAME", help="one of them")
    parser.add_argument("--again", action="store_true", help="also what has ended well")
    asked = parser.parse_args()
    path = NOTED_QUICKLY if asked.quick else NOTED
    path.parent.mkdir(exist_ok=True)
    done = noted(path)
    known, failed = set(() if asked.again else done["benchmark"]), []
    for benchmark in IN_ORDER:
        name = " ".join([benchmark.name, *(benchmark.quick if asked.quick else benchmark.options)])
        if name in known or asked.only not in (None, benchmark.name):
            continue
        print(f"== {name}", flush=True)
        times = timed(command_of(benchmark, asked.quick))
        print(f"== {name}: {times.clock:.0f} s, code {times.code}", flush=True)
        known.add(name)
        if times.code:
            failed.append(name)
        else:
            others = done[done["benchmark"] != name]
            done = pd.concat([others, pd.DataFrame([_row(name, times)])])
            publish(path.parent, path.stem, TITLE, done)
    stale = [quote.told() for quote in differing()]
    for told in stale:
        print(f"another table was written: {told}")
    for name in failed:
        print(f"failed: {name}")
    return int(bool(failed or stale))


if __name__ == "__main__":
    sys.exit(main())
