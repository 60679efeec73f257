"""Whether touches are told apart: bounds by pairs, for one skin and over counts of pixels."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment
from scipy.spatial.distance import cdist
from scipy.special import ndtr

from ..bounds.bayes import Accuracy, bayes
from ..bounds.readings import Hypothesis, Readings, hypotheses
from ..bounds.touches.errors import LaidErrors
from ..measure.experiment import own_presses, quantiles, together
from ..progress import ProgressCallback, silent
from ..scene.randomisation import AnyDistribution
from ..scene.scene import Scene
from ..sweeps import InputError
from .ways import Ways, by_finger, digits, numbers, percent, ways

STRENGTHS = 16
"""Equally likely ones that a hypothesis is told in."""

LOOKED_AT = 41
"""Strengths among which the nearest of two pixels' are looked for."""


def upper_bound(readings: Readings, among: Sequence[Hypothesis], presses: AnyDistribution) -> float:
    """An accuracy that no classifier of hypotheses as likely as each other surpasses."""
    curves = [_curve(readings, each, presses) for each in among]
    wrong = np.zeros((len(among), len(among)))
    for i, j in itertools.combinations(range(len(among)), 2):
        if among[i].answer != among[j].answer:
            wrong[i, j] = wrong[j, i] = confusion(curves[i], curves[j])
    return 1 - float(wrong[linear_sum_assignment(wrong, maximize=True)].mean())


def confusion(one: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    """Share of errors between two at least: equally likely readings of each, shape (k, number)."""
    size = math.lcm(len(one), len(other))
    error = ndtr(-cdist(one, other) / 2)
    error = np.repeat(np.repeat(error, size // len(one), 0), size // len(other), 1)
    return float(error[linear_sum_assignment(error, maximize=True)].mean())


def distances(
    readings: Readings,
    among: Sequence[Hypothesis],
    presses: AnyDistribution,
    spread: float | None = None,
) -> NDArray[np.float64]:
    """How far each two hypotheses of one pixel lie apart, in the meter's errors, (k, k).

    At the nearest of any two strengths that presses have or, with `spread`, where the sum of the
    squares of the distance and of both strengths' deviations from the middle over it is least.
    """
    factor = np.linspace(presses.low, presses.high, LOOKED_AT if presses.low < presses.high else 1)
    off = np.zeros_like(factor) if spread is None else ((factor - factor.mean()) / spread) ** 2
    curves = [readings.of(each, np.tile(factor, (len(each.pixels), 1))) for each in among]
    apart = np.zeros((len(among), len(among)))
    for i, j in itertools.combinations(range(len(among)), 2):
        square = cdist(curves[i], curves[j], "sqeuclidean") + off[:, None] + off
        apart[i, j] = apart[j, i] = np.sqrt(square.min())
    return apart


def _curve(
    readings: Readings, hypothesis: Hypothesis, presses: AnyDistribution
) -> NDArray[np.float64]:
    touches = len(hypothesis.pixels)
    each = round(STRENGTHS ** (1 / max(1, touches)))
    factor = together([quantiles(presses, each)] * touches).factor
    return readings.of(hypothesis, factor)


@dataclass(frozen=True)
class Sampling:
    """How accuracies are found: by so many sweeps drawn from a seed.

    against_rest, size: as of `Readings`.
    """

    seed: int
    draws: int
    against_rest: int = 0
    size: float | None = None

    def readings(self, scene: Scene, presses: AnyDistribution) -> Readings:
        """Of a scene under such presses."""
        return Readings(scene, presses, self.against_rest, self.size)

    def bayes(
        self,
        readings: Readings,
        among: Sequence[Hypothesis],
        presses: AnyDistribution,
        progress: ProgressCallback,
    ) -> Accuracy:
        """Bayes' accuracy of hypotheses under such presses."""
        return bayes(readings, among, presses, self.seed, self.draws, progress)


TARGETS = ("column", "row", "pixel")


@dataclass(frozen=True)
class Identity:
    """Bayes' accuracy and the pairwise bound on it by target; distances between pixels' sweeps.

    apart: in the meter's errors, strengths unknown, shape (pixel, pixel); names: of the pixels.
    asked: what is known and what is not, in words. laid: of touches by depth. ways: of pixels that
    are touched otherwise, where fingers press.
    """

    accuracy: dict[str, Accuracy]
    bound: dict[str, float]
    apart: NDArray[np.float64]
    names: list[str]
    asked: str
    laid: LaidErrors | None = None
    ways: Ways | None = None

    def summary(self) -> dict[str, Any]:
        """As it is written to a file."""
        own = {
            target: {**numbers(found), "pairwise_upper_bound": digits(self.bound[target], 6)}
            for target, found in self.accuracy.items()
        }
        laid, ways = ({} if e is None else e.summary() for e in (self.laid, self.ways))
        return {"asked": self.asked, **laid, **own, **ways}

    def lines(self) -> list[str]:
        """As it is printed."""
        laid = [] if self.laid is None else [f"  {self.laid.told}"]
        own = [
            f"  {target}s right: at most {percent(found)} "
            f"by any classifier (pairwise bound {100 * self.bound[target]:.1f} %)"
            for target, found in self.accuracy.items()
        ]
        ways = [] if self.ways is None else self.ways.lines()
        return [f"of a press: {self.asked}", *laid, *own, *ways]


def identity(scene: Scene, sampling: Sampling, progress: ProgressCallback = silent) -> Identity:
    """Of a known skin, pressed as the scene's experiment does."""
    presses = own_presses(scene)
    readings, size = sampling.readings(scene, presses), sampling.size
    among = {target: hypotheses(scene, target, size) for target in TARGETS}
    pixels = [each for each in among["pixel"] if each.pixels]

    def accuracy(own: Sequence[Hypothesis]) -> Accuracy:
        return sampling.bayes(readings, own, presses, progress)

    return Identity(
        {target: accuracy(own) for target, own in among.items()},
        {t: upper_bound(readings, each, presses) for t, each in among.items()},
        distances(readings, pixels, presses),
        [",".join(map(str, each.answer)) for each in pixels],
        _asked(scene, size),
        readings.laid_errors(presses),
        ways(scene, among, size, accuracy),
    )


def _asked(scene: Scene, size: float | None) -> str:
    """What a classifier that errs so little knows, and what it does not."""
    press, rest = scene.press, " or none" if scene.experiment.unpressed else ""
    where = "whole" if size is None else f"{1e3 * size:.3g} mm about its middle"
    factor = f"times {scene.pressed_factor:g}{by_finger(scene, size)}"
    spread = f", give or take {100 * press.factor_spread:.3g} % of the rise"
    return (
        f"known are the skin, that one pixel{rest} is pressed, {where}, and how strongly, {factor}"
        f"{spread if press.factor_spread else ' exactly'}; unknown is which pixel"
    )


FEWEST, MOST = 2, 12

DEVIATIONS = 2
"""Standard errors that an accuracy may lie below what is asked."""


@dataclass(frozen=True)
class Count:
    """Pixels along the side with more of them, the best accuracy, and the pairwise bound."""

    n: int
    accuracy: Accuracy
    bound: float

    def reaches(self, asked: float) -> bool:
        """Whether that accuracy cannot be excluded."""
        return self.accuracy.share + DEVIATIONS * self.accuracy.error >= asked


def counts(
    scene: Scene,
    target: str,
    asked: float,
    sampling: Sampling,
    progress: ProgressCallback = silent,
) -> Iterator[Count]:
    """From FEWEST pixels on, up to the first number that does not reach what is asked.

    Raises InputError where that is no accuracy between 0 and 1.
    """
    if not 0 < asked < 1:
        raise InputError(f"--accuracy must be > 0 and < 1, got {asked:g}")
    for n in range(FEWEST, MOST + 1):
        found = counted(scene, target, n, sampling, progress)
        yield found
        if not found.reaches(asked):
            return


def counted(
    scene: Scene,
    target: str,
    n: int,
    sampling: Sampling,
    progress: ProgressCallback = silent,
) -> Count:
    """The best accuracy with n pixels along the side with more of them."""
    divided = with_pixels(scene, n)
    presses, among = own_presses(divided), hypotheses(divided, target, sampling.size)
    readings = sampling.readings(divided, presses)
    readings.train(progress)
    bound = upper_bound(readings, among, presses)
    return Count(n, sampling.bayes(readings, among, presses, progress), bound)


def with_pixels(scene: Scene, n: int) -> Scene:
    """The same skin with n pixels along the side that has more, and as many along the other as its
    own rows and columns are to each other, rounded; at least one. A strip stays a strip."""
    own = scene.pixels.shape
    rows, columns = (max(1, round(n * each / max(own))) for each in own)
    strip = own[0] == 1, own[1] == 1 < own[0]
    return scene.on_grid(1 if strip[0] else rows, 1 if strip[1] else columns)


def shape_of(scene: Scene, n: int) -> str:
    """The pixels of `with_pixels` as rows x columns."""
    pixels = with_pixels(scene, n).pixels
    return f"{pixels.rows}x{pixels.columns}"
