"""Whether reduced models keep the accuracy and the times they are meant to."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from rcskin.benchmarks.bench import Run
from rcskin.benchmarks.speed.reduction_parts.cases import (
    BATCH,
    RTOL,
    Presses,
    Skin,
    against_exact,
    microseconds,
    prepared,
    sharpened,
    true_impedance,
    worst,
)
from rcskin.simulator.models.reduced.reduced_model import Reduced

FEW_PRESSES = 4
CERTIFIED = 100
"""Random presses, of which the most doubtful are checked."""
WRONG = 1e-3
"""What is off by more is not timed."""
IN_A_BATCH = "a sweep in a batch (µs per interface)"


@dataclass(frozen=True)
class Target:
    """Limits of one skin, and how many presses the full solver checks.

    microseconds: of a sweep, per interface. seconds: of the preparation, where it is limited.
    """

    skin: Skin
    microseconds: float
    seconds: float
    presses: int


TARGETS = (
    Target(Skin("sheet-5x5"), 20.0, 5.0, 30),
    Target(Skin("sheet-5x5-crossed"), 60.0, np.inf, 30),
    Target(Skin("sheet-5x5-two-interfaces"), 60.0, np.inf, 4),
    Target(Skin("sheet-5x5-two-interfaces", crossed=True), 60.0, np.inf, 2),
    Target(Skin("sheet-5x5", pixels=20), 200.0, 60.0, 12),
)


def table(run: Run) -> pd.DataFrame:
    """One row for each target."""
    few = [replace(target, presses=FEW_PRESSES) for target in TARGETS[:2]]
    return pd.DataFrame([measured(target) for target in run.sized(TARGETS, tuple(few))])


def measured(target: Target) -> dict[str, str | float]:
    """One row: sizes, times, errors, and whether all limits are kept."""
    model = prepared(target.skin)
    errors = _errors(model.reduced, target.presses)
    if not errors["true error"] < WRONG:
        raise AssertionError(f"{target.skin.title}: off by {errors['true error']:.1e}")
    times = {"preparation (s)": model.seconds, **_times(model.reduced)}
    limits = (RTOL, target.microseconds, target.seconds)
    reached = (errors["true error"], times[IN_A_BATCH], times["preparation (s)"])
    kept = all(value <= limit for value, limit in zip(reached, limits, strict=True))
    return {
        "skin": target.skin.title,
        "tolerance": f"{model.reduced.rtol:g}",
        "fields": model.reduced.circuit.fields,
        "unknowns": model.reduced.family.space.inner,
        "vectors": model.reduced.size,
        **times,
        f"checked of {CERTIFIED} presses": target.presses,
        **errors,
        "limits (µs, s)": f"{target.microseconds:g}, {target.seconds:g}".replace("inf", "-"),
        "kept": "yes" if kept else "no",
    }


def _times(reduced: Reduced) -> dict[str, float]:
    skin, interfaces = reduced.skin(None), len(reduced.circuit.excitations)
    return {
        name: microseconds(skin, reduced.parts.scene, count) / interfaces
        for name, count in ((IN_A_BATCH, BATCH), ("a single call (µs per interface)", 1))
    }


def _errors(reduced: Reduced, count: int) -> dict[str, float]:
    """Of the presses with the largest certificates: against the full solver, and of the basis."""
    skin = reduced.skin(None)
    presses, certified = Presses.drawn(reduced.parts.scene, CERTIFIED, seed=1).doubtful(skin, count)
    left_out, bounds = against_exact(sharpened(reduced).skin(None), presses)
    ratio = bounds / left_out
    return {
        "true error": worst(presses.solved(skin), true_impedance(presses)),
        "left out by the basis": float(left_out.max()),
        "largest certificate": float(certified.max()),
        "certificates above it (%)": 100 * float((certified > reduced.rtol).mean()),
        "certificate over left out, least": float(ratio.min()),
        "certificate over left out, median": float(np.median(ratio)),
    }
