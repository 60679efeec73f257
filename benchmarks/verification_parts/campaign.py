"""Answers and estimates of scenes of every kind, as the last campaign recorded them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from bench import RESULTS, Run
from campaign_parts.kinds import KINDS
from campaign_parts.record import published
from campaign_parts.verdict import Verdict
from rcskin.simulator.charts import AT_REST, COLOURS, chart

from verification_parts.report import FAILED, PASSED, Check, Section

TABLE, CHART = "campaign.csv", "campaign.png"
COMMAND = ".venv/bin/python benchmarks/campaign.py -o campaign.jsonl --workers 2"
QUANTILES = (0.5, 0.95, 0.99, 1.0)
LEAST_JUDGED = 0.6
"""Of the scenes of all kinds."""
HEADER = (
    "kind",
    "judged",
    "broke its tolerance",
    "further off than told",
    "true / told: 50, 95, 99 %, largest",
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
        """How many are further off than was asked."""
        return sum(each.broken for each in self.verdicts)

    @property
    def boasted(self) -> float:
        """The part of those judged that is further off than was told."""
        return sum(each.boasted for each in self.verdicts) / max(1, self.count("judged"))

    @property
    def ratios(self) -> np.ndarray:
        """True over told errors of all values that the references tell."""
        return np.concatenate([np.empty(0), *(each.ratios for each in self.verdicts)])

    @property
    def passed(self) -> bool:
        """Whether nothing is further off than asked or told, and nothing failed."""
        return not (self.broken or self.boasted or self.count("failed"))

    def row(self) -> tuple[str, ...]:
        """As HEADER names it."""
        quantiles = np.quantile(self.ratios, QUANTILES) if self.ratios.size else ()
        return (
            self.name.replace("-", " "),
            f"{self.count('judged')}",
            f"{self.broken}",
            f"{self.boasted:.0%}",
            ", ".join(f"{each:.2g}" for each in quantiles),
            f"{self.count('not judged')}",
            f"{self.count('refused')}",
            PASSED if self.passed else FAILED,
        )


@dataclass(frozen=True)
class Kinds(Section):
    """A section with one line for each kind of scenes."""

    kinds: tuple[Kind, ...] = ()

    def lines(self) -> Iterable[str]:
        """The section in Markdown."""
        yield from (f"### {self.title}", "", self.says, "")
        for row in (HEADER, ["---"] * len(HEADER), *(kind.row() for kind in self.kinds)):
            yield f"| {' | '.join(row)} |"
        yield from ("", f"![{self.title}](results/{self.chart})", "")


def section(run: Run) -> Section:
    """No answer may be further off than asked or than told."""
    found = published(RESULTS / TABLE)
    kinds = [Kind(name, tuple(each for each in found if each.kind == name)) for name in KINDS]
    draw(run.results / CHART, kinds)
    return Kinds(
        "Campaign",
        f"{len(found)} scenes of {len(kinds)} kinds, of u = ωRCL² from 1e-3 to 1e3 and tolerances "
        "from 1e-3 to 1e-6, all drawn at random, are answered and held against another route to "
        "the truth that shares no mesh with the first: the rectangle as an outline, turned; "
        "polygons for discs; formulas; other files of the same surface. Not judged are those whose "
        "reference is not sure to a quarter of the tolerance or takes too long; refused those that "
        f"the solver has no answer to at their tolerance. Recorded by `{COMMAND}`.",
        tuple(checks(kinds)),
        CHART,
        tuple(kinds),
    )


def checks(kinds: list[Kind]) -> Iterator[Check]:
    """One for each kind, and that enough are judged."""
    for kind in kinds:
        measured = ", ".join(kind.row()[1:-1])
        yield Check(kind.name, "none broken, none above what is told", measured, kind.passed)
    judged, all_of = (
        sum(each)
        for each in zip(*((k.count("judged"), len(k.verdicts)) for k in kinds), strict=True)
    )
    share = judged / max(1, all_of)
    yield Check("judged", f">= {LEAST_JUDGED:.0%}", f"{share:.0%}", share >= LEAST_JUDGED)


def draw(path: Path, kinds: list[Kind]) -> None:
    """True over told error of every value, kind by kind."""
    with chart(path, 7, 0.19 * len(kinds) + 0.9) as figure:
        axes = figure.subplots()
        for number, kind in enumerate(kinds):
            ratios = np.maximum(kind.ratios, 1e-4)
            colours = np.where(ratios > 1, COLOURS[1], COLOURS[0])
            axes.scatter(ratios, np.full(len(ratios), number), 9, colours, "|")
        axes.axvline(1, color=AT_REST, linewidth=1)
        axes.set_xscale("log")
        axes.set_yticks(range(len(kinds)), [kind.name.replace("-", " ") for kind in kinds])
        axes.invert_yaxis()
        axes.set_xlabel("true over told relative error of Rs and Cp")
        axes.set_title("Right of the line an answer is further off than was told")
