"""Report of the gap: sentences, tables, charts and their captions."""

from __future__ import annotations

import textwrap
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.chart_style import COLOURS, chart
from ...simulator.models.parameters import EFFECTS
from ...simulator.report.findings import Chart, DataTable, Finding, Findings, Head, Heading, Items
from ..evaluation.confusion_chart import draw_confusion
from ..evaluation.reliability import draw_reliability_and_risk
from ..trust.answers import CountedRate
from .gap_curves import draw_accuracies, draw_distances, small_distance_chart
from .json_data import numbers
from .mean_accuracy import FEATURE_LABELS
from .versions import AFTER, BEFORE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ...simulator.calibration.estimates import FittedQuantity
    from ...simulator.calibration.misfit import ParameterEffect
    from .gap_findings import GapFindings
    from .mean_accuracy import MeanAccuracy

MAIN_SHARE, NOTABLE_SHARE, MENTIONED_SHARE = 0.5, 0.1, 0.005
"""Minimum shares of the misfit that three statements require.

A parameter explains most of a gap; it explains a part of it; a second parameter is mentioned.
"""


def accuracy_table(findings: GapFindings) -> DataTable:
    """All accuracies, one row for each kind of training."""
    adjective = findings.trial.pair.label.adjective
    rows: list[tuple[str, ...]] = []
    for k, accuracy in findings.model.accuracies.items() if findings.model else ():
        rows.append((model_label(k), _percent(accuracy)))
    for stage, found in findings.stages.items() if not findings.model else ():
        for k in findings.trial.splits:
            cells = (_percent(found.transfer[name][k]) for name in findings.own)
            rows.append((f"simulated, {stage} calibration, k = {k}", *cells))
    for kind in ("grouped", "single"):
        found = [each.get(kind) for each in findings.own.values()]
        if all(found):
            grouping = next(each.grouping for each in found if each) or "sweep"
            cells = (_percent(each.accuracy) for each in found if each)
            rows.append((f"{adjective}, cross-validated by {grouping}", *cells))
    heads = (", ".join(findings.trial.features[name]) for name in findings.own)
    columns = ["trained on", *(Head(head, form=str) for head in heads)]
    return DataTable("accuracies", columns, list(dict.fromkeys(rows)))


def model_label(k: int) -> str:
    """Label of the user's model, adapted by k sweeps of every pixel."""
    return f"the model, adapted by k = {k}" if k else "the model as it is"


def summary(findings: GapFindings) -> list[str]:
    """The most important findings, one sentence each, and the cause of the gap if it is known."""
    return list(filter(None, [*_distances_and_accuracies(findings), cause_sentence(findings)]))


def _distances_and_accuracies(findings: GapFindings) -> list[str]:
    label, target = findings.trial.pair.label, findings.trial.options.target
    before = _largest(findings, BEFORE)
    sentences = [f"Distance of the mean {label.name} from the simulation, pressed: {before}."]
    if AFTER in findings.stages:
        sentences.append(f"Distance after calibration: {_largest(findings, AFTER)}.")
    if findings.model:
        rates = findings.model.score.rates()
        sentences.append(
            f"The model on the {label.adjective} sweeps ({target}s): "
            + "; ".join(f"{name} {rate.text}" for name, rate in rates.items())
            + "."
        )
        return sentences
    for name in findings.own:
        names = [
            f"{_percent(found.transfer[name][0])} {stage} calibration"
            for stage, found in findings.stages.items()
        ]
        sentences.append(
            f"Accuracy on the {label.adjective} sweeps ({target}s), trained on simulation alone by "
            f"{FEATURE_LABELS[name]}: {' and '.join(names)}."
        )
    return sentences


def cause_sentence(findings: GapFindings) -> str:
    """Sentence about the parameter that explains most of the gap; empty if unknown."""
    if not findings.causes:
        return ""
    first, *others = findings.causes
    name, share = cause_label(first), f"{100 * first.removed:.0f} % of the misfit"
    if first.removed >= MAIN_SHARE:
        sentence = f"{name} explains most of the gap: fitted alone, it removes {share}"
    elif first.removed >= NOTABLE_SHARE:
        sentence = f"{name} explains a part of the gap: fitted alone, it removes {share}"
    else:
        sentence = f"no parameter alone explains the gap: {name}, the best one, removes {share}"
    if others and others[0].removed >= MENTIONED_SHARE:
        sentence += f"; next is {cause_label(others[0])} with {100 * others[0].removed:.0f} %"
    return sentence[0].upper() + sentence[1:] + "." + _pairs(findings)


def _pairs(findings: GapFindings) -> str:
    """Sentence on the best pair and the others fitted jointly; empty without pairs."""
    if not findings.together:
        return ""
    first, *others = findings.together
    words = " and ".join(
        description if name in EFFECTS else _spaced(name)
        for name, description in zip(first.names, first.descriptions, strict=True)
    )
    shares = [
        f" Fitted together, {words} remove {100 * first.removed:.1f} % of the misfit",
        *(
            f"{' and '.join(map(_spaced, each.names))} {100 * each.removed:.1f} %"
            for each in others
        ),
    ]
    return "; ".join(shares) + "."


def cause_label(cause: ParameterEffect) -> str:
    """Label of a parameter; for one of EFFECTS its description, as `a body at about 6 mm`."""
    return cause.description if cause.name in EFFECTS else _spaced(cause.name)


def estimate_row(estimate: FittedQuantity) -> tuple[str, str, str, str]:
    """Name, value in the scene, calibrated value and its interval."""
    start, value, low, high = (
        _written(number, estimate.unit)
        for number in (estimate.start, estimate.value, estimate.low, estimate.high)
    )
    return _spaced(estimate.name), start, value, f"{low} to {high}"


def _written(number: float, unit: str) -> str:
    """Number with four digits, and with a prefix if there is a unit."""
    from matplotlib.ticker import EngFormatter

    rounded = f"{number:.4g}"
    return EngFormatter(unit=unit)(float(rounded)) if unit else rounded


def _largest(findings: GapFindings, stage: str) -> str:
    """Root mean square distance over frequencies and interfaces, for Rs and for Cp."""
    found = findings.stages[stage].pressed
    assert found is not None
    parts = []
    for quantity, distance in found.items():
        part = f"{_rms(distance.percent):.3g} % of {quantity}"
        if distance.meter_errors is not None:
            part += f" ({_rms(distance.meter_errors):.3g} of the meter's errors)"
        parts.append(part)
    return f"{' and '.join(parts)} (rms)"


def _rms(values: np.ndarray) -> float:
    """Root mean square of the known values."""
    return float(np.sqrt(np.nanmean(np.square(values))))


def _percent(accuracy: MeanAccuracy) -> str:
    """Mean and spread over draws, which may test the same sweeps; counts for one draw."""
    if accuracy.draws == 1:
        return CountedRate(accuracy.confusion.correct, accuracy.confusion.total).text
    return f"{100 * accuracy.mean:.1f} ± {100 * accuracy.spread:.1f} %"


def _spaced(name: str) -> str:
    return name.replace("_", " ")


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


HEADINGS = {
    "distance": "Distances between the mean sweeps",
    "accuracy": "Accuracy of the localizer",
    "confusion": "Confusion of classes",
    "belief": "Reliability of the model's probabilities",
    "distribution": "Distances between the distributions of the features",
    "causes": "Causes of the gap",
}
"""Headings of the sections, by the beginning of the names of their charts."""


def report_of(findings: GapFindings) -> Findings:
    """Sentences, tables, charts and numbers of a comparison."""
    charts = charts_of(findings)
    estimates = [estimate_row(each) for each in findings.trial.estimates]
    calibrated = ["", "Scene", "Calibrated", "95 % interval"]
    parts: list[Finding] = [_compared(findings), Items(summary(findings)), *_accuracies(findings)]
    for kind, title in HEADINGS.items():
        found = [each for each in charts if each.name.startswith(kind)]
        parts += [Heading(title), *found] if found else []
    if estimates:
        parts += [Heading("Calibrated parameters"), DataTable("calibrated", calibrated, estimates)]
    parts += [Heading("Notes on the numbers"), Items([_error(findings), *findings.notes])]
    return Findings(
        f"Simulation and {findings.trial.pair.label.name}: the gap",
        parts,
        numbers=numbers(findings),
        small=lambda: small_distance_chart(findings),
    )


def _compared(findings: GapFindings) -> str:
    pair, options = findings.trial.pair, findings.trial.options
    other, names = pair.other, [str(name) for name in pair.other["interface"].values]
    return (
        f"{pair.simulated.sizes['sweep']} simulated sweeps against {other.sizes['sweep']} "
        f"{pair.label.adjective} sweeps at {other.sizes['frequency']} frequencies and the "
        f"interface{'s' if len(names) > 1 else ''} {', '.join(names)}; {options.target}s by "
        f"{options.estimator}, seed {options.seed}."
    )


def _accuracies(findings: GapFindings) -> list[Finding]:
    adjective = findings.trial.pair.label.adjective
    done = "adapt the model" if findings.model else "are added to the simulated ones"
    explanation = (
        f"k {adjective} sweeps of each pixel {done}; ± is one standard deviation over "
        f"{findings.trial.options.draws} draws of them. No tested sweep was used for training or "
        "calibration; the sweeps that calibrated are the first of the k. dlnZ and dphase, or dlnG "
        "and dphaseG, are changes of ln|Z| or ln|V / V_s| and phase from the unpressed skin in "
        "the same session."
    )
    return [Heading(f"Accuracy on {adjective} sweeps"), accuracy_table(findings), explanation]


def _error(findings: GapFindings) -> str:
    error = findings.trial.reading_deviation
    if error is None:
        return "The meter's error is unknown: neither a scene nor repeated sweeps give it."
    return (
        f"The meter's error of one reading, from {error.source}, is at most "
        f"{100 * error.magnitude.max():.2g} % of its modulus and "
        f"{np.degrees(error.phase.max()):.2g}°."
    )
