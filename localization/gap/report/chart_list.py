"""The report's charts and their captions: bars, confusion matrices, curves."""

from __future__ import annotations

import textwrap
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ....simulator.chart_style import COLOURS, chart
from ...evaluation.confusion_chart import draw_confusion
from ...evaluation.reliability import draw_reliability_and_risk
from ..mean_accuracy import FEATURE_LABELS
from ..versions import BEFORE
from .gap_curves import draw_accuracies, draw_distances
from .sentences import cause_label, model_label

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..gap_findings import GapFindings
    from ..mean_accuracy import MeanAccuracy

SIGNIFICANT = 0.05
WIDEST, MANY = 0.8, 12
MEASURES = {"coefficient": "energy coefficient", "mmd2": "MMD²"}


def draw_distributions(findings: GapFindings, path: Path) -> None:
    """Draw a row for each set of features, a group of bars for each class."""
    sets = list(findings.own)
    classes = len(findings.stages[BEFORE].discrepancies[sets[0]])
    with chart(path, max(9.0, 0.5 * classes + 3), 2.6 * len(sets) + 0.6) as figure:
        panels = figure.subplots(len(sets), len(MEASURES), squeeze=False)
        for row, name in zip(panels, sets, strict=True):
            for axes, measure in zip(row, MEASURES, strict=True):
                _draw_measure(axes, findings, name, measure)
                axes.set_ylabel(MEASURES[measure][0].upper() + MEASURES[measure][1:])
                axes.set_title(FEATURE_LABELS[name])
        for axes in panels[-1]:
            axes.set_xlabel(findings.trial.options.target.capitalize())
        handles = panels[0, 0].get_legend_handles_labels()
        figure.legend(*handles, loc="outside lower center", ncols=2)


def _draw_measure(axes: Axes, findings: GapFindings, name: str, measure: str) -> None:
    labels = list(findings.stages[BEFORE].discrepancies[name])
    count = len(findings.stages)
    width, places = WIDEST / count, np.arange(len(labels))
    for index, (stage, answers) in enumerate(findings.stages.items()):
        found = [answers.discrepancies[name].get(label) for label in labels]
        heights = [getattr(each, measure) if each else 0.0 for each in found]
        at, colour = places + width * (index - (count - 1) / 2), COLOURS[index]
        bars = axes.bar(at, heights, width, color=colour, label=f"{stage} calibration")
        if measure == "mmd2":
            axes.bar_label(bars, ["*" if each and each.p < SIGNIFICANT else "" for each in found])
    axes.set_xticks(places, labels, rotation=90 if len(labels) > MANY else 0)
    axes.axhline(0, color="0.4", linewidth=0.8)
    axes.margins(x=0.01, y=0.12)
    axes.grid(False, axis="x")
    axes.set_axisbelow(True)


def draw_causes(findings: GapFindings, path: Path) -> None:
    """Draw a bar for each parameter, the longest first."""
    names = [cause_label(each) for each in findings.causes]
    shares = [100 * each.removed for each in findings.causes]
    with chart(path, 7, 0.9 + 0.32 * len(names)) as figure:
        axes = figure.subplots()
        bars = axes.barh(names, shares, color=COLOURS[0])
        axes.bar_label(bars, [f"{share:.0f} %" for share in shares], padding=3, fontsize=8)
        axes.invert_yaxis()
        axes.set_xlim(0, 112)
        axes.set_xticks([0, 25, 50, 75, 100])
        axes.set_xlabel("Misfit removed by this parameter alone (%)")
        axes.grid(False, axis="y")
        axes.set_axisbelow(True)


SIDE, EACH_CLASS = 3.6, 0.3
"""Minimum side of a matrix, and side per class in a large one, inches."""
TITLE_WIDTH = 46
"""Maximum number of letters in a line of a title."""


def main_cases(findings: GapFindings, name: str) -> dict[str, MeanAccuracy]:
    """Accuracies that get a matrix, by their training. name: name of the features."""
    side, stages = findings.trial.pair.label, list(findings.stages)
    if findings.model:
        cases = {model_label(k).capitalize(): a for k, a in findings.model.accuracies.items()}
        return dict([*cases.items()][:: max(1, len(cases) - 1)])
    cases = {
        f"Trained on simulation, {stage} calibration": findings.stages[stage].transfer[name][0]
        for stage in stages
    }
    most, last = max(findings.trial.splits), stages[-1]
    if most:
        added = f"{most} {side.adjective} sweeps of each pixel"
        label = f"Trained on simulation, {last} calibration, and {added}"
        cases[label] = findings.stages[last].transfer[name][most]
    for found in list(findings.own[name].values())[:1]:
        label = (
            f"Trained on {side.adjective} sweeps, cross-validated by {found.grouping or 'sweep'}"
        )
        cases[label] = found.accuracy
    return cases


def draw_confusions(findings: GapFindings, name: str, path: Path) -> None:
    """Draw the main cases of one set of features, two in a row."""
    cases = main_cases(findings, name)
    classes = max(len(each.confusion.labels) for each in cases.values())
    down, side = -(-len(cases) // 2), max(SIDE, EACH_CLASS * classes)
    with chart(path, 2 * side + 1, down * (side + 0.8)) as figure:
        panels = figure.subplots(down, 2, squeeze=False).ravel()
        for axes, (label, accuracy) in zip(panels, cases.items(), strict=False):
            draw_confusion(axes, accuracy.confusion)
            lines = [*textwrap.wrap(label, TITLE_WIDTH, break_on_hyphens=False), axes.get_title()]
            axes.set_title("\n".join(lines), fontsize=9)
        for axes in panels[len(cases) :]:
            axes.set_axis_off()


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
