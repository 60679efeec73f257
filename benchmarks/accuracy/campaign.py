"""Answers further off than their tolerance or estimate, on random scenes of every kind.

Run: python benchmarks/accuracy/campaign.py -o LINES [--in-turn] [--kinds KIND,KIND] [--seeds A:B]
     [--workers N]

Each scene is answered at a tolerance drawn with it, and by another route that shares no mesh with
the first: the same skin described in another way, polygons for discs, a formula, or a finer file.
Verdicts go to LINES as they come, so that a campaign that was ended goes on where it was if the
code is the same. One of all kinds and SEEDS ends in results/campaign.csv, one --in-turn, of the
kinds that are no even rectangles, one scene each at 1e-3, 1e-4 and 1e-5, in
results/campaign_in_turn.csv; verification.py reports on both.
"""

from __future__ import annotations

import argparse
import json
import math
import multiprocessing
import resource
import signal
import sys
import time
import traceback
from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict, dataclass, replace
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Literal

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from rcskin.benchmarks.accuracy import campaign_kinds, campaign_outlines
from rcskin.benchmarks.accuracy.campaign_scenes import Case, Rng, Truth
from rcskin.benchmarks.bench import Run, commit, launch
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.models.solution import Solution
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.scene.scene_files import scene_text
from rcskin.simulator.sweeps import InputError, ToleranceError, whole_file
from threadpoolctl import threadpool_limits

OF_ALL = (
    campaign_kinds.rectangles,
    campaign_kinds.discs,
    campaign_kinds.polygons,
    campaign_kinds.foils,
    campaign_kinds.films,
    campaign_kinds.one_sheet,
    campaign_kinds.lossy,
    campaign_kinds.behind_leads,
    campaign_kinds.of_varied_elements,
    campaign_kinds.anisotropic,
    campaign_kinds.anisotropic_touched_anyhow,
    campaign_kinds.gauges,
    campaign_kinds.gauges_touched_anyhow,
    campaign_kinds.gradients_and_random_fields,
    campaign_kinds.grids,
    campaign_kinds.maps_touched_anyhow,
    campaign_kinds.stretched,
    campaign_kinds.stretched_and_varied,
    campaign_kinds.draped,
    campaign_kinds.depths,
    campaign_kinds.forces,
    campaign_kinds.spread_depths,
    campaign_kinds.spread_forces,
    campaign_kinds.gauges_under_depths,
    campaign_kinds.overlapping_depths,
    campaign_kinds.spread_pairs,
    campaign_outlines.fed_all_around,
    campaign_outlines.fed_along_arcs,
    campaign_outlines.holes,
    campaign_outlines.discs_cut_by_the_edge,
    campaign_outlines.outlines,
    campaign_outlines.rectangles_from_files,
    campaign_outlines.ls_from_files,
    campaign_outlines.annuli_from_files,
    campaign_outlines.bent_from_files,
    campaign_outlines.curved_from_files,
)
KINDS: dict[str, Callable[[Rng], Case]] = {each.__name__.replace("_", "-"): each for each in OF_ALL}
EVEN = ("rectangles", "foils", "films", "one-sheet", "lossy", "behind-leads")
"""Kinds of rectangles with even sheets and foam, touched by rectangles."""
NOT_EVEN = tuple(name for name in KINDS if name not in EVEN)

KNOWN = 0.2
"""Largest uncertainty of the true error, over it or the estimate, for their ratio to count."""
Outcome = Literal["judged", "refused", "not judged", "failed"]
Values = list[list[list[float]]]


@dataclass(frozen=True)
class Verdict:
    """What became of one case.

    reason: why it was not judged. frequency: Hz. true, estimated, uncertain: relative errors of Rs
    and of Cp, shape (2, interface, frequency): against the reference, as the answer estimates them,
    and of the reference.
    seconds: of a processor, to the answer, and to the reference.
    """

    kind: str
    seed: int
    rtol: float
    outcome: Outcome
    reason: str = ""
    model: str = ""
    frequency: tuple[float, ...] = ()
    true: Values | None = None
    estimated: Values | None = None
    uncertain: Values | None = None
    seconds: tuple[float, float] = (0.0, 0.0)

    def record(self) -> dict[str, object]:
        """As JSON has it."""
        return asdict(self)

    @property
    def errors(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """True, estimated and uncertain, each of shape (2, interface, frequency)."""
        assert self.true is not None and self.estimated is not None and self.uncertain is not None
        return np.array(self.true), np.array(self.estimated), np.array(self.uncertain)

    @property
    def broken(self) -> bool:
        """Whether an error exceeds the tolerance by more than the reference is uncertain."""
        if self.outcome != "judged":
            return False
        true, _, uncertain = self.errors
        return bool((true - uncertain > self.rtol).any())

    @property
    def underestimated(self) -> bool:
        """Whether an error exceeds its estimate by more than the reference is uncertain."""
        if self.outcome != "judged":
            return False
        true, estimated, uncertain = self.errors
        return bool((true - uncertain > estimated).any())

    @property
    def ratios(self) -> NDArray[np.float64]:
        """True over estimated errors where the reference is sure enough, or shows the estimate too
        small."""
        if self.outcome != "judged":
            return np.empty(0)
        true, estimated, uncertain = self.errors
        sure = uncertain <= KNOWN * np.maximum(true, estimated)
        return (true / estimated)[sure | (true - uncertain > estimated)]

    @property
    def overstated(self) -> float:
        """Largest estimate over the largest true error; nan if the reference is less sure."""
        if self.outcome != "judged":
            return np.nan
        true, estimated, uncertain = self.errors
        return float(estimated.max() / true.max()) if uncertain.max() < true.max() else np.nan

    def line(self) -> str:
        """For people: what is wrong, and how to have it again."""
        named = f"{self.kind} seed {self.seed} rtol {self.rtol:g}"
        if self.outcome != "judged":
            return f"{self.outcome}: {named}: {self.reason}"
        true, estimated, uncertain = self.errors
        worst = ((true - uncertain) / estimated).argmax()
        name, interface, f = (int(k) for k in np.unravel_index(worst, true.shape))
        said = "broken" if self.broken else "above its estimate" if self.underestimated else "kept"
        return (
            f"{said}: {named}: {('Rs', 'Cp')[name]} off by {true[name, interface, f]:.2e}, "
            f"estimate {estimated[name, interface, f]:.2e}, at {self.frequency[f]:.6g} Hz; at most "
            f"{true.max():.2e}, by {self.model}"
        )


DOUBT = 0.25
"""Of the tolerance: a reference that is less sure is none."""
IN_TURN, FIRST_IN_TURN = (1e-3, 1e-4, 1e-5), 100
"""Tolerances that scenes are asked for in turn, from that seed on."""


def drawn(kind: str, seed: int) -> Case:
    """The case that a kind and a seed are, always the same."""
    case = KINDS[kind](np.random.default_rng([*kind.encode(), seed]))
    if seed < FIRST_IN_TURN:
        return case
    return replace(case, rtol=IN_TURN[(seed - FIRST_IN_TURN) % len(IN_TURN)])


def judged(kind: str, seed: int) -> Verdict:
    """Answer a case and its reference, and compare them. Raises nothing."""
    rtol = 0.0
    try:
        case = drawn(kind, seed)
        rtol = case.rtol
        return _compared(kind, seed, case)
    except Exception as error:
        where = traceback.extract_tb(error.__traceback__)[-1]
        reason = f"{type(error).__name__} in {where.name}: {' '.join(str(error).split())}"
        return Verdict(kind, seed, rtol, "failed", reason)


def _compared(kind: str, seed: int, case: Case) -> Verdict:
    start = time.process_time()
    try:
        answer = Solver(case.problem.scene.parts, case.rtol).solve(case.problem.press)
    except (ToleranceError, InputError) as error:
        return Verdict(kind, seed, case.rtol, "refused", str(error))
    answered = time.process_time() - start
    try:
        truth = case.route(case.rtol)
    except (ToleranceError, InputError) as error:
        return Verdict(kind, seed, case.rtol, "not judged", f"no reference: {error}")
    seconds = round(answered, 2), round(time.process_time() - start - answered, 2)
    return _held(kind, seed, case.rtol, answer, truth, seconds)


def _held(
    kind: str, seed: int, rtol: float, answer: Solution, truth: Truth, seconds: tuple[float, float]
) -> Verdict:
    true = relative_difference(answer.Z, truth.Z)
    estimated = np.stack(answer.relative_errors)
    sure = truth.doubt.max() <= DOUBT * rtol
    return Verdict(
        kind,
        seed,
        rtol,
        "judged" if sure else "not judged",
        "" if sure else f"the reference is off by up to {truth.doubt.max():.1e}",
        answer.model,
        tuple(answer.frequency.tolist()),
        _rounded(true),
        _rounded(estimated),
        _rounded(truth.doubt),
        seconds,
    )


def _rounded(values: NDArray[np.float64]) -> Values:
    return [[[float(f"{x:.3g}") for x in line] for line in part] for part in values]


Named = tuple[str, int]
_spawn = multiprocessing.get_context("spawn")


def verdicts(cases: Iterable[Named], workers: int, timeout: float) -> Iterator[Verdict]:
    """Of cases by kind and seed, as they end; `timeout`: seconds of a processor for each."""
    left = iter(cases)
    busy = [worker for worker in (Worker(timeout) for _ in range(workers)) if worker.took(left)]
    try:
        while busy:
            ready = wait([worker.answers for worker in busy])
            for worker in [each for each in busy if each.answers in ready]:
                yield worker.verdict()
                if not worker.took(left):
                    busy.remove(worker)
    finally:
        for worker in busy:
            worker.stop()


class Worker:
    """A process that judges one case after the other, and is replaced where it takes too long."""

    def __init__(self, timeout: float) -> None:
        self._timeout, self._case = timeout, ("", 0)
        self._start()

    def took(self, left: Iterator[Named]) -> bool:
        """Whether there was another case to begin with; the process ends where there was none."""
        following = next(left, None)
        if following is None:
            self.stop()
            return False
        self._case = following
        self.answers.send(following)
        return True

    def verdict(self) -> Verdict:
        """What became of the case; waits for it."""
        try:
            return self.answers.recv()
        except EOFError:
            self._process.join()
        late = self._process.exitcode == -signal.SIGXCPU
        self._start()
        kind, seed = self._case
        rtol = drawn(kind, seed).rtol
        if late:
            reason = f"took longer than {self._timeout:g} s"
            return Verdict(kind, seed, rtol, "not judged", reason)
        return Verdict(
            kind, seed, rtol, "failed", f"the process ended with code {self._process.exitcode}"
        )

    def stop(self) -> None:
        """End the process."""
        self._process.kill()
        self._process.join()

    def _start(self) -> None:
        self.answers, theirs = _spawn.Pipe()
        self._process = _spawn.Process(target=_judge, args=(theirs, self._timeout), daemon=True)
        self._process.start()
        theirs.close()


def _judge(questions: Connection, timeout: float) -> None:
    """Until the other end closes; on one thread."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    most = resource.getrlimit(resource.RLIMIT_CPU)[1]
    with threadpool_limits(1):
        while True:
            try:
                kind, seed = questions.recv()
            except (EOFError, KeyboardInterrupt):
                return
            until = math.ceil(time.process_time() + timeout)
            resource.setrlimit(resource.RLIMIT_CPU, (until, most))
            questions.send(judged(kind, seed))


COLUMNS = ("kind", "seed", "rtol", "outcome", "reason", "model", "seconds")
ERRORS = ("true", "estimated", "uncertain")


def read(path: Path, commit: str) -> Iterator[Verdict]:
    """The verdicts of a file on the code of a commit, of each case the last.

    A last line that was cut short is left out.
    """
    found: dict[tuple[str, int], Verdict] = {}
    for line in path.read_text(encoding="utf-8").splitlines() if path.exists() else ():
        try:
            record = json.loads(line)
        except json.JSONDecodeError:
            continue
        if record.pop("commit", None) == commit:
            found[record["kind"], record["seed"]] = Verdict(**record)
    yield from found.values()


def appended(path: Path, verdict: Verdict, commit: str) -> None:
    """One more line."""
    with path.open("a", encoding="utf-8") as lines:
        lines.write(json.dumps({**verdict.record(), "commit": commit}) + "\n")


def write_table(path: Path, verdicts: Iterable[Verdict]) -> None:
    """One line of CSV for each; numbers of one cell by Rs and Cp, interface and frequency."""
    rows = []
    for each in verdicts:
        row: dict[str, object] = {name: getattr(each, name) for name in COLUMNS}
        row["seconds"] = " ".join(f"{x:g}" for x in each.seconds)
        row["frequency"] = " ".join(f"{f:.6g}" for f in each.frequency)
        for name in ERRORS:
            values = getattr(each, name)
            row[name] = "" if values is None else _joined(values)
        rows.append(row)
    table = pd.DataFrame(rows).sort_values(["kind", "seed"])
    with whole_file(path) as unfinished:
        table.to_csv(unfinished, index=False, lineterminator="\n")


def published(path: Path) -> list[Verdict]:
    """The verdicts of such a table."""
    text = {name: str for name in ("reason", "model", "seconds", "frequency", *ERRORS)}
    table = pd.read_csv(path, dtype=text, keep_default_na=False)
    return [_verdict(row) for row in table.to_dict("records")]


def _verdict(row: dict) -> Verdict:
    numbers = {name: tuple(map(float, row[name].split())) for name in ("frequency", "seconds")}
    errors = {name: _parted(row[name]) if row[name] else None for name in ERRORS}
    return Verdict(**(row | numbers | errors))


def _joined(values: list) -> str:
    return " ".join(f"{x:.3g}" for x in np.ravel(values))


def _parted(text: str) -> list:
    """One interface."""
    return np.reshape(np.array(text.split(), dtype=float), (2, 1, -1)).tolist()


SEEDS, SEEDS_IN_TURN = range(6), range(FIRST_IN_TURN, FIRST_IN_TURN + len(IN_TURN))
TIMEOUT = 90.0
TABLES = {"campaign.csv": (KINDS, SEEDS), "campaign_in_turn.csv": (NOT_EVEN, SEEDS_IN_TURN)}
QUICK = (
    ("foils", 0),
    ("films", 0),
)
"""Scenes of a second."""


def main(run: Run) -> int:
    """Judge what is not judged yet; 1 where a tolerance is broken or anything fails."""
    asked = run.asked
    kinds, seeds = TABLES["campaign_in_turn.csv" if asked.in_turn else "campaign.csv"]
    cases = [(kind, seed) for seed in asked.seeds or seeds for kind in asked.kinds or kinds]
    cases = run.sized(cases, list(QUICK))
    if asked.show:
        return shown(cases)
    lines = asked.output or run.folder / "campaign.jsonl"
    code = commit()
    known = {(each.kind, each.seed): each for each in read(lines, code)}
    left = [case for case in cases if case not in known]
    start = time.perf_counter()
    for count, verdict in enumerate(verdicts(left, asked.workers, asked.timeout), 1):
        appended(lines, verdict, code)
        known[verdict.kind, verdict.seed] = verdict
        report(verdict)
        print(f"{count} of {len(left)}, {time.perf_counter() - start:.0f} s", file=sys.stderr)
    found = [known[case] for case in cases]
    for table, (kinds, seeds) in TABLES.items():
        if run.quick or set(cases) == {(kind, seed) for kind in kinds for seed in seeds}:
            write_table(run.results / table, found)
    print(summary(found))
    return int(any(each.broken or each.outcome == "failed" for each in found))


def report(verdict: Verdict) -> None:
    """One line of what is wrong; how the others went beside it."""
    wrong = verdict.broken or verdict.underestimated or verdict.outcome == "failed"
    print(verdict.line(), file=sys.stdout if wrong else sys.stderr, flush=True)


def summary(found: list[Verdict]) -> str:
    """How many of each outcome."""
    counts = {
        "judged": sum(each.outcome == "judged" for each in found),
        "broke their tolerance": sum(each.broken for each in found),
        "further off than estimated": sum(each.underestimated for each in found),
        "not judged": sum(each.outcome == "not judged" for each in found),
        "refused": sum(each.outcome == "refused" for each in found),
        "failed": sum(each.outcome == "failed" for each in found),
    }
    return ", ".join(f"{count} {name}" for name, count in counts.items())


def shown(cases: list[tuple[str, int]]) -> int:
    """The scenes, with what to press and to ask."""
    for kind, seed in cases:
        case = drawn(kind, seed)
        print(f"# {kind} seed {seed}: --press '{case.problem.press}' --rtol {case.rtol:g}")
        print(scene_text(case.problem.scene))
    return 0


def _kinds(text: str) -> list[str]:
    names = text.split(",")
    for name in names:
        if name not in KINDS:
            raise argparse.ArgumentTypeError(f"no kind {name!r}; there are {', '.join(KINDS)}")
    return names


def _seeds(text: str) -> range:
    first, last = map(int, text.split(":"))
    return range(first, last)


if __name__ == "__main__":
    launch(
        main,
        {
            "-o --output": {
                "type": Path,
                "help": "lines of JSON, continued; campaign.jsonl beside results/",
            },
            "--in-turn": {
                "action": "store_true",
                "help": "no even rectangles; at 1e-3, 1e-4, 1e-5 in turn",
            },
            "--kinds": {"type": _kinds, "help": ", ".join(KINDS)},
            "--seeds": {"type": _seeds, "help": "A:B, B not among them"},
            "--workers": {"type": int, "default": 1},
            "--timeout": {"type": float, "default": TIMEOUT, "help": "s of a processor a scene"},
            "--show": {"action": "store_true", "help": "print the scenes instead"},
        },
    )
