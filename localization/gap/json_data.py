"""Findings as plain data for JSON: every key is documented, every number has a unit."""

from __future__ import annotations

import math
from dataclasses import asdict
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

import numpy as np

from .distance import UNITS, Distance

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...simulator.arrays import Real
    from ..evaluation.confusion import Confusion
    from .comparison import PreparedComparison
    from .gap_findings import CalibrationStage, GapFindings
    from .mean_accuracy import CrossValidated, MeanAccuracy

ESTIMATED = ("name", "unit", "start", "value", "low", "high")
"""Fields of each calibrated number."""
KEYS = {
    "compared": "for each side, simulated and other: number of sweeps and of sessions; label, name "
    "of the other side; calibrating, number of its sweeps that calibrated",
    "question": "target, estimator, seed, draws, calibration_touches: as given on the command line",
    "interfaces, frequency_Hz": "those that both sides have; the order of every table below",
    "meter_error": "standard deviation of one reading at each frequency: magnitude, of |Z| or "
    "the gain (a fraction), and phase_rad; source, their origin; null if unknown",
    "features": "quantities of each set of features",
    "distance": "stage -> pressed or rest -> Rs or Cp, or gain or gain_phase -> tables over "
    "(interface, frequency), other side minus simulation: simulated (mean over the pixels), "
    "mean, rms (over the pixels), meter_error (of one reading) and separation (root mean square "
    "distance of neighbouring classes' means) in ohm for Rs, F for Cp, 1 and rad for gains; "
    "percent of the simulated; in_meter_errors; in_separations (null where classes do not "
    "differ); all null where an interface was not read",
    "accuracy.transfer": "stage -> features -> k: trained on simulation and on k sweeps of every "
    "pixel of the other side, those that calibrated first, and tested on its other sweeps; mean "
    "and spread (standard deviation over the draws) are fractions of 1; tested counts all draws",
    "accuracy.model": "of the user's own model, null without --model: adapted -> k, as in "
    "transfer, the number of sweeps of every pixel that adapted it; as it is: right of all, "
    "answered, right of those answered and calibration error of the unadapted model on all tested "
    "sweeps, fractions of 1",
    "accuracy.own": "features -> trained and tested on the other side, cross-validated: `grouped` "
    "leaves out whole groups of the kind `grouping`, `single` leaves out single sweeps; folds, "
    "number of folds",
    "confusion": "in every accuracy: labels, outputs (labels, then cannot tell), and counts over "
    "(target class, output class)",
    "discrepancy": "stage -> features -> class (`all`: all classes together): first and second, "
    "numbers of simulated and of other sweeps; mmd2, squared maximum mean discrepancy, unbiased; "
    "p, probability of a value as large if there is no gap; energy, energy distance; coefficient, "
    "from 0 to 1. Features are in units of their spread on the other side",
    "calibration": "numbers of the scene by name, in their unit: start, the scene's value; value, "
    "the calibrated value; low and high, the 95 % interval",
    "causes": "parameter; share, from 0 to 1, of the misfit that it removes if it alone is fitted; "
    "change, as text",
    "causes_together": "parameters; share of the misfit that both remove if they are fitted "
    "jointly; changes, the value of each as text; empty if no pair was tried",
    "notes": "parts that were left out, and changes that made both sides comparable",
}


def numbers(findings: GapFindings) -> dict[str, Any]:
    """The findings under the keys of KEYS, which are explained in `about`. All are finite."""
    trial = findings.trial
    return {
        "about": KEYS,
        "software": f"rcskin {version('rcskin')}",
        "compared": _compared(trial),
        "question": asdict(trial.options),
        "interfaces": [str(name) for name in trial.pair.other["interface"].values],
        "frequency_Hz": trial.pair.other["frequency"].values.tolist(),
        "meter_error": _meter_error(trial),
        "features": {name: list(findings.trial.features[name]) for name in findings.own},
        "distance": {name: _distance(stage) for name, stage in findings.stages.items()},
        "accuracy": {
            "transfer": {name: _transfer(stage) for name, stage in findings.stages.items()},
            "model": _by_model(findings),
            "own": {
                name: {kind: _validated(each) for kind, each in found.items()}
                for name, found in findings.own.items()
            },
        },
        "discrepancy": {name: _discrepancy(stage) for name, stage in findings.stages.items()},
        "calibration": [{key: getattr(each, key) for key in ESTIMATED} for each in trial.estimates],
        "causes": [
            {"parameter": each.name, "share": each.removed, "change": each.description}
            for each in findings.causes
        ],
        "causes_together": [
            {
                "parameters": list(each.names),
                "share": each.removed,
                "changes": list(each.descriptions),
            }
            for each in findings.together
        ],
        "notes": list(findings.notes),
    }


def _by_model(findings: GapFindings) -> dict[str, Any] | None:
    if findings.model is None:
        return None
    found = {str(k): _accuracy(each) for k, each in findings.model.accuracies.items()}
    return {"adapted": found, "as it is": findings.model.score.figures()}


def _compared(trial: PreparedComparison) -> dict[str, Any]:
    sides = {"simulated": trial.pair.simulated, "other": trial.pair.other}
    counted: dict[str, dict[str, Any]] = {
        name: {
            "sweeps": side.sizes["sweep"],
            "sessions": int(np.unique(side["session"].values).size),
        }
        for name, side in sides.items()
    }
    counted["other"] |= {"label": trial.pair.label.name, "calibrating": int(trial.reserved.sum())}
    return counted


def _meter_error(trial: PreparedComparison) -> dict[str, Any] | None:
    error = trial.reading_deviation
    if error is None:
        return None
    return {
        "source": error.source,
        "magnitude": error.magnitude.tolist(),
        "phase_rad": error.phase.tolist(),
    }


def _distance(stage: CalibrationStage) -> dict[str, Any]:
    presses = {"pressed": stage.pressed, "rest": stage.rest}
    return {
        name: {quantity: _tables(quantity, each) for quantity, each in found.items()}
        for name, found in presses.items()
        if found is not None
    }


def _tables(quantity: str, distance: Distance) -> dict[str, Any]:
    names = ("simulated", "mean", "rms", "separation", "percent")
    found: dict[str, Any] = {name: _known(getattr(distance, name)) for name in names}
    found["unit"] = UNITS[quantity]
    if distance.meter_error is not None and distance.meter_errors is not None:
        found["meter_error"] = _known(distance.meter_error)
        found["in_meter_errors"] = _known(distance.meter_errors)
    return found | {"in_separations": _known(distance.separations)}


def _known(table: Real) -> list[list[float | None]]:
    """The table with None for numbers that are unknown."""
    return [[each if math.isfinite(each) else None for each in line] for line in table.tolist()]


def _transfer(stage: CalibrationStage) -> dict[str, Any]:
    return {
        name: {str(k): _accuracy(each) for k, each in found.items()}
        for name, found in stage.transfer.items()
    }


def _validated(found: CrossValidated) -> dict[str, Any]:
    return _accuracy(found.accuracy) | {"grouping": found.grouping, "folds": found.folds}


def _accuracy(accuracy: MeanAccuracy) -> dict[str, Any]:
    return {
        "mean": accuracy.mean,
        "spread": accuracy.spread,
        "draws": accuracy.draws,
        "tested": accuracy.confusion.total,
        "confusion": _confusion(accuracy.confusion),
    }


def _confusion(confusion: Confusion) -> dict[str, Any]:
    return {
        "labels": list(confusion.labels),
        "outputs": list(confusion.outputs),
        "counts": confusion.counts.tolist(),
    }


def _discrepancy(stage: CalibrationStage) -> Mapping[str, Any]:
    return {
        name: {label: asdict(each) for label, each in found.items()}
        for name, found in stage.discrepancies.items()
    }
