"""Findings as sentences and as one table, for the console and the report."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ....simulator.models.parameters import EFFECTS
from ...trust.answers import CountedRate
from ..mean_accuracy import FEATURE_LABELS
from ..versions import AFTER, BEFORE

if TYPE_CHECKING:
    from ....simulator.calibration.misfit import ParameterEffect
    from ....simulator.calibration.results.estimates import FittedQuantity
    from ..gap_findings import GapFindings
    from ..mean_accuracy import MeanAccuracy


MAIN_SHARE, NOTABLE_SHARE, MENTIONED_SHARE = 0.5, 0.1, 0.005
"""Minimum shares of the misfit that three statements require.

A parameter explains most of a gap; it explains a part of it; a second parameter is mentioned.
"""


class AccuracyRow(NamedTuple):
    """One kind of training, and its accuracy for each set of features, as text."""

    trained: str
    cells: tuple[str, ...]


def accuracy_rows(findings: GapFindings) -> list[AccuracyRow]:
    """All accuracies, one row for each kind of training."""
    adjective = findings.trial.pair.label.adjective
    rows = []
    for k, accuracy in findings.model.accuracies.items() if findings.model else ():
        rows.append(AccuracyRow(model_label(k), (_percent(accuracy),)))
    for stage, found in findings.stages.items() if not findings.model else ():
        for k in findings.trial.splits:
            cells = tuple(_percent(found.transfer[name][k]) for name in findings.own)
            rows.append(AccuracyRow(f"simulated, {stage} calibration, k = {k}", cells))
    for kind in ("grouped", "single"):
        found = [each.get(kind) for each in findings.own.values()]
        if all(found):
            grouping = next(each.grouping for each in found if each) or "sweep"
            cells = tuple(_percent(each.accuracy) for each in found if each)
            rows.append(AccuracyRow(f"{adjective}, cross-validated by {grouping}", cells))
    return list(dict.fromkeys(rows))


def accuracy_table(findings: GapFindings) -> list[tuple[str, ...]]:
    """All accuracies: the header, and one row for each kind of training."""
    rows = [(row.trained, *row.cells) for row in accuracy_rows(findings)]
    return [("trained on", *column_headings(findings)), *rows]


def column_headings(findings: GapFindings) -> list[str]:
    """Headings of the cells of a row."""
    return [", ".join(findings.trial.features[name]) for name in findings.own]


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
