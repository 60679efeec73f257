"""Limits of the identity of touches: Bayes' accuracy, pairwise bounds and counts of pixels."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import linear_sum_assignment
from scipy.spatial.distance import cdist
from scipy.special import ndtr

from ..arrays import Real
from ..bounds.bayes import BayesAccuracy, bayes, train
from ..bounds.rasterization_errors import RasterizationErrors
from ..bounds.touch_readings import (
    Hypothesis,
    TouchReadings,
    by_rod,
    hypotheses,
    kinds,
    touched_alone,
)
from ..measure.experiment import combined_strengths, own_presses, quantiles
from ..progress import ProgressCallback, silent
from ..scene.parts import Plan, SceneParts, Skin
from ..scene.randomisation import AnyDistribution
from ..sweeps import InputError

OTHER_KINDS = {"pressed by a rod": by_rod, "touched by a finger without a press": touched_alone}


@dataclass(frozen=True)
class KindAccuracies:
    """Accuracies for other kinds of touch.

    accuracy: by kind of touch, then by target. kinds: accuracy of the kind itself, among a rod, a
    finger that presses, and a finger that only touches.
    """

    accuracy: Mapping[str, Mapping[str, BayesAccuracy]]
    kinds: BayesAccuracy

    def summary(self) -> dict[str, Any]:
        """Content of the file."""
        others = {
            kind: {target: numbers(found) for target, found in own.items()}
            for kind, own in self.accuracy.items()
        }
        return {**others, "kind_of_touch": numbers(self.kinds)}

    def lines(self) -> list[str]:
        """Lines for the terminal."""
        each = [
            f"  {kind}: at most " + ", ".join(f"{percent(a)} of {t}s" for t, a in own.items())
            for kind, own in self.accuracy.items()
        ]
        names = "a rod, a finger that presses, a finger that only touches"
        return [*each, f"  accuracy of the kind ({names}): at most {percent(self.kinds)}"]


def kind_accuracies(
    skin: Skin,
    plan: Plan,
    among: Mapping[str, Sequence[Hypothesis]],
    size: float | None,
    accuracy: Callable[[Sequence[Hypothesis]], BayesAccuracy],
) -> KindAccuracies | None:
    """Accuracies of other kinds of touch; None for a scene pressed by a rod or not pressed.

    among: hypotheses by target. size: see `TouchReadings`. accuracy: function of hypotheses.
    """
    if not plan.press.finger or plan.press.factor(skin) == 1:
        return None
    others = {
        name: {target: accuracy([*map(changed, own)]) for target, own in among.items()}
        for name, changed in OTHER_KINDS.items()
    }
    return KindAccuracies(others, accuracy(kinds(skin, plan, size)))


def by_finger(skin: Skin, plan: Plan, size: float | None) -> str:
    """Text of the finger of the scene's `press`, empty for a rod."""
    own = [each.fingers[0] for each in hypotheses(skin, plan, "pixel", size) if each.fingers]
    return f", by a finger of {1e12 * max(own):.3g} pF" if own else ""


def percent(found: BayesAccuracy) -> str:
    """Text of an accuracy and its standard error."""
    return f"{100 * found.share:.1f} ± {100 * found.error:.1f} %"


def digits(value: float, count: int) -> float:
    """A value rounded to `count` significant digits."""
    return float(f"{value:.{count}g}")


def numbers(found: BayesAccuracy) -> dict[str, float]:
    """An accuracy as content of a file."""
    return {
        "best_possible": digits(found.share, 6),
        "standard_error": digits(found.error, 2),
    }


STRENGTHS = 16
"""Number of equally likely strengths of a hypothesis."""

DISTANCE_STRENGTHS = 41
"""Number of strengths at which the distance of two pixels is evaluated."""


def upper_bound(
    readings: TouchReadings, among: Sequence[Hypothesis], presses: AnyDistribution
) -> float:
    """Upper bound on the accuracy of any classifier of equally likely hypotheses."""
    curves = [_curve(readings, each, presses) for each in among]
    wrong = np.zeros((len(among), len(among)))
    for i, j in itertools.combinations(range(len(among)), 2):
        if among[i].answer != among[j].answer:
            wrong[i, j] = wrong[j, i] = confusion(curves[i], curves[j])
    return 1 - float(wrong[linear_sum_assignment(wrong, maximize=True)].mean())


def confusion(one: Real, other: Real) -> float:
    """Smallest error rate between two hypotheses, with equally likely readings (k, number)."""
    size = math.lcm(len(one), len(other))
    error = ndtr(-cdist(one, other) / 2)
    error = np.repeat(np.repeat(error, size // len(one), 0), size // len(other), 1)
    return float(error[linear_sum_assignment(error, maximize=True)].mean())


def distances(
    readings: TouchReadings,
    among: Sequence[Hypothesis],
    presses: AnyDistribution,
    spread: float | None = None,
) -> Real:
    """Distances between hypotheses of one pixel, in the meter's errors, shape (k, k).

    Each is the minimum over both strengths of the presses. With `spread`, the squared deviations of
    both strengths from their mean, over the squared spread, are added to the squared distance.
    """
    factor = np.linspace(
        presses.low, presses.high, DISTANCE_STRENGTHS if presses.low < presses.high else 1
    )
    off = np.zeros_like(factor) if spread is None else ((factor - factor.mean()) / spread) ** 2
    curves = [readings.of_presses(each, np.tile(factor, (len(each.pixels), 1))) for each in among]
    separation = np.zeros((len(among), len(among)))
    for i, j in itertools.combinations(range(len(among)), 2):
        square = cdist(curves[i], curves[j], "sqeuclidean") + off[:, None] + off
        separation[i, j] = separation[j, i] = np.sqrt(square.min())
    return separation


def _curve(readings: TouchReadings, hypothesis: Hypothesis, presses: AnyDistribution) -> Real:
    touches = len(hypothesis.pixels)
    each = round(STRENGTHS ** (1 / max(1, touches)))
    factor = combined_strengths([quantiles(presses, each)] * touches).factor
    return readings.of_presses(hypothesis, factor)


@dataclass(frozen=True)
class Sampling:
    """Settings for accuracies: number of drawn sweeps and their seed.

    against_rest, size: see `TouchReadings`.
    """

    seed: int
    draws: int
    against_rest: int = 0
    size: float | None = None

    def readings(self, parts: SceneParts, presses: AnyDistribution) -> TouchReadings:
        """Readings of a scene under these presses."""
        return TouchReadings(parts, presses, self.against_rest, self.size)

    def bayes(
        self,
        readings: TouchReadings,
        among: Sequence[Hypothesis],
        presses: AnyDistribution,
        progress: ProgressCallback,
    ) -> BayesAccuracy:
        """Bayes' accuracy of hypotheses under these presses."""
        return bayes(readings, among, presses, self.seed, self.draws, progress)


TARGETS = ("column", "row", "pixel")


@dataclass(frozen=True)
class IdentityBounds:
    """Bayes' accuracy and its pairwise bound by target; distances between the sweeps of pixels.

    separation: distances in the meter's errors with unknown strengths, shape (pixel, pixel). names:
    of the pixels. assumptions: text of what is known and what is unknown. rasterization: errors of
    touches by depth. kinds: accuracies of other kinds of touch, where fingers press.
    """

    accuracy: dict[str, BayesAccuracy]
    bound: dict[str, float]
    separation: Real
    names: list[str]
    assumptions: str
    rasterization: RasterizationErrors | None = None
    kinds: KindAccuracies | None = None

    def summary(self) -> dict[str, Any]:
        """Content of the file."""
        own = {
            target: {**numbers(found), "pairwise_upper_bound": digits(self.bound[target], 6)}
            for target, found in self.accuracy.items()
        }
        rasterization, kinds = (
            {} if e is None else e.summary() for e in (self.rasterization, self.kinds)
        )
        return {"assumptions": self.assumptions, **rasterization, **own, **kinds}

    def lines(self) -> list[str]:
        """Lines for the terminal."""
        rasterization = [] if self.rasterization is None else [f"  {self.rasterization.sentence}"]
        own = [
            f"  accuracy of {target}s: at most {percent(found)} "
            f"for any classifier (pairwise bound {100 * self.bound[target]:.1f} %)"
            for target, found in self.accuracy.items()
        ]
        kinds = [] if self.kinds is None else self.kinds.lines()
        return [f"limits for a press: {self.assumptions}", *rasterization, *own, *kinds]


def identity(
    parts: SceneParts, sampling: Sampling, progress: ProgressCallback = silent
) -> IdentityBounds:
    """Identity bounds of a known skin, pressed as in the scene's experiment."""
    presses = own_presses(parts.skin, parts.plan.press)
    readings, size = sampling.readings(parts, presses), sampling.size
    among = {target: hypotheses(parts.skin, parts.plan, target, size) for target in TARGETS}
    pixels = [each for each in among["pixel"] if each.pixels]

    def accuracy(own: Sequence[Hypothesis]) -> BayesAccuracy:
        return sampling.bayes(readings, own, presses, progress)

    return IdentityBounds(
        {target: accuracy(own) for target, own in among.items()},
        {t: upper_bound(readings, each, presses) for t, each in among.items()},
        distances(readings, pixels, presses),
        [",".join(map(str, each.answer)) for each in pixels],
        _assumptions(parts.skin, parts.plan, size),
        readings.rasterization_errors(presses),
        kind_accuracies(parts.skin, parts.plan, among, size, accuracy),
    )


def _assumptions(skin: Skin, plan: Plan, size: float | None) -> str:
    """Text of what the classifier of the bounds knows and what it does not."""
    press, none = plan.press, "at most" if plan.unpressed else "exactly"
    area = "a whole pixel" if size is None else f"{1e3 * size:.3g} mm around the middle of a pixel"
    factor = f"{plan.press.factor(skin):.3g} times the capacitance{by_finger(skin, plan, size)}"
    spread = f", give or take {100 * press.factor_spread:.3g} % of the rise"
    return (
        f"the classifier knows the skin, that {none} one touch is there, its area ({area}) and its "
        f"strength ({factor}{spread if press.factor_spread else ''}); it looks for the pixel"
    )


MIN_PIXELS, MAX_PIXELS = 2, 12

DEVIATIONS = 2
"""Number of standard errors by which an accuracy may be below the required one."""


@dataclass(frozen=True)
class Count:
    """Number of pixels along the longer side of the grid, best accuracy, and pairwise bound."""

    n: int
    accuracy: BayesAccuracy
    bound: float

    def reaches(self, required: float) -> bool:
        """True if the required accuracy is possible within the standard error."""
        return self.accuracy.share + DEVIATIONS * self.accuracy.error >= required


def counts(
    parts: SceneParts,
    target: str,
    accuracy: float,
    sampling: Sampling,
    progress: ProgressCallback = silent,
) -> Iterator[Count]:
    """Counts from FEWEST pixels up to the first that does not reach the accuracy.

    Raises InputError where the accuracy is not between 0 and 1.
    """
    if not 0 < accuracy < 1:
        raise InputError(f"--accuracy must be > 0 and < 1, got {accuracy:g}")
    for n in range(MIN_PIXELS, MAX_PIXELS + 1):
        found = counted(parts, target, n, sampling, progress)
        yield found
        if not found.reaches(accuracy):
            return


def counted(
    parts: SceneParts, target: str, n: int, sampling: Sampling, progress: ProgressCallback = silent
) -> Count:
    """The best accuracy with n pixels along the longer side of the grid."""
    divided = with_pixels(parts, n)
    presses = own_presses(divided.skin, divided.plan.press)
    among = hypotheses(divided.skin, divided.plan, target, sampling.size)
    readings = sampling.readings(divided, presses)
    train(readings, progress)
    bound = upper_bound(readings, among, presses)
    return Count(n, sampling.bayes(readings, among, presses, progress), bound)


def with_pixels(parts: SceneParts, n: int) -> SceneParts:
    """The parts with n pixels along the longer side of the grid.

    The other side keeps the proportion of rows and columns, rounded, with at least one pixel. A
    strip stays a strip.
    """
    own = parts.skin.pixels.shape
    rows, columns = (max(1, round(n * each / max(own))) for each in own)
    strip = own[0] == 1, own[1] == 1 < own[0]
    return parts.on_grid(1 if strip[0] else rows, 1 if strip[1] else columns)


def grid_text(parts: SceneParts, n: int) -> str:
    """The pixels of `with_pixels` as rows x columns."""
    pixels = with_pixels(parts, n).skin.pixels
    return f"{pixels.rows}x{pixels.columns}"
