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
import sys
import time
from pathlib import Path

from rcskin.benchmarks.accuracy.campaign_parts import record
from rcskin.benchmarks.accuracy.campaign_parts.judging import FIRST_IN_TURN, IN_TURN, drawn
from rcskin.benchmarks.accuracy.campaign_parts.kinds import KINDS, NOT_EVEN
from rcskin.benchmarks.accuracy.campaign_parts.running import verdicts
from rcskin.benchmarks.accuracy.campaign_parts.verdict import Verdict
from rcskin.benchmarks.bench import Run, commit, launch
from rcskin.simulator.scene.scene_files import scene_text

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
    known = {(each.kind, each.seed): each for each in record.read(lines, code)}
    left = [case for case in cases if case not in known]
    start = time.perf_counter()
    for count, verdict in enumerate(verdicts(left, asked.workers, asked.timeout), 1):
        record.appended(lines, verdict, code)
        known[verdict.kind, verdict.seed] = verdict
        report(verdict)
        print(f"{count} of {len(left)}, {time.perf_counter() - start:.0f} s", file=sys.stderr)
    found = [known[case] for case in cases]
    for table, (kinds, seeds) in TABLES.items():
        if run.quick or set(cases) == {(kind, seed) for kind in kinds for seed in seeds}:
            record.publish(run.results / table, found)
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


def options() -> argparse.ArgumentParser:
    """Of the command line, beside those of all benchmarks."""
    parser = argparse.ArgumentParser(description="Campaign of scenes drawn at random.")
    parser.add_argument(
        "-o", "--output", type=Path, help="lines of JSON, continued; campaign.jsonl beside results/"
    )
    parser.add_argument(
        "--in-turn", action="store_true", help="no even rectangles; at 1e-3, 1e-4, 1e-5 in turn"
    )
    parser.add_argument("--kinds", type=_kinds, help=", ".join(KINDS))
    parser.add_argument("--seeds", type=_seeds, help="A:B, B not among them")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--timeout", type=float, default=TIMEOUT, help="s of a processor a scene")
    parser.add_argument("--show", action="store_true", help="print the scenes instead")
    return parser


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
    launch(main, options())
