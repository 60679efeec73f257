"""Answers and estimates of scenes of every kind, as the last campaign recorded them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from rcskin.benchmarks.accuracy.campaign import SEEDS_IN_TURN
from rcskin.benchmarks.accuracy.campaign_parts.judging import IN_TURN
from rcskin.benchmarks.accuracy.campaign_parts.kinds import KINDS, NOT_EVEN
from rcskin.benchmarks.accuracy.campaign_parts.record import published
from rcskin.benchmarks.accuracy.campaign_parts.verdict import Verdict
from rcskin.benchmarks.accuracy.verification_parts.report import FAILED, PASSED, Check, Section
from rcskin.benchmarks.bench import RESULTS, Run
from rcskin.simulator.chart_style import COLOURS, UNPRESSED_COLOUR, chart

TABLE, TABLE_IN_TURN, CHART = "campaign.csv", "campaign_in_turn.csv", "campaign.png"
COMMAND = (
    ".venv/bin/python benchmarks/accuracy/campaign.py -o campaign.jsonl --workers 2 --timeout 60"
)
COMMAND_IN_TURN = (
    ".venv/bin/python benchmarks/accuracy/campaign.py -o in_turn.jsonl --in-turn --workers 2 "
    "--timeout 25"
)
PLANNED = len(NOT_EVEN) * len(SEEDS_IN_TURN)
"""Scenes of a whole run of that command."""
LEAST_ESTIMATE, MOST_ESTIMATE = 0.3, 10.0
"""Range wanted of an estimate, over the true error."""
QUANTILES = (0.5, 0.95, 0.99, 1.0)
LEAST_JUDGED = 0.9
"""Of the scenes of all kinds."""
MOST_UNDERESTIMATED = 0.01
"""Of those judged; an estimate is not a bound."""
HEADER = (
    "kind",
    "judged",
    "broke its tolerance",
    "further off than estimated",
    "true / estimated: 50, 95, 99 %, largest",
    "not judged",
    "refused",
    "",
)


@dataclass(frozen=True)
class Kind:
    """The verdicts on one kind of scenes."""

    name: str
    verdicts: tuple[Verdict, ...]

    def count(self, outcome: str) -> int:
        """How many ended so."""
        return sum(each.outcome == outcome for each in self.verdicts)

    @property
    def broken(self) -> int:
        """Number of scenes beyond their tolerance."""
        return sum(each.broken for each in self.verdicts)

    @property
    def underestimated(self) -> int:
        """Number of scenes further off than their estimate."""
        return sum(each.underestimated for each in self.verdicts)

    @property
    def ratios(self) -> np.ndarray:
        """True over estimated errors of all values whose references are sure enough."""
        return np.concatenate([np.empty(0), *(each.ratios for each in self.verdicts)])

    def row(self) -> tuple[str, ...]:
        """As HEADER names it."""
        quantiles = np.quantile(self.ratios, QUANTILES) if self.ratios.size else ()
        return (
            self.name.replace("-", " "),
            f"{self.count('judged')}",
            f"{self.broken}",
            f"{self.underestimated}",
            ", ".join(f"{each:.2g}" for each in quantiles),
            f"{self.count('not judged')}",
            f"{self.count('refused')}",
        )


@dataclass(frozen=True)
class Kinds(Section):
    """A section with one line for each kind of scenes."""

    kinds: tuple[Kind, ...] = ()

    def lines(self) -> Iterable[str]:
        """The section in Markdown."""
        yield from (f"### {self.title}", "", self.says, "")
        verdicts = (PASSED if check.passed else FAILED for check in self.checks)
        rows = ((*kind.row(), each) for kind, each in zip(self.kinds, verdicts, strict=True))
        for row in (HEADER, ["---"] * len(HEADER), *rows):
            yield f"| {' | '.join(row)} |"
        yield from ("", f"![{self.title}]({self.chart})", "")


def section(run: Run) -> Section:
    """No answer may be further off than asked, and few further than estimated."""
    found = published(RESULTS / TABLE)
    kinds = [Kind(name, tuple(each for each in found if each.kind == name)) for name in KINDS]
    draw(run.results / CHART, kinds)
    whole = Kind("all", tuple(found))
    return Kinds(
        "Campaign",
        f"{len(found)} scenes of {len(kinds)} kinds, of u = ωRCL² from 1e-3 to 1e3 and tolerances "
        "from 1e-3 to 1e-6, all drawn at random, are answered and held against another route to "
        "the truth that shares no mesh with the first: the rectangle as an outline, turned; "
        "polygons for discs; formulas; other files of the same surface. Not judged are those whose "
        "reference is not sure to a quarter of the tolerance or takes too long; refused those that "
        f"the solver has no answer to at their tolerance. Recorded by `{COMMAND}`. "
        f"{_of_estimates(published(RESULTS / TABLE_IN_TURN))}",
        (*(check(kind) for kind in kinds), check_of_all(whole)),
        CHART,
        (*kinds, whole),
    )


def _of_estimates(found: list[Verdict]) -> str:
    """How far estimates of skins that are not plain lie from the truth, each scene by its worst."""
    judged = [each for each in found if each.outcome == "judged"]
    times = np.array([each.overstated for each in judged])
    times = times[np.isfinite(times)]
    within = np.mean((times >= LEAST_ESTIMATE) & (times <= MOST_ESTIMATE))
    asked = ", ".join(
        f"{sum(each.rtol == rtol for each in judged)} at {rtol:g}" for rtol in IN_TURN
    )
    return (
        f"{len(found)} other scenes that are more than even rectangles, of {PLANNED} planned, "
        f"{len(judged)} of them "
        f"judged ({asked}), were recorded by `{COMMAND_IN_TURN}`: "
        f"{sum(each.broken for each in judged)} broke their tolerance, "
        f"{sum(each.underestimated for each in judged)} were further off than estimated. Of the "
        f"{len(times)} whose reference is surer than the error it finds the largest estimate is "
        f"{LEAST_ESTIMATE:g} to {MOST_ESTIMATE:g} times the largest true one in {within:.0%} "
        f"(wanted: 95%), from {times.min():.2g} to {times.max():.2g}; in the median "
        f"{np.median(times):.2g} times."
    )


def check(kind: Kind) -> Check:
    """That nothing is further off than was asked, and nothing failed."""
    kept = not (kind.broken or kind.count("failed"))
    return Check(kind.name, "none broken", ", ".join(kind.row()[1:]), kept)


def check_of_all(whole: Kind) -> Check:
    """The same, that few are further off than estimated, and that enough are judged."""
    judged = whole.count("judged")
    enough = judged >= LEAST_JUDGED * len(whole.verdicts)
    few = whole.underestimated <= MOST_UNDERESTIMATED * judged
    expected = f"{LEAST_JUDGED:.0%} judged, {MOST_UNDERESTIMATED:.0%} further off than estimated"
    return replace(check(whole), expected=expected, passed=check(whole).passed and enough and few)


def draw(path: Path, kinds: list[Kind]) -> None:
    """True over estimated error of every value, kind by kind."""
    with chart(path, 7, 0.19 * len(kinds) + 0.9) as figure:
        axes = figure.subplots()
        for number, kind in enumerate(kinds):
            ratios = np.maximum(kind.ratios, 1e-4)
            colours = np.where(ratios > 1, COLOURS[1], COLOURS[0])
            axes.scatter(ratios, np.full(len(ratios), number), 9, colours, "|")
        axes.axvline(1, color=UNPRESSED_COLOUR, linewidth=1)
        axes.set_xscale("log")
        axes.set_yticks(range(len(kinds)), [kind.name.replace("-", " ") for kind in kinds])
        axes.invert_yaxis()
        axes.set_xlabel("true over estimated relative error of Rs and Cp")
        axes.set_title("Right of the line the error exceeds its estimate")
