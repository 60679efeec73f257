"""Likelihood of presses by one sweep: what the meter observes of them, in units of its errors.

Near given presses it is linear in their unknowns. Errors of the meter's session enter linearly, and
are marginalized in closed form.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Complex, Integer, Mask, Real
from ..measure.readout import (
    ErrorModel,
    Unpressed,
    errors_of,
    observed,
    observed_slope,
    require_noise,
)
from ..press.batch import NOTHING, PressBatch
from ..scene.parts import Meter, Setup, Skin

if TYPE_CHECKING:
    from .touch_readings import Hypothesis

RIDGE = 1e-12
"""Added to the information, scaled to a unit diagonal; smaller information counts as none."""


def covariances(information: Real, wanted: int) -> Real:
    """Bound on the covariance of the first `wanted` unknowns, shape (..., wanted, wanted).

    information: with priors, shape (..., p, p). An unknown without any information has an infinite
    variance.
    """
    diagonal = np.diagonal(information, axis1=-2, axis2=-1)
    none = diagonal <= 0
    scale = np.where(none, 1.0, np.sqrt(np.maximum(diagonal, 0.0)))
    scales = scale[..., :, None] * scale[..., None, :]
    ridge = RIDGE + np.where(none, 1.0, 0.0)
    inverse = np.linalg.inv(information / scales + _on_diagonal(ridge))
    found = (inverse / scales)[..., :wanted, :wanted]
    return found + _on_diagonal(np.where(none, np.inf, 0.0)[..., :wanted])


def _on_diagonal(values: Real) -> Real:
    found = np.zeros((*values.shape, values.shape[-1]))
    along = np.arange(values.shape[-1])
    found[..., along, along] = values
    return found


LowerTriangle = Mapping[tuple[int, int], Real]
"""Entries of symmetric matrices by (row, column), row >= column, each of shape (...)."""
NUMBERS_AT_ONCE = 4_000_000


def lower_triangle(found: Real) -> LowerTriangle:
    """Lower triangle of matrices of shape (..., p, p)."""
    return {(a, b): found[..., a, b] for a in range(found.shape[-1]) for b in range(a + 1)}


def remaining(found: LowerTriangle, kept: int) -> LowerTriangle:
    """Information on the first `kept` unknowns, with the others marginalized.

    Eliminates the others one by one (Schur complements), for all cases at once. found: with priors.
    """
    left = dict(found)
    for last in range(max(found)[0], kept - 1, -1):
        for a in range(last):
            share = left[last, a] / left[last, last]
            for b in range(a + 1):
                left[a, b] = left[a, b] - share * left[last, b]
    return {place: left[place] for place in left if place[0] < kept}


def variances(found: LowerTriangle, wanted: int) -> Real:
    """Diagonals of `covariances`, fast for many; wanted: 1 or 2."""
    diagonal = [found[a, a] for a in range(max(found)[0] + 1)]
    scaled = [np.where(each > 0, (1 + RIDGE) * each, 1.0) for each in diagonal]
    whole = {(a, b): scaled[a] if a == b else entry for (a, b), entry in found.items()}
    left = remaining(whole, wanted)
    own = [np.maximum(left[a, a], RIDGE * scaled[a]) for a in range(wanted)]
    each = [1 / own[0]]
    if wanted == 2:
        size = np.maximum(own[0] * own[1] - left[1, 0] ** 2, RIDGE * own[0] * own[1])
        each = [own[1] / size, own[0] / size]
    none = np.stack(diagonal[:wanted], axis=-1) <= 0
    return np.where(none, np.inf, np.stack(each, axis=-1))


class SummedInformation:
    """Candidates whose information adds up, but for what errors hide that they share."""

    def __init__(self, information: Real, prior: Real, shared: Real | None = None) -> None:
        """information: of each without shared errors, symmetric, shape (case, candidate, p, p).

        prior: 1/deviation² of each unknown, which counts once, shape (p,). shared: products of each
        shared error with the p unknowns, then with itself, shape (case, candidate, error, p + 1);
        the deviation of an error is 1. None without shared errors.
        """
        cases, self.candidates, p, _ = information.shape
        self._lower, self._prior = np.tril_indices(p), prior.tolist()
        parts = [information.transpose(2, 3, 1, 0)[self._lower].swapaxes(0, 1)]
        if shared is not None:
            parts.append(shared.transpose(1, 2, 3, 0).reshape(self.candidates, -1, cases))
        self._shape = -1, sum(part.shape[1] for part in parts), cases
        entries = np.ascontiguousarray(np.concatenate(parts, axis=1))
        self._entries = entries.reshape(self.candidates, -1)
        """Lower triangles, then products with errors, shape (candidate, entry * case)."""

    def of(self, choices: Integer) -> Iterator[LowerTriangle]:
        """Information of choices, shape (choice, n), some at a time: entries (choice, case)."""
        step = max(1, NUMBERS_AT_ONCE // max(self._entries.shape[1], 1))
        for part in (choices[k : k + step] for k in range(0, len(choices), step)):
            times = np.zeros((len(part), self.candidates))
            np.add.at(times, (np.arange(len(part))[:, None], part), 1.0)
            yield self._left(*self._sums(times))

    def at(self, weights: Real) -> Real:
        """Information at weights of the candidates, shape (case, p, p)."""
        left, p = self._left(*self._sums(weights[None])), range(self._lower[0][-1] + 1)
        each = [[left[max(a, b), min(a, b)][0] for b in p] for a in p]
        return np.moveaxis(np.array(each), -1, 0)

    def slope(self, weights: Real, by: Real) -> Real:
        """Derivatives by the weights from those by the information, (case, p, p)."""
        rows, columns = self._lower
        both = np.where(rows == columns, 1.0, 2.0)[:, None]
        of_lower = both * by.transpose(1, 2, 0)[self._lower]
        product, size = (each[0] for each in self._sums(weights[None])[1:])
        mean = product / (1 + size)
        of_product = -2 * np.einsum("kab,ebk->eak", by, mean)
        of_size = -(of_product * mean).sum(axis=1, keepdims=True) / 2
        hidden = np.concatenate([of_product, of_size], axis=1).reshape(-1, len(by))
        return self._entries @ np.concatenate([of_lower, hidden]).ravel()

    def _sums(self, weights: Real) -> tuple[Real, Real, Real]:
        """Sums at weights (choice, candidate) over the candidates.

        Of the lower triangles (choice, entry, case), of the products of errors with the unknowns
        (choice, error, p, case), and of those with themselves (choice, error, 1, case).
        """
        found = (weights @ self._entries).reshape(len(weights), *self._shape[1:])
        count, p = len(self._lower[0]), self._lower[0][-1] + 1
        errors = (found.shape[1] - count) // (p + 1)
        shared = found[:, count:].reshape(len(found), errors, p + 1, found.shape[-1])
        return found[:, :count], shared[:, :, :p], shared[:, :, p:]

    def _left(self, lower: Real, product: Real, size: Real) -> LowerTriangle:
        """Information that errors do not hide, with the prior, entries (choice, case)."""
        mean = product / (1 + size)
        left = dict[tuple[int, int], Real]()
        for number, (a, b) in enumerate(zip(*(each.tolist() for each in self._lower), strict=True)):
            hidden = (product[:, :, a] * mean[:, :, b]).sum(axis=1)
            left[a, b] = lower[:, number] - hidden + self._prior[a] * (a == b)
        return left


Solve = Callable[[PressBatch], Complex]
"""Function from presses to Z in ohm at the contacts, shape (press, interface, frequency)."""


class Likelihood:
    """Normal likelihood of the sweep of any press of one skin.

    Errors are those at the reading of the unpressed skin: one covariance holds for all presses, so
    that distances of readings are defined. Errors of the session are marginalized.
    """

    def __init__(
        self, skin: Skin, solve: Solve, setup: Setup, meter: Meter, against_rest: int = 0
    ) -> None:
        """against_rest: number of averaged baseline sweeps that are subtracted, 0 for none.

        Raises InputError for a meter without noise.
        """
        require_noise(meter.readout)
        self.skin, self._solve, self.setup, self._meter = skin, solve, setup, meter
        self._against_rest = against_rest

    @cached_property
    def errors(self) -> ErrorModel:
        """Errors of the meter."""
        own = self.setup, self._meter, self._against_rest
        return errors_of(*own, unpressed=lambda: self.impedances(PressBatch.of([NOTHING]))[0])

    def some(self, taken: Mask) -> Likelihood:
        """The likelihood by some of the readings, True in a mask (interface, frequency)."""
        found = copy(self)
        found.errors = replace(self.errors, read=taken)
        return found

    def impedances(self, batch: PressBatch) -> Complex:
        """Readings in ohm or gains at the meter, shape (press, interface, frequency)."""
        return self.setup.at_meter(self._solve(batch))

    def observed(self, batch: PressBatch) -> Real:
        """ln |Z| and phase of all readings, shape (press, 2 * readings)."""
        return observed(self.impedances(batch))

    def whitened(self, batch: PressBatch) -> Real:
        """Readings with independent errors of deviation 1, shape (press, number)."""
        return self.errors.whitened(self.observed(batch))

    def of_presses(self, pressed: Hypothesis, factors: Real) -> Real:
        """Whitened readings of many presses of the same pixels, shape (press, number).

        factors: shape (pixel, press).
        """
        return self.whitened(PressBatch.of(pressed.on(self.skin, own) for own in factors.T - 1))


def error_model(
    setup: Setup,
    meter: Meter,
    frequency: Real,
    against_rest: int = 0,
    unpressed: Unpressed | None = None,
) -> ErrorModel:
    """Error model of a sweep of a scene with all interfaces at all frequencies, Hz.

    It is evaluated at the reading of the unpressed skin, see `errors_of`. Raises InputError for a
    meter without noise.
    """
    every = tuple(each.model_copy(update={"frequencies": None}) for each in setup.interfaces)
    reading = Setup(every, frequency, setup.leads)
    return errors_of(reading, meter, against_rest, unpressed=unpressed)


def over_noise(numbers: Real, model: ErrorModel) -> Real:
    """Observed values or slopes over the noise, shape (..., interface, frequency, 2).

    numbers: of all readings, see `observed`, shape (..., 2 * readings). They are 0 where nothing is
    read.
    """
    deviation = np.where(model.values, model.noise, np.inf)
    found = numbers.reshape(*numbers.shape[:-1], *deviation.shape) / deviation
    return np.moveaxis(found, -3, -1)


def in_noise(Z: Complex, slopes: Sequence[Complex], model: ErrorModel) -> Real:
    """Slopes of ln |Z| and phase over the noise, shape (interface, frequency, 2, slope)."""
    each = np.stack([observed_slope(Z, dZ) for dZ in slopes])
    return np.moveaxis(over_noise(each, model), 0, -1)


def session_over_noise(model: ErrorModel) -> Real:
    """Errors of the session over the noise, shape (1, interface, frequency, 2)."""
    return over_noise(model.accuracy.reshape(1, -1), model)


@dataclass(frozen=True)
class LinearLikelihood:
    """Readings of several cases, linear in the unknowns of each case, in units of the noise.

    by: derivatives of ln |Z| and phase by the unknowns, 0 where nothing is read, shape (case,
    interface, frequency, 2, unknown). session: errors of the session, of which each interface has
    one of ln |Z| and one of phase, shape (case, interface, frequency, 2), or the same for all cases
    (1, ...). prior: 1/deviation² of each unknown. weight: of each case, shape (case,).
    """

    by: Real
    session: Real
    prior: Real
    weight: Real

    @classmethod
    def of_cases(
        cls, by: Real, model: ErrorModel, prior: Real, weight: Real | None = None
    ) -> LinearLikelihood:
        """Cases by one error model. weight: the same for all cases by default, 1 in total."""
        weight = np.full(len(by), 1 / max(1, len(by))) if weight is None else weight
        return cls(by, session_over_noise(model), prior, weight)

    def some(
        self,
        interfaces: Sequence[int] | None = None,
        frequencies: Sequence[int] | None = None,
        taken: Mask | None = None,
    ) -> LinearLikelihood:
        """The likelihood of some of the readings, by indices, or by a mask (`taken`) of those left.

        taken: shape (interface, frequency).
        """
        by, session = (
            _some(_some(each, interfaces, 1), frequencies, 2) for each in (self.by, self.session)
        )
        if taken is not None:
            by, session = by * taken[:, :, None, None], session * taken[:, :, None]
        return replace(self, by=by, session=session)

    def cases(self, chosen: Mask | slice) -> LinearLikelihood:
        """The likelihood of some of the cases."""
        session = self.session if len(self.session) == 1 else self.session[chosen]
        return replace(self, by=self.by[chosen], session=session, weight=self.weight[chosen])

    @property
    def information(self) -> Real:
        """Information of the readings without priors, shape (case, p, p)."""
        x = self._whitened
        return np.einsum("cifqa,cifqb->cab", x, x, optimize=True)

    def covariances(self, wanted: int) -> Real:
        """Cramér and Rao's bound on the covariance of the first `wanted` unknowns.

        Infinite for an unknown without any information; shape (case, wanted, wanted).
        """
        return covariances(self.information + np.diag(self.prior), wanted)

    def by_interface(self) -> SummedInformation:
        """Interfaces as candidates, each at all frequencies."""
        x = self._whitened
        information = np.einsum("cifqa,cifqb->ciab", x, x, optimize=True)
        return SummedInformation(information, self.prior)

    def by_frequency(self) -> SummedInformation:
        """Frequencies as candidates, each for all interfaces."""
        x = self.by
        information = np.einsum("cifqa,cifqb->cfab", x, x, optimize=True)
        if not self.session.any():
            return SummedInformation(information, self.prior)
        error = self.session[..., None]
        own = np.broadcast_to(error, (len(x), *error.shape[1:]))
        shared = np.concatenate([error * x, error * own], axis=-1).transpose(0, 2, 1, 3, 4)
        shared = shared.reshape(*shared.shape[:2], -1, shared.shape[-1])
        there = shared[..., -1].any(axis=(0, 1))
        return SummedInformation(information, self.prior, shared[:, :, there])

    def by_reading(self) -> SummedInformation:
        """Frequencies of single interfaces as candidates, ordered by interface.

        Errors of the session are left out; with a baseline there are none.
        """
        x = self.by
        found = np.einsum("cifqa,cifqb->cifab", x, x, optimize=True)
        return SummedInformation(found.reshape(len(x), -1, *found.shape[-2:]), self.prior)

    @property
    def _whitened(self) -> Real:
        """`by`, transformed to independent errors of deviation 1; see `ErrorModel.whitened`."""
        size = (self.session**2).sum(axis=2, keepdims=True)
        if not size.any():
            return self.by
        share = (1 - 1 / np.sqrt(1 + size)) / np.where(size > 0, size, 1.0)
        error = self.session[..., None]
        return self.by - share[..., None] * error * (error * self.by).sum(axis=2, keepdims=True)


def joined(parts: Sequence[LinearLikelihood]) -> LinearLikelihood:
    """The cases of several skins by the same readings, each skin with the same weight."""
    count = len(parts)
    sessions = [np.broadcast_to(each.session, each.by.shape[:-1]) for each in parts]
    common = all(np.array_equal(each.session, parts[0].session) for each in parts)
    return LinearLikelihood(
        np.concatenate([each.by for each in parts]),
        parts[0].session if common else np.concatenate(sessions),
        parts[0].prior,
        np.concatenate([each.weight for each in parts]) / count,
    )


def _some(values: Real, which: Sequence[int] | None, axis: int) -> Real:
    """Some entries along an axis; the (large) array itself where all are wanted in order."""
    if which is None or [*which] == [*range(values.shape[axis])]:
        return values
    return np.take(values, which, axis)
