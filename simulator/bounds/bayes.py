"""The best that any classifier can do with one sweep of a skin it knows: Bayes' decision.

Presses are drawn, read with the meter's errors, and every hypothesis is weighed by how likely the
reading is under it, strengths summed over. The mean probability of the likeliest answer is the
accuracy of the best classifier there can be; its standard error is that of the draws. The sum over
strengths takes steps of at most STEP of the meter's error, at which it is exact to 3e-4.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from ..measure.experiment import strengths, together
from ..press.batch import PressBatch
from ..progress import Progress, silent, tracked
from ..scene.randomisation import AnyDistribution
from ..scene.scene import Scene
from ..sweeps import InputError
from .readings import Hypothesis, Pixel, Readings

STEP = 1.5
FIRST_LOOK = 9
MOST_TEMPLATES = 3_000_000
AT_ONCE = 20_000_000
LEFT_OUT = 0.03
"""Of the meter's error: what readings may lose to fewer numbers."""


class Reads(Protocol):
    """A known skin and its meter: see `readings.Readings`."""

    @property
    def scene(self) -> Scene:
        """Of the skin."""
        ...

    def of(self, pixels: Sequence[Pixel], factors: NDArray[np.float64], /) -> NDArray[np.float64]:
        """The same pixels pressed in many ways."""
        ...

    def of_each(self, batch: PressBatch, /) -> NDArray[np.float64]:
        """Many presses."""
        ...


class Accuracy(NamedTuple):
    """Share of sweeps whose answer is right, and its standard error by the number of draws."""

    share: float
    error: float


@dataclass(frozen=True)
class Templates:
    """Readings to expect under all hypotheses and strengths, in few numbers.

    readings: shape (template, number). chance: of each, shape (template,). starts: of the templates
    of each answer. origin, axes: from whitened readings to those numbers.
    """

    readings: NDArray[np.float64]
    chance: NDArray[np.float64]
    starts: NDArray[np.int64]
    origin: NDArray[np.float64]
    axes: NDArray[np.float64]

    def projected(self, readings: NDArray[np.float64]) -> NDArray[np.float64]:
        """Whitened readings in those numbers; what is left out tells no two templates apart."""
        return (readings - self.origin) @ self.axes


def bayes(
    readings: Readings,
    among: Sequence[Hypothesis],
    presses: AnyDistribution,
    seed: int,
    draws: int,
    progress: Progress = silent,
) -> Accuracy:
    """The accuracy. among: in order of their answers. Raises InputError for noise too small."""
    readings.train(progress)
    known = templates(readings, among, presses, progress)
    random = np.random.default_rng(seed)
    measured = known.projected(drawn(readings, among, presses, random, draws))
    best = likeliest(known, measured)
    return Accuracy(float(best.mean()), float(best.std(ddof=1) / math.sqrt(draws)))


def templates(
    readings: Reads,
    among: Sequence[Hypothesis],
    presses: AnyDistribution,
    progress: Progress = silent,
) -> Templates:
    """All hypotheses at all strengths."""
    steps = {pixel: _steps(readings, pixel, presses) for pixel in _pixels(among)}
    count = sum(math.prod(steps[pixel] for pixel in each.pixels) for each in among)
    require_countable(count)
    found, chance = [], []
    for each in tracked(among, "readings", progress):
        every = together([strengths(presses, steps[pixel]) for pixel in each.pixels])
        found.append(readings.of(each.pixels, every.factor))
        chance.append(each.chance * every.weight)
    answers = [each.answer for each in among]
    first = [k for k, answer in enumerate(answers) if answers[max(k - 1, 0)] != answer or k == 0]
    sizes = np.cumsum([0, *(len(each) for each in chance)])
    return _in_few_numbers(np.concatenate(found), np.concatenate(chance), sizes[first])


def require_countable(templates: int) -> None:
    """Raises InputError where there are too many to compare."""
    if templates > MOST_TEMPLATES:
        raise InputError(
            f"the meter's noise is too small to sum over strengths: {templates} readings to "
            f"compare, at most {MOST_TEMPLATES}"
        )


def drawn(
    readings: Reads,
    among: Sequence[Hypothesis],
    presses: AnyDistribution,
    random: np.random.Generator,
    draws: int,
) -> NDArray[np.float64]:
    """So many readings with the meter's errors, whitened, shape (draw, number)."""
    columns = readings.scene.pixels.columns
    which = random.choice(len(among), draws, p=[each.chance for each in among])
    factors = presses.at(random.random((draws, max(len(each.pixels) for each in among) or 1)))
    cells = [np.array([i * columns + j for i, j in e.pixels], dtype=np.int64) for e in among]
    pressed = ((cells[k], f[: len(cells[k])] - 1) for k, f in zip(which, factors, strict=True))
    clean = readings.of_each(PressBatch.of(pressed))
    return clean + random.standard_normal(clean.shape)


def likeliest(known: Templates, measured: NDArray[np.float64]) -> NDArray[np.float64]:
    """Probability of the likeliest answer to each reading, shape (reading,)."""
    chunk = max(1, AT_ONCE // len(known.chance))
    parts = [measured[k : k + chunk] for k in range(0, len(measured), chunk)]
    return np.concatenate([_likeliest(known, part) for part in parts])


def _likeliest(known: Templates, measured: NDArray[np.float64]) -> NDArray[np.float64]:
    with np.errstate(divide="ignore"):
        prior = np.log(known.chance) - (known.readings**2).sum(axis=1) / 2
    likely = measured @ known.readings.T
    likely += prior
    likely -= likely.max(axis=1, keepdims=True)
    of_answer = np.add.reduceat(np.exp(likely, out=likely), known.starts, axis=1)
    return of_answer.max(axis=1) / of_answer.sum(axis=1)


def _pixels(among: Sequence[Hypothesis]) -> list[Pixel]:
    return sorted({pixel for each in among for pixel in each.pixels})


def _steps(readings: Reads, pixel: Pixel, presses: AnyDistribution) -> int:
    """How many strengths of one pixel are no further apart than STEP of the meter's error."""
    look = strengths(presses, FIRST_LOOK).factor
    if look.size == 1:
        return 1
    speed = np.linalg.norm(np.diff(readings.of([pixel], look[None]), axis=0), axis=1).max()
    return max(1, math.ceil(float(speed) * FIRST_LOOK / STEP))


def _in_few_numbers(
    readings: NDArray[np.float64], chance: NDArray[np.float64], starts: NDArray[np.int64]
) -> Templates:
    """The directions in which the readings differ, until none lies further off than LEFT_OUT."""
    origin = readings.mean(axis=0)
    centred = readings - origin
    _, axes = np.linalg.eigh(centred.T @ centred)
    axes = axes[:, ::-1]
    turned = centred @ axes
    left = (turned[:, ::-1] ** 2).cumsum(axis=1)[:, ::-1].max(axis=0)
    kept = max(1, int((left > LEFT_OUT**2).sum()))
    return Templates(turned[:, :kept].copy(), chance, starts, origin, axes[:, :kept])
