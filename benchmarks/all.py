"""Every benchmark that the pages quote, and whether the pages are up to date.

Those that measure times by the clock run first and alone, the others three at a time,
since some wait for a meter or for one another. A benchmark that ended well is noted with its times
in `results/all.csv`, and is not run again by the same code (commits that differ in pages, results
and tests alone have the same): what was stopped goes on, long ones from what they keep in
`results/CODE` at the root. A quick pass runs every script on its smallest sizes, keeps none of
their figures, and notes its times in `results/quick.csv` there. That folder is no part of the
repository. Ends with code 1 where a benchmark fails or a page quotes another table than the one
that was written.

Run: python benchmarks/all.py [--quick] [--only FOLDER/NAME] [--again]
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import time
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from pathlib import Path
from typing import NamedTuple

import pandas as pd
from rcskin.benchmarks.bench import HERE, RESULTS, code, publish
from rcskin.benchmarks.quoted import differing

UNPUBLISHED = HERE.parent / "results"
NOTED = RESULTS / "all.csv"
NOTED_QUICKLY = UNPUBLISHED / "quick.csv"
TITLE = "Run time of each benchmark"
AT_A_TIME = 3
CAMPAIGN = "accuracy/campaign"
SEARCHES = "--searches", "searches"
"""Option and name of the folder of designs, which lets one that is searched be awaited."""

OF_SHEET = "--skin", "sheet", "--twins", "100"


class Benchmark(NamedTuple):
    """A script and its options.

    quick: those of its quick pass. kept: the option, and the name, of what it keeps to go on from.
    shared: the same of what others may use while it runs. alone: it measures times by the clock, so
    that nothing runs beside it; times of the processor are the same beside others. needs: the name
    of those whose results it tells of, which have to end before it.
    """

    name: str
    options: tuple[str, ...] = ()
    quick: tuple[str, ...] = ()
    kept: tuple[str, str] | None = None
    shared: tuple[str, str] | None = None
    alone: bool = False
    needs: str | None = None

    @property
    def script(self) -> Path:
        """The file."""
        return HERE / f"{self.name}.py"


def _alone(name: str) -> Benchmark:
    return Benchmark(name, alone=True)


def _campaign(name: str, *options: str) -> Benchmark:
    return Benchmark(CAMPAIGN, options, kept=("-o", f"{name}.jsonl"))


def _designed(target: str, *options: str) -> Benchmark:
    """A design; what is asked of others of its twins goes on from what its own keep."""
    asked, others = ("--target", target), tuple(each for each in options if each == "--others")
    kept = "-".join(["designed", target, *(each for each in options if each not in others)])
    return Benchmark(
        "localization/twin_design",
        (*asked, *options),
        (*asked, *others),
        ("--found", kept),
        SEARCHES,
    )


IN_ORDER = (
    _alone("speed/assembly"),
    _alone("speed/work_precision"),
    _alone("speed/answers"),
    _alone("speed/reduction"),
    _alone("speed/skins"),
    _alone("speed/skins_reduced"),
    _alone("speed/sensor"),
    _alone("localization/torch_training"),
    _alone("scale/dataset"),
    _alone("scale/cluster"),
    Benchmark("scale/training"),
    _alone("live/live_page"),
    _alone("pictures/page"),
    _alone("commands"),
    Benchmark("localization/twin"),
    _campaign("campaign", "--timeout", "60"),
    Benchmark("localization/design_goals", shared=SEARCHES),
    _designed("pixel"),
    _designed("pixel", "--second"),
    _designed("position"),
    _designed("pair"),
    _campaign("in_turn", "--in-turn", "--timeout", "25"),
    Benchmark("localization/twin_limits"),
    Benchmark("accuracy/calibration_coverage", ("--prior", "wide", *OF_SHEET)),
    Benchmark("accuracy/calibration_coverage", ("--prior", "wide")),
    _designed("column"),
    Benchmark("localization/design"),
    Benchmark("localization/training_spread"),
    Benchmark("localization/fingers"),
    Benchmark("localization/faults"),
    Benchmark("localization/foreign_twin", kept=("--found", "foreign_twin"), shared=SEARCHES),
    Benchmark("localization/multisine"),
    Benchmark("localization/adaptation"),
    Benchmark("localization/localizers"),
    Benchmark("localization/filtering"),
    Benchmark("accuracy/verification", needs=CAMPAIGN),
    _designed("pixel", "--others"),
    Benchmark("accuracy/stability"),
    Benchmark("localization/several_touches"),
    Benchmark("accuracy/three_dimensions"),
    Benchmark("accuracy/uneven_calibration"),
    Benchmark("accuracy/calibration_coverage", ("--prior", "wide", "--truth", "scene", *OF_SHEET)),
    Benchmark("accuracy/calibration_coverage"),
    Benchmark("accuracy/calibration_coverage", ("--outliers", "2", "--twins", "100")),
    Benchmark("measured/lines"),
    Benchmark("measured/meters"),
    Benchmark("pictures/gallery"),
    Benchmark("localization/choosing"),
    Benchmark("pictures/commands"),
    Benchmark("localization/class_zero"),
    Benchmark("pictures/wiring"),
)


class Times(NamedTuple):
    """Of a benchmark: s on the clock, s of all its processes, and its exit code."""

    clock: float
    processor: float
    code: int


def timed(command: Sequence[str], folder: Path = HERE.parent) -> Times:
    """Run a command in a folder, on one thread for each process."""
    start = time.perf_counter()
    process = subprocess.Popen(command, cwd=folder, env={**os.environ, "OMP_NUM_THREADS": "1"})
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    clock = time.perf_counter() - start
    return Times(clock, used.ru_utime + used.ru_stime, process.returncode)


def command_of(benchmark: Benchmark, quick: bool) -> list[str]:
    """Its command line."""
    words = [sys.executable, str(benchmark.script)]
    if quick:
        return [*words, "--quick", *benchmark.quick]
    folder = UNPUBLISHED / code().replace(" ", "-")
    kept = [each for each in (benchmark.kept, benchmark.shared) if each is not None]
    if kept:
        folder.mkdir(parents=True, exist_ok=True)
    told = [word for option, name in kept for word in (option, str(folder / name))]
    return [*words, *benchmark.options, *told]


def run(benchmarks: Sequence[Benchmark], quick: bool) -> Iterator[tuple[Benchmark, Times]]:
    """Benchmarks and their times, as they end: first those that run alone.

    None is started before there is room for it, so that Ctrl-C ends those that run and no other
    begins.
    """
    for many, alone in (1, True), (AT_A_TIME, False):
        left = [each for each in benchmarks if each.alone is alone]
        busy: dict[Future[Times], Benchmark] = {}
        with ThreadPoolExecutor(many) as runners:
            while left or busy:
                while len(busy) < many and (started := next_of(left, busy.values())):
                    left.remove(started)
                    busy[runners.submit(timed, command_of(started, quick))] = started
                for ended in wait(busy, return_when=FIRST_COMPLETED).done:
                    yield busy.pop(ended), ended.result()


def next_of(left: Sequence[Benchmark], busy: Iterable[Benchmark]) -> Benchmark | None:
    """The first that needs no other of them, and keeps nothing where a busy one does: what one made
    there serves the other."""
    busy = list(busy)
    taken = [each.kept for each in busy if each.kept is not None]
    waited_for = {each.name for each in (*left, *busy)}
    ready = (each for each in left if each.needs not in waited_for)
    return next((each for each in ready if each.kept not in taken), None)


def name_of(benchmark: Benchmark, quick: bool) -> str:
    """By which it is told and noted; quick passes of the same options are one."""
    return " ".join([benchmark.name, *(benchmark.quick if quick else benchmark.options)])


def noted(path: Path) -> pd.DataFrame:
    """Benchmarks that ended well by this code."""
    if not path.exists():
        return pd.DataFrame(columns=["benchmark", "clock (s)", "processor (s)", "code"])
    there = pd.read_csv(path, dtype=str)
    return there[there["code"] == code()]


def _row(name: str, times: Times) -> dict[str, str]:
    return {
        "benchmark": name,
        "clock (s)": f"{times.clock:.0f}",
        "processor (s)": f"{times.processor:.0f}",
        "code": code(),
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
    known = set(() if asked.again else done["benchmark"])
    named = {name_of(each, asked.quick): each for each in IN_ORDER}
    left = [
        each
        for name, each in named.items()
        if name not in known and asked.only in (None, each.name)
    ]
    failed = []
    for benchmark, times in run(left, asked.quick):
        name = name_of(benchmark, asked.quick)
        print(f"== {name}: {times.clock:.0f} s, code {times.code}", flush=True)
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
