"""The report: one HTML file with all charts, and the numbers as JSON."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ....simulator.cleanup import temporary_folder
from ....simulator.report.files import filled_at_once, write_json
from ....simulator.report.page import Items, Picture, ReportSection, TableGrid, write_page
from .chart_list import charts_of
from .json_data import numbers
from .sentences import accuracy_rows, column_headings, estimate_row, summary

if TYPE_CHECKING:
    from ..gap_findings import GapFindings

HTML, JSON = "gap.html", "gap.json"
HEADINGS = {
    "distance": "Distances between the mean sweeps",
    "accuracy": "Accuracy of the localizer",
    "confusion": "Confusion of classes",
    "belief": "Reliability of the model's probabilities",
    "distribution": "Distances between the distributions of the features",
    "causes": "Causes of the gap",
}
"""Headings of the sections, by the beginning of the names of their charts."""


def write_report(folder: Path, findings: GapFindings, ending: str | None = None) -> None:
    """Write gap.html and gap.json, both complete or neither.

    ending: format of separate chart files, if any.
    """
    charts = charts_of(findings)
    with filled_at_once(folder) as made, temporary_folder() as drawn:
        pictures = [Picture(drawn / f"{each.name}.png", each.caption) for each in charts]
        for chart, picture in zip(charts, pictures, strict=True):
            chart.draw(picture.path)
        write_json(made / JSON, numbers(findings), indent=1)
        title = f"Simulation and {findings.trial.pair.label.name}: the gap"
        write_page(made / HTML, title, _sections(findings, pictures))
        for chart in charts if ending else ():
            chart.draw(made / f"{chart.name}{ending}")


def _sections(findings: GapFindings, pictures: Sequence[Picture]) -> list[ReportSection]:
    shown = {
        title: [each for each in pictures if each.name.startswith(kind)]
        for kind, title in HEADINGS.items()
    }
    calibrated = ["", "Scene", "Calibrated", "95 % interval"]
    estimates = [estimate_row(each) for each in findings.trial.estimates]
    return [
        ReportSection("", [_compared(findings), Items(summary(findings))]),
        _accuracies(findings),
        *(ReportSection(title, found) for title, found in shown.items() if found),
        *(
            [ReportSection("Calibrated parameters", [TableGrid(calibrated, estimates)])]
            if estimates
            else []
        ),
        ReportSection("Notes on the numbers", [Items([_error(findings), *findings.notes])]),
    ]


def _compared(findings: GapFindings) -> str:
    pair, options = findings.trial.pair, findings.trial.options
    other, names = pair.other, [str(name) for name in pair.other["interface"].values]
    return (
        f"{pair.simulated.sizes['sweep']} simulated sweeps against {other.sizes['sweep']} "
        f"{pair.label.adjective} sweeps at {other.sizes['frequency']} frequencies and the "
        f"interface{'s' if len(names) > 1 else ''} {', '.join(names)}; {options.target}s by "
        f"{options.estimator}, seed {options.seed}."
    )


def _accuracies(findings: GapFindings) -> ReportSection:
    adjective, columns = findings.trial.pair.label.adjective, column_headings(findings)
    rows = [[row.trained, *row.cells] for row in accuracy_rows(findings)]
    done = "adapt the model" if findings.model else "are added to the simulated ones"
    explanation = (
        f"k {adjective} sweeps of each pixel {done}; ± is one standard deviation over "
        f"{findings.trial.options.draws} draws of them. No tested sweep was used for training or "
        "calibration; the sweeps that calibrated are the first of the k. dlnZ and dphase, or dlnG "
        "and dphaseG, are changes of ln|Z| or ln|V / V_s| and phase from the unpressed skin in "
        "the same session."
    )
    numbered = range(1, 1 + len(columns))
    title = f"Accuracy on {adjective} sweeps"
    return ReportSection(title, [TableGrid(["Trained on", *columns], rows, numbered), explanation])


def _error(findings: GapFindings) -> str:
    error = findings.trial.reading_deviation
    if error is None:
        return "The meter's error is unknown: neither a scene nor repeated sweeps give it."
    return (
        f"The meter's error of one reading, from {error.source}, is at most "
        f"{100 * error.magnitude.max():.2g} % of its modulus and "
        f"{np.degrees(error.phase.max()):.2g}°."
    )
