"""List of the report's charts and their captions."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from ...evaluation.reliability import draw_reliability_and_risk
from ..paired_samples import FEATURE_LABELS
from ..versions import BEFORE
from .bars import draw_causes, draw_distributions
from .gap_curves import draw_accuracies, draw_distances
from .matrices import draw_confusions

if TYPE_CHECKING:
    from ..gap_findings import GapFindings

PRESSES = {"pressed": "over the pressed pixels", "rest": "for the unpressed skin"}


class Chart(NamedTuple):
    """A chart: its name, its caption, and a function that draws it to a path."""

    name: str
    caption: str
    draw: Callable[[Path], None]


def charts_of(findings: GapFindings) -> list[Chart]:
    """All charts for which there are findings."""
    return [
        *_distance_charts(findings),
        *_accuracy_charts(findings),
        *_belief_chart(findings),
        *_distribution_chart(findings),
        *_cause_chart(findings),
    ]


def _distance_charts(findings: GapFindings) -> list[Chart]:
    stages = "; ".join(
        f"{'solid' if name == BEFORE else 'dashed'}: {name} calibration" for name in findings.stages
    )
    return [
        Chart(
            f"distance-{kind}",
            f"Mean of the {findings.trial.pair.label.name} minus mean of the simulation, {where}. "
            f"{stages}. A class separation is the distance between neighbouring "
            f"{findings.trial.options.target}s in the same quantity.",
            lambda path, kind=kind: draw_distances(findings, kind, path),
        )
        for kind, where in PRESSES.items()
        if getattr(findings.stages[BEFORE], kind) is not None
    ]


def _accuracy_charts(findings: GapFindings) -> list[Chart]:
    label, target = findings.trial.pair.label, findings.trial.options.target
    curves = Chart(
        "accuracy",
        f"Share of {target}s found in {label.adjective} sweeps that training did not use, against "
        f"the number of {label.adjective} sweeps of each pixel that "
        f"{'adapted the model' if findings.model else 'were added to the simulated ones'}. Bars "
        "are one standard deviation over the draws.",
        lambda path: draw_accuracies(findings, path),
    )
    matrices = [
        Chart(
            f"confusion-{name}",
            f"Confusion of {target}s by {FEATURE_LABELS[name]}; counts are of all draws together.",
            lambda path, name=name: draw_confusions(findings, name, path),
        )
        for name in findings.own
    ]
    return [curves, *matrices]


def _belief_chart(findings: GapFindings) -> list[Chart]:
    caption = (
        "Share of right answers of the unadapted model against the probability that it states, "
        "with 95 % intervals; and share of wrong answers if only the most probable ones are given."
    )
    if findings.model is None:
        return []
    score = findings.model.score
    shown = score.answers.probability, score.right
    return [Chart("belief", caption, lambda path: draw_reliability_and_risk(path, *shown))]


def _distribution_chart(findings: GapFindings) -> list[Chart]:
    caption = (
        "Distance between the distributions of each feature: energy coefficient (0: equal, 1: far "
        "from each other) and unbiased MMD². A star marks a distance that occurs with a chance "
        "below 5 % if there is no gap."
    )
    chart = Chart("distribution", caption, lambda path: draw_distributions(findings, path))
    return [chart] if all(findings.stages[BEFORE].discrepancies.values()) else []


def _cause_chart(findings: GapFindings) -> list[Chart]:
    caption = "Part of the misfit that goes away if one parameter alone is fitted."
    chart = Chart("causes", caption, lambda path: draw_causes(findings, path))
    return [chart] if findings.causes else []
