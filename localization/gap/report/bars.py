"""Bar charts of the report: distances of distributions, shares of causes."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ....simulator.chart_style import COLOURS, chart
from ..paired_samples import FEATURE_LABELS
from ..versions import BEFORE
from .sentences import cause_label

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..gap_findings import GapFindings

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
