"""What every benchmark does: read its options, time, say on which machine, write a table."""

from __future__ import annotations

import argparse
import os
import platform
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path
from shutil import which
from typing import Any, TypeVar

import pandas as pd
from rcskin.simulator.sweeps.output_files import replacing

HERE = Path(__file__).parent
RESULTS = HERE / "results"
Options = Mapping[str, Mapping[str, Any]]
Table = pd.DataFrame | Iterable[Mapping[str, object]]
PACKAGES = ("rcskin", "numpy", "scipy", "scikit-fem", "numba", "scikit-rf")

NOT_CODE = ":!benchmarks/results", ":!*.md", ":!*.jsonl"

LEAST, ENOUGH = 0.2, 1.0
"""Seconds to fill with at least three runs; seconds after which a run is not repeated."""

SKINS_OPTION: Options = {"--skins": {"type": int, "help": "twins in place of the usual number"}}
PROCESSES_OPTION: Options = {"--processes": {"type": int, "default": 2}}
SEARCHES_OPTION: Options = {
    "--searches": {"type": Path, "help": "folder of designs, shared with others"},
}
FOUND_OPTION: Options = {"--found": {"type": Path, "help": "folder that keeps what takes time"}}

Size = TypeVar("Size")
Answered = TypeVar("Answered")


@dataclass(frozen=True)
class Run:
    """A run of a benchmark. folder: for its pages; asked: the options of the command line.

    quick: the same code and checks on the smallest sizes that still tell something. Rivals that are
    not installed are left out of it, and it installs none.
    """

    quick: bool
    folder: Path
    asked: argparse.Namespace

    @property
    def results(self) -> Path:
        """For tables and charts."""
        return self.folder / "results"

    def publish(self, name: str, title: str, table: Table) -> None:
        """Print a table, or its rows, and write it to NAME.md and NAME.csv of the results."""
        publish(self.results, name, title, table)

    @contextmanager
    def kept(self, folder: Path | None = None) -> Iterator[Path]:
        """The folder that is asked for, which stays; one that does not, where none is."""
        with tempfile.TemporaryDirectory() as scratch:
            yield folder or Path(scratch)

    def sized(self, whole: Size, least: Size) -> Size:
        """What a quick pass does with less of."""
        return least if self.quick else whole

    def has(self, rival: str) -> bool:
        """Whether a module or program takes part; a run that is not quick cannot do without."""
        if not self.quick or find_spec(rival) is not None or which(rival) is not None:
            return True
        print(f"{rival} is not installed and left out")
        return False


def launch(main: Callable[[Run], int | None], options: Options | None = None) -> None:
    """Run a benchmark as the command line asks and exit with the code that it returns.

    options: of the command line, what `add_argument` takes by the names of each. Ctrl-C reaches the
    commands that it starts, also where a shell started it in the background.
    """
    signal.signal(signal.SIGINT, signal.default_int_handler)
    parser = argparse.ArgumentParser()
    for names, keywords in (options or {}).items():
        parser.add_argument(*names.split(), **keywords)
    parser.add_argument(
        "--quick", action="store_true", help="smallest sizes, same checks, no figures kept"
    )
    parser.add_argument(
        "--into", type=Path, metavar="FOLDER", help="for pages and results/ in place of benchmarks/"
    )
    asked = parser.parse_args()
    if asked.quick and asked.into is not None and asked.into.resolve() == HERE.resolve():
        parser.error("figures of a quick pass do not belong into benchmarks/")
    with tempfile.TemporaryDirectory() as scratch:
        folder = asked.into or (Path(scratch) if asked.quick else HERE)
        run = Run(asked.quick, folder, asked)
        run.results.mkdir(parents=True, exist_ok=True)
        with replacing():
            sys.exit(main(run))


def best_time(work: Callable[[], object], repetitions: int = 7) -> float:
    """Shortest time of some runs in s, after one that is not counted."""
    work()
    times = []
    for _ in range(repetitions):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return min(times)


def timed(work: Callable[[], Answered]) -> tuple[float, Answered]:
    """Shortest time in s of as many runs as fill LEAST, or of one that is long, and the answer."""
    times = []
    while True:
        start = time.perf_counter()
        answer = work()
        times.append(time.perf_counter() - start)
        if sum(times) > (LEAST if len(times) >= 3 else ENOUGH):
            return min(times), answer


def machine(*more: str) -> str:
    """Processor, Python, versions and commit, as one line. more: packages besides the usual."""
    packages = ", ".join(f"{name} {_version(name)}" for name in (*PACKAGES, *more))
    python = platform.python_version()
    return f"{_processor()}, {os.cpu_count()} cores; Python {python}, {packages}; commit {commit()}"


def commit() -> str:
    """Of the code, short; marked where files differ from it that are no results or pages."""
    told = _git("rev-parse", "--short=9", "HEAD")
    return "unknown" if told is None else told.strip() + _changes()


def code() -> str:
    """What runs, in short: the same for commits that differ in pages, results and tests alone."""
    told = _git("ls-files", "--stage", "--", *NOT_CODE, ":!tests")
    return "unknown" if told is None else sha256(told.encode()).hexdigest()[:9] + _changes()


def _changes() -> str:
    return " and changes" if _git("status", "--porcelain", "--", *NOT_CODE) else ""


def _git(*command: str) -> str | None:
    """What it prints at the root; None where this is no repository, or there is no git."""
    asked = ["git", "-C", str(HERE.parent), *command]
    try:
        return subprocess.run(asked, capture_output=True, text=True, check=True).stdout
    except (OSError, subprocess.CalledProcessError):
        return None


def rcskin_command(*words: object) -> list[str]:
    """The words of a command of rcskin, for a process of its own."""
    return [sys.executable, "-m", "rcskin", *map(str, words)]


def run_rcskin(*words: object) -> None:
    """Run a command of rcskin to its end. Raises CalledProcessError where it fails."""
    subprocess.run(rcskin_command(*words), check=True, stdout=subprocess.DEVNULL)


@contextmanager
def served(scene: object) -> Iterator[tuple[str, str]]:
    """The VISA resource and the control port of a virtual meter, a process of its own."""
    words = rcskin_command("meter", "serve", "--scene", scene, "--port", 0, "--control-port", 0)
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as meter:
        assert meter.stdout is not None
        resource, _, control = meter.stdout.readline().split()
        try:
            yield resource, control
        finally:
            meter.send_signal(signal.SIGINT)


def publish(folder: Path, name: str, title: str, table: Table) -> None:
    """Print a table, or its rows, and write it to NAME.md and NAME.csv."""
    table = table if isinstance(table, pd.DataFrame) else pd.DataFrame(list(table))
    header, *rows = [list(table.columns), *table.astype(str).to_numpy().tolist()]
    lines = [" | ".join(row) for row in [header, ["---"] * len(header), *rows]]
    text = "\n".join([f"# {title}", "", machine(), "", *(f"| {line} |" for line in lines), ""])
    (folder / f"{name}.md").write_text(text, encoding="utf-8")
    table.to_csv(folder / f"{name}.csv", index=False, lineterminator="\n")
    print(text)


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "absent"


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    names = (line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    return next(names, platform.machine())
