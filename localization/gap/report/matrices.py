"""Confusion matrices of the report."""

from __future__ import annotations

import textwrap
from pathlib import Path
from typing import TYPE_CHECKING

from ....simulator.chart_style import chart
from ...evaluation.confusion_chart import draw_confusion
from .sentences import model_label

if TYPE_CHECKING:
    from ..gap_findings import GapFindings
    from ..mean_accuracy import MeanAccuracy

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
