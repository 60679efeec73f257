"""Curves of the report: distances against frequency, accuracies against added touches."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.chart_style import COLOURS, chart, frequency_axis
from ...simulator.notebook_display import CLOSE_LEGEND, SmallChart
from ...simulator.sweeps.reading_subset import read_mask
from .mean_accuracy import FEATURE_LABELS
from .versions import AFTER, BEFORE

if TYPE_CHECKING:
    from collections.abc import Mapping

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from .distance import Distance
    from .gap_findings import GapFindings

STAGE_STYLE = {BEFORE: "-", AFTER: "--"}
UNITS = {
    "meter_errors": "(meter's errors)",
    "percent": "(%)",
    "separations": "(class separations)",
}
LINEAR = {"meter_errors": 1.0, "percent": 1.0, "separations": 0.1}
"""Negligible distances: the axis range contains them, and is linear up to them if logarithmic."""
FAR = 30
"""Multiple of LINEAR above which an axis is logarithmic."""
SMALL = (4.8, 2.4)
"""Size of the small chart, inches."""


def draw_distances(findings: GapFindings, kind: str, path: Path) -> None:
    """Draw each quantity, a row for each unit, a colour for each interface.

    kind: pressed or rest.
    """
    shown = {name: getattr(stage, kind) for name, stage in findings.stages.items()}
    quantities = list(shown[BEFORE])
    units = [unit for unit in UNITS if _known(shown[BEFORE][quantities[0]], unit)]
    with chart(path, 10, 2.4 * len(units) + 0.5) as figure:
        panels = figure.subplots(len(units), len(quantities), sharex=True, squeeze=False)
        for row, unit in zip(panels, units, strict=True):
            for axes, quantity in zip(row, quantities, strict=True):
                found = {name: each[quantity] for name, each in shown.items()}
                _draw_distance(axes, findings, found, unit)
                axes.set_ylabel(f"{quantity} {UNITS[unit]}")
        for axes in panels[-1]:
            frequency_axis(axes)
        _legend(figure, panels[0, 0])


def small_distance_chart(findings: GapFindings) -> SmallChart | None:
    """Distances of the pressed sweeps in per cent, for a notebook; None if there are none."""
    found = findings.stages[BEFORE].pressed or {}
    if not all(_known(each, "percent") for each in found.values()):
        return None
    return SmallChart(lambda figure: _draw_small(figure, findings), *SMALL, top=0.4)


def _draw_small(figure: Figure, findings: GapFindings) -> None:
    shown = {name: stage.pressed or {} for name, stage in findings.stages.items()}
    quantities = list(shown[BEFORE])
    panels = figure.subplots(1, len(quantities), squeeze=False)[0]
    for axes, quantity in zip(panels, quantities, strict=True):
        found = {name: each[quantity] for name, each in shown.items()}
        _draw_distance(axes, findings, found, "percent")
        axes.set_title(f"{quantity} {UNITS['percent']}")
        frequency_axis(axes)
    panels[0].set_ylabel(f"{findings.trial.pair.label.adjective} - simulated")
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="upper center", ncols=2, **CLOSE_LEGEND)


def _known(distance: Distance, unit: str) -> bool:
    """True if the distances are known in this unit."""
    values = getattr(distance, unit)
    return values is not None and bool(np.isfinite(values).any())


def _draw_distance(
    axes: Axes, findings: GapFindings, found: Mapping[str, Distance], unit: str
) -> None:
    other = findings.trial.pair.other
    read = read_mask(other)
    for stage, distance in found.items():
        for index, interface in enumerate(other["interface"].values):
            axes.plot(
                other["frequency"].values[read[index]] / 1e3,
                getattr(distance, unit)[index, read[index]],
                STAGE_STYLE[stage],
                marker=".",
                color=COLOURS[index % len(COLOURS)],
                label=f"{interface}, {stage} calibration",
            )
    furthest = np.nanmax([np.abs(getattr(each, unit)) for each in found.values()])
    if furthest > FAR * LINEAR[unit]:
        axes.set_yscale("symlog", linthresh=LINEAR[unit])
        axes.yaxis.set_major_formatter("{x:g}")
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, -LINEAR[unit]), max(high, LINEAR[unit]))
    axes.axhline(0, color="0.4", linewidth=0.8)


def draw_accuracies(findings: GapFindings, path: Path) -> None:
    """Draw a panel for each set of features."""
    label, target = findings.trial.pair.label, findings.trial.options.target
    with chart(path, 9, 3.9) as figure:
        panels = figure.subplots(1, len(findings.own), sharey=True, squeeze=False)[0]
        for axes, name in zip(panels, findings.own, strict=True):
            _draw_transfer(axes, findings, name)
            _draw_own(axes, findings, name)
            axes.set_title(FEATURE_LABELS[name])
            axes.set_xlabel(f"{label.adjective.capitalize()} sweeps of each pixel added")
            axes.set_ylim(0, 103)
        panels[0].set_ylabel(f"{target.capitalize()}s right (%)")
        _legend(figure, panels[0])


def _draw_transfer(axes: Axes, findings: GapFindings, name: str) -> None:
    by_stage = {
        f"trained on simulation, {stage} calibration": (stage, found.transfer[name])
        for stage, found in findings.stages.items()
        if found.transfer
    }
    if findings.model:
        by_stage = {"the model, adapted by these": (BEFORE, findings.model.accuracies)}
    for index, (label, (stage, transfer)) in enumerate(by_stage.items()):
        aside = 0.06 * (index - 0.5)
        axes.errorbar(
            np.arange(len(transfer)) + aside,
            [100 * each.mean for each in transfer.values()],
            [100 * each.spread for each in transfer.values()],
            marker="o",
            markersize=4,
            linestyle=STAGE_STYLE[stage],
            capsize=3,
            color=COLOURS[index],
            label=label,
        )
        axes.set_xticks(range(len(transfer)), [str(k) for k in transfer])


def _draw_own(axes: Axes, findings: GapFindings, name: str) -> None:
    by_grouping = {found.grouping: found for found in findings.own[name].values()}
    for (grouping, found), look in zip(by_grouping.items(), ("-.", ":"), strict=False):
        how = f"cross-validated by {grouping or 'sweep'}"
        axes.axhline(
            100 * found.accuracy.mean,
            linestyle=look,
            color="0.35",
            label=f"trained on {findings.trial.pair.label.adjective} sweeps, {how}",
        )


def _legend(figure, axes: Axes) -> None:
    figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=2)
