"""Scores of a model by fault: accuracy, sweeps without an answer, and faults named right."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.measure.skin_faults import kind_of_fault
from ..trust.diagnosis import NO_FAULT, faults_of
from .evaluation import ClassScore, Score

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

    from ..inputs.samples import Samples
    from ..trust.answers import Answers


@dataclass(frozen=True)
class FaultScore:
    """Scores of the sweeps with one kind of fault, or without any.

    figure: share of right answers, or median error of the position in mm. answered,
    named_right, named_wrong: shares of the sweeps; a name is right if it is that of the fault.
    """

    kind: str
    sweeps: int
    figure: float
    answered: float
    named_right: float
    named_wrong: float


def fault_scores(
    sweeps: xr.Dataset,
    answers: Answers,
    named: NDArray[np.str_],
    samples: Samples,
    score: Score,
) -> list[FaultScore]:
    """Scores by fault; none if no sweep has a fault.

    answers, named: to all sweeps, and the kind of the fault that each resembles, shape (sweep,).
    samples, score: of those of the sweeps that have a target.
    """
    faults = faults_of(sweeps)
    if not (faults != "").any():
        return []
    kinds = np.array([kind_of_fault(text) or NO_FAULT for text in faults])[samples.rows]
    named, answered = named[samples.rows], answers.answered[samples.rows]
    found = []
    for kind in np.unique(kinds).tolist():
        own = kinds == kind
        figure = (
            (score.right & answered)[own].mean()
            if isinstance(score, ClassScore)
            else np.median(score.distance[own])
        )
        right = (named[own] == kind).mean()
        wrong = (named[own] != "").mean() - right
        shares = float(answered[own].mean()), float(right), float(wrong)
        found.append(FaultScore(kind, int(own.sum()), float(figure), *shares))
    return found


def fault_lines(scores: list[FaultScore], *, classes: bool) -> list[str]:
    """A line for each fault. classes: True if the figure is a share of right answers."""
    return [
        f"{each.kind}: {each.sweeps} sweeps, "
        + (
            f"right of all {_share(each.figure)}"
            if classes
            else f"median error {each.figure:.3g} mm"
        )
        + f", answered {_share(each.answered)}"
        + f", named right {_share(each.named_right)}" * (each.kind != NO_FAULT)
        + f", named as another fault {_share(each.named_wrong)}"
        for each in scores
    ]


def _share(value: float) -> str:
    return f"{100 * value:.3g} %"
