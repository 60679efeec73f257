"""Merits of candidates, at most 1 and concave in the weight of each candidate.

Accuracy: the squared distance d² of the readings of two presses is the minimum of sums of squares
over their strengths, so it is concave in the information. The sum of Phi(-d/2) over all pairs is at
least the error of the best classifier of known strengths. It is convex in d², so the share of
correct answers is concave.

Position: the errors of x and y of a touch are at least Cramér and Rao's bound. 1 / (the trace of
its part for x and y) is concave in the information, and the root of that trace is convex. The merit
is 1 minus this root mean square distance over that of a guess.

Information adds up over readings, minus what the session's errors may hide, which is a concave
function of the weights of the candidates. A merit (see `merits`) is concave in the information.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from ..arrays import Integer, Real
from ..bounds.fisher_information import (
    LowerTriangle,
    SummedInformation,
    lower_triangle,
    remaining,
)
from ..bounds.touch_readings import Hypothesis
from ..mesh.pixel_coverage import pixel_coverage
from ..press.batch import PressBatch
from ..scene.parts import Pressing, Skin
from ..sweeps.free_space import check_memory
from .skin_readout import SkinReadout

TINY = 1e-12
FARTHEST_STRENGTH = 10.0
"""Prior standard deviation of a touch's strength, over the unpressed capacitance."""


class MeritValue(NamedTuple):
    """A merit and its derivative by the information, as a sum of weighted outer products.

    value: shape (...). vectors: w, shape (..., case, k, p). coefficients: c, shape
    (..., case, k). The derivative is the sum of c w w'.
    """

    value: Real
    vectors: Real
    coefficients: Real

    def slope(self) -> Real:
        """Derivative by the information of each case, shape (..., case, p, p)."""
        weighed = self.vectors * self.coefficients[..., None]
        return np.einsum("...ka,...kb->...ab", weighed, self.vectors)


class Merit(Protocol):
    """Function of the information (..., case, p, p) and the weight of each case (case,)."""

    def value(self, found: LowerTriangle, weight: Real, /) -> NDArray:
        """The merit without its derivative, shape (...), which is faster. Entries: (..., case)."""
        ...

    def __call__(self, found: Real, weight: Real, /) -> MeritValue:
        """The merit and its derivative."""
        ...


@dataclass(frozen=True)
class AccuracyMerit:
    """Share of correct sweeps, by pairs.

    Row 0 of the information is the difference of a pair, the others are its strengths in standard
    deviations.
    """

    def value(self, found: LowerTriangle, weight: Real) -> NDArray:
        """See `Merit`."""
        strengths, _ = max(found)
        known = [0.0] + [1.0] * strengths
        squared = np.maximum(remaining(found, known, 1)[0, 0], 0.0)
        return 1 - ndtr(-np.sqrt(squared) / 2) @ weight

    def __call__(self, found: Real, weight: Real) -> MeritValue:
        """weight: share of all sweeps that is wrong if a pair is always confused."""
        own = found + np.diag([0.0] + [1.0] * (found.shape[-1] - 1))
        direction = np.ones(own.shape[:-1])
        if own.shape[-1] > 1:
            direction[..., 1:] = -np.linalg.solve(own[..., 1:, 1:], own[..., 1:, :1])[..., 0]
        squared = np.maximum((own[..., 0, :] * direction).sum(axis=-1), 0.0)
        value = 1 - ndtr(-np.sqrt(squared) / 2) @ weight
        d = np.sqrt(np.maximum(squared, TINY))
        by = weight * np.exp(-squared / 8) / (math.sqrt(2 * math.pi) * 4 * d)
        return MeritValue(value, direction[..., None, :], by[..., None])


@dataclass(frozen=True)
class PositionMerit:
    """Precision of positions; the unknowns are x, y in m and the strength.

    room: range of positions along x and y, m.
    """

    room: tuple[float, float]

    @property
    def guess(self) -> float:
        """Root mean square distance of a guess, m, at which the merit is 0."""
        return math.hypot(*self.room) / math.sqrt(12)

    @property
    def known(self) -> Real:
        """Prior 1/deviation² of x, y and strength, shape (3,)."""
        smallest = 1e-3 * max(self.room)
        sides = [12 / max(side, smallest) ** 2 for side in self.room]
        return np.array([*sides, FARTHEST_STRENGTH**-2])

    def value(self, found: LowerTriangle, weight: Real) -> NDArray:
        """See `Merit`."""
        left = remaining(found, self.known.tolist(), 2)
        xx, xy, yy = left[0, 0], left[1, 0], left[1, 1]
        return 1 - np.sqrt((xx + yy) / (xx * yy - xy**2)) @ weight / self.guess

    def __call__(self, found: Real, weight: Real) -> MeritValue:
        """weight: of each position, 1 in total."""
        inverse = np.linalg.inv(found + np.diag(self.known))
        vectors = inverse[..., :2, :].astype(np.float64)
        far = np.sqrt(vectors[..., 0, 0] + vectors[..., 1, 1])
        value = 1 - far @ weight / self.guess
        by = weight / (2 * far * self.guess)
        return MeritValue(value, vectors, np.repeat(by[..., None], 2, axis=-1))


NEAREST = 10
"""Number of nearest hypotheses that are compared with each; more distant ones hardly matter."""
BYTES_FOR_NUMBER = 16
"""Memory for each pair of presses, doubled while their equations are solved."""
SAME = 1e-3
"""Separation in the meter's errors below which presses are equal, as mirror images are."""


@dataclass(frozen=True)
class Pairs:
    """Pairs of hypotheses of one skin that have different answers.

    separation: difference of their readings, then its change by one standard deviation of each
    strength, over the noise; shape (pair, reading, frequency, 2, 1 + strengths). weight: share of
    all sweeps that is wrong if a pair is always confused, shape (pair,).
    """

    separation: Real
    weight: Real

    def of(self, readings: Sequence[int], frequencies: Sequence[int]) -> Pairs:
        """The pairs at some of the readings and frequencies."""
        return Pairs(_some(_some(self.separation, readings, 1), frequencies, 2), self.weight)


def check_comparable(skin: Skin, target: str) -> None:
    """Raises InputError where all pairs of hypotheses of a target do not fit in memory."""
    touches = 2 if target == "pair" else 1
    count = math.comb(len(pixel_coverage(skin).numbers), touches)
    check_memory(
        BYTES_FOR_NUMBER * (count * (1 + 2 * touches)) ** 2,
        "a comparison of all pairs of presses on {} x {} pixels".format(*skin.pixels.shape),
        "give fewer `pixels`",
    )


def _some(values: Real, which: Sequence[int], axis: int) -> Real:
    """Some entries along an axis; the (large) array itself where all are wanted in order."""
    every = range(values.shape[axis])
    return values if [*which] == [*every] else np.take(values, which, axis)


def pairs(
    on: SkinReadout, among: Sequence[Hypothesis], frequency: Real, against_rest: int
) -> Pairs:
    """Nearest pairs of hypotheses, at all candidates of a skin.

    against_rest: number of averaged baseline sweeps that are subtracted, 0 for none. The noise is
    that of readings of the unpressed skin.
    """
    middle, slopes = _expected(on, among, frequency, against_rest)
    chosen = _nearest(middle, slopes, [each.answer for each in among])
    one, other = chosen.T
    parts = [middle[one] - middle[other], *np.moveaxis(slopes[one], 1, 0)]
    parts += list(-np.moveaxis(slopes[other], 1, 0))
    chance = np.array([each.chance for each in among])
    return Pairs(np.stack(parts, axis=-1), chance[one] + chance[other])


def _expected(
    on: SkinReadout, among: Sequence[Hypothesis], frequency: Real, against_rest: int
) -> tuple[Real, Real]:
    """Readings (hypothesis, reading, frequency, 2) and slopes (hypothesis, touch, ...) over noise.

    Strengths of the touches are one standard deviation above or below their mean, in all
    combinations. The mean over these is the reading, differences are the slopes.
    """
    touches = max(len(each.pixels) for each in among)
    signs = np.array(list(itertools.product((-1.0, 1.0), repeat=touches))).reshape(-1, touches)
    likelihood = on.likelihood(frequency, against_rest)
    found = likelihood.observed(_presses(on.parts.skin, on.parts.plan.press, among, signs))
    shape = len(among), len(signs), 2, -1, len(frequency)
    scale = np.moveaxis(likelihood.errors.noise, 0, -1)
    each = np.moveaxis(found.reshape(shape), 2, -1) / scale
    slopes = np.einsum("hs...,st->ht...", each, signs / len(signs))
    return each.mean(axis=1), slopes


def _presses(skin: Skin, press: Pressing, among: Sequence[Hypothesis], signs: Real) -> PressBatch:
    """All combinations of hypotheses and signs of strength."""
    rises = (press.capacitance_factor - 1) * (1 + press.factor_spread * signs)
    return PressBatch.of(each.on(skin, rise) for each in among for rise in rises)


def _nearest(middle: Real, slopes: Real, answers: Sequence[tuple[int, ...]]) -> Integer:
    """Index pairs (one, other), one < other: each hypothesis with its NEAREST others."""
    names = {answer: k for k, answer in enumerate(dict.fromkeys(answers))}
    number = np.array([names[answer] for answer in answers])
    squared = _profiled(middle, slopes)
    squared[number[:, None] == number] = np.inf
    nearest = np.argsort(squared, axis=1, kind="stable")[:, :NEAREST]
    one = np.repeat(np.arange(len(middle)), nearest.shape[1])
    other, found = nearest.ravel(), np.take_along_axis(squared, nearest, axis=1).ravel()
    kept = np.isfinite(found) & (found > SAME**2)
    return np.unique(np.sort(np.column_stack([one, other])[kept], axis=1), axis=0)


def _profiled(middle: Real, slopes: Real) -> Real:
    """Squared distances at the strengths that minimize them, shape (one, other).

    All terms are products of readings and slopes, which are computed once.
    """
    count, touches = slopes.shape[:2]
    flat, turned = middle.reshape(count, -1), slopes.reshape(count * touches, -1)
    flat = flat - flat.mean(axis=0)
    of_middle = flat @ flat.T
    across = (turned @ flat.T).reshape(count, touches, count)
    of_slopes = (turned @ turned.T).reshape(count, touches, count, touches)
    own = np.diagonal(of_middle)
    squared = own[:, None] + own - 2 * of_middle
    at = np.arange(count)
    along = across[at, :, at][:, None] - across.transpose(0, 2, 1)
    along = np.concatenate([along, along.transpose(1, 0, 2)], axis=2)
    gram = np.empty((count, count, 2 * touches, 2 * touches))
    gram[..., :touches, :touches] = of_slopes[at, :, at][:, None]
    gram[..., touches:, touches:] = of_slopes[at, :, at]
    gram[..., :touches, touches:] = -of_slopes.transpose(0, 2, 1, 3)
    gram[..., touches:, :touches] = -of_slopes.transpose(0, 2, 3, 1)
    gram += np.eye(2 * touches)
    hidden = (along * np.linalg.solve(gram, along[..., None])[..., 0]).sum(axis=-1)
    return squared - hidden


ACCURACY = AccuracyMerit()
MERIT_DIGITS = 6
"""Digits of a merit that are compared."""


@dataclass(frozen=True)
class SessionPrecision:
    """Prior 1/deviation² of the meter's gain and phase errors of a session, in units of noise.

    Infinite where these errors cancel.
    """

    gain: float = math.inf
    phase: float = math.inf

    @property
    def both(self) -> Real:
        """Both values, shape (2,)."""
        return np.array([self.gain, self.phase])


def by_reading(
    pairs: Pairs, session: SessionPrecision, merit: Merit = ACCURACY
) -> AdditiveCandidates:
    """Readings as candidates, each at all the frequencies of the pairs."""
    x, count = pairs.separation, pairs.separation.shape[2]
    found = np.einsum("prfqa,prfqb->prab", x, x, optimize=True)
    common = x.sum(axis=2)
    return AdditiveCandidates(
        found - _hidden_information(common, session.both + count), pairs.weight, merit
    )


def by_frequency(
    pairs: Pairs, session: SessionPrecision, merit: Merit = ACCURACY
) -> AdditiveCandidates | TiedFrequencies:
    """Frequencies as candidates, each for all the readings of the pairs."""
    if not math.isinf(session.gain) or not math.isinf(session.phase):
        return TiedFrequencies(pairs, session, merit)
    x = pairs.separation
    return AdditiveCandidates(
        np.einsum("prfqa,prfqb->pfab", x, x, optimize=True), pairs.weight, merit
    )


def by_both(pairs: Pairs, merit: Merit = ACCURACY) -> AdditiveCandidates:
    """Frequencies of single readings as candidates, ordered by reading; needs a baseline."""
    x = pairs.separation
    found = np.einsum("prfqa,prfqb->prfab", x, x, optimize=True)
    return AdditiveCandidates(found.reshape(len(x), -1, *found.shape[-2:]), pairs.weight, merit)


def _hidden_information(common: Real, prior: Real) -> Real:
    """Information that unknown gain and phase errors hide, shape (pair, reading, p, p)."""
    return np.einsum("prqa,prqb,q->prab", common, common, 1 / prior)


class AdditiveCandidates:
    """Candidates whose information adds up, shape (case, candidate, p, p), symmetric."""

    def __init__(self, information: Real, weight: Real, merit: Merit = ACCURACY) -> None:
        """weight: of each case, shape (case,)."""
        self._summed, self.candidates = SummedInformation(information), information.shape[1]
        self._merit, self._weight = merit, weight

    def score(self, choices: Integer) -> Real:
        """1 minus the merit of choices, shape (choice, n) to (choice,)."""
        parts = self._summed.of(choices)
        return np.concatenate([_remaining(self._merit.value(p, self._weight)) for p in parts])

    def slope(self, weights: Real) -> tuple[float, Real]:
        """The merit at weights of the candidates, and its exact derivatives by them."""
        result = self._merit(self._summed.at(weights), self._weight)
        return float(result.value), self._summed.slope(result.slope())


class TiedFrequencies:
    """Frequencies of readings with unknown gain and phase errors that are common to all of them."""

    def __init__(self, pairs: Pairs, session: SessionPrecision, merit: Merit = ACCURACY) -> None:
        self.candidates, self._pairs, self._session = pairs.separation.shape[2], pairs, session
        self._merit = merit

    def score(self, choices: Integer) -> Real:
        """See `AdditiveCandidates`."""
        result = []
        for choice in choices:
            part = Pairs(self._pairs.separation[:, :, choice], self._pairs.weight)
            found, _ = self._information(part, np.ones(len(choice)))
            result.append(_remaining(self._merit.value(lower_triangle(found), part.weight)))
        return np.array(result)

    def slope(self, weights: Real) -> tuple[float, Real]:
        """See `AdditiveCandidates`."""
        found, common = self._information(self._pairs, weights)
        result = self._merit(found, self._pairs.weight)
        left = self._pairs.separation - common[:, :, None]
        by = np.einsum("prfqa,prfqb,pab->f", left, left, result.slope(), optimize=True)
        return float(result.value), by

    def _information(self, pairs: Pairs, weights: Real) -> tuple[Real, Real]:
        """Information without what the session's errors hide, and the mean over frequencies.

        The mean, weighted by the session's errors, has shape (pair, reading, 2, p).
        """
        x, prior = pairs.separation, self._session.both + weights.sum()
        weighed = x * weights[:, None, None]
        found = np.einsum("prfqa,prfqb->pab", weighed, x, optimize=True)
        common = weighed.sum(axis=2)
        found = found - _hidden_information(common, prior).sum(axis=1)
        return found, common / prior[:, None]


def _remaining(merit: Real) -> Real:
    """1 minus a merit, to be minimized, rounded to the digits that are compared."""
    return np.round(1 - merit, MERIT_DIGITS) + 10.0**-MERIT_DIGITS
