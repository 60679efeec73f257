"""Hypotheses about touches, from a simulator's tables: mean, spread and prior of each."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from scipy.special import softmax

from ...simulator.arrays import Integer, Real
from ..parts.plain import Plain, Sizes, is_close, require

RANK = 8
"""Directions kept of each entry's spread."""
NUMBERS_AT_ONCE = 2**22
"""Approximate count of numbers in memory at once."""


@dataclass(frozen=True, eq=False)
class Mixture(Plain):
    """Entries N(mean, (1 - G'G)^-1), each with its prior probability.

    mean: shape (entry, number). directions: G, shape (entry, rank, number). log_weight: logarithm
    of the probability times the normal distribution's constant without 2 pi, shape (entry,). along:
    G mean, shape (entry, rank).
    """

    mean: Annotated[Real, "E F"]
    directions: Annotated[Real, "E r F"]
    along: Annotated[Real, "E r"]
    log_weight: Annotated[Real, "E log"]

    def _check(self, sizes: Sizes) -> None:
        along = np.einsum("ern,en->er", self.directions, self.mean)
        require(is_close(self.along, along), "along", "must be of its `directions` and `mean`")

    @property
    def power(self) -> Real:
        """Variance in addition to the noise along each direction of spread, (entry, rank)."""
        shrunk = (self.directions**2).sum(axis=2)
        return shrunk / np.maximum(1 - shrunk, 1e-12)

    @property
    def spread(self) -> Real:
        """B, reduced to the stored rank, shape (entry, number, rank)."""
        return np.swapaxes(self.directions * np.sqrt(1 + self.power)[..., None], 1, 2)

    @property
    def log_chance(self) -> Real:
        """ln of the prior probability of each entry, shape (entry,)."""
        return self.log_weight + np.log1p(self.power).sum(axis=1) / 2

    def of(self, numbers: NDArray[np.intp]) -> Mixture:
        """The mixture restricted to some of the numbers."""
        return mixture(self.mean[:, numbers], self.spread[:, numbers], np.exp(self.log_chance))

    def distances(self, X: Real) -> Real:
        """Squared Mahalanobis distance of sweeps from entries, shape (sweep, entry)."""
        entries, rank, _ = self.directions.shape
        part = max(1, NUMBERS_AT_ONCE // (entries * rank))
        flat = self.directions.reshape(entries * rank, -1)
        found = np.empty((len(X), entries))
        for start in range(0, len(X), part):
            x = X[start : start + part]
            off = (x**2).sum(axis=1)[:, None] - 2 * x @ self.mean.T + (self.mean**2).sum(axis=1)
            along = (x @ flat.T).reshape(len(x), entries, rank) - self.along
            found[start : start + part] = off - (along**2).sum(axis=2)
        return np.maximum(found, 0.0)

    def log_joint(self, distances: Real) -> Real:
        """ln of prior times density of sweeps at these distances, up to a constant."""
        return self.log_weight - distances / 2

    def responsibilities(self, distances: Real) -> Real:
        """Posterior probability of each entry, shape (sweep, entry)."""
        return softmax(self.log_joint(distances), axis=1)


def mixture(mean: Real, spread: Real, weight: Real) -> Mixture:
    """Entries N(mean, 1 + B B'). spread: B, shape (entry, number, column). weight: prior."""
    power, turn = np.linalg.eigh(np.swapaxes(spread, 1, 2) @ spread)
    power, turn = np.maximum(power[:, -RANK:], 0.0), turn[:, :, -RANK:]
    directions = np.swapaxes((spread @ turn) / np.sqrt(1 + power)[:, None], 1, 2)
    log_weight = np.log(weight) - np.log1p(power).sum(axis=1) / 2
    along = np.einsum("ern,en->er", directions, mean)
    return Mixture(mean, np.ascontiguousarray(directions), along, log_weight)


def joined(parts: list[Mixture]) -> Mixture:
    """The mixture of all entries of the parts, in order."""
    return Mixture(
        np.concatenate([part.mean for part in parts]),
        np.concatenate([part.directions for part in parts]),
        np.concatenate([part.along for part in parts]),
        np.concatenate([part.log_weight for part in parts]),
    )


NONE = -1
AT_ONCE = 500
"""Number of entries whose spread is computed at once, to limit memory."""


@dataclass(frozen=True, eq=False)
class Hypotheses:
    """Entries: the unpressed skin, then touches with strengths, in units of the meter's noise.

    mean: shape (entry, number). slope: change for one standard deviation of the strength within the
    entry, for each touch, (entry, number, touch). place, strength: indices of pixels and strengths,
    NONE for no touch, (entry, touch). weight: prior of the place, (entry,). strengths: prior of
    each strength, (strength,). skin: effect of the unknowns of the skin on a touch, (place,
    strength, number, unknown). shift: known correction of a touch, (place, strength, number).
    """

    mean: Real
    slope: Real
    place: Integer
    strength: Integer
    weight: Real
    strengths: Real
    skin: Real
    shift: Real

    def means(self, entries: slice | NDArray) -> Real:
        """Means with the known corrections, shape (entry, number)."""
        return self.mean[entries] + self._summed(self.shift, entries)

    def spread(self, entries: slice | NDArray) -> Real:
        """Columns of strengths, then of the skin, shape (entry, number, column)."""
        return np.concatenate([self.slope[entries], self._summed(self.skin, entries)], axis=2)

    def chances(self, entries: slice | NDArray) -> Real:
        """Prior of place and strengths together, shape (entry,)."""
        strength = self.strength[entries]
        each = np.where(strength == NONE, 1.0, self.strengths[strength])
        return self.weight[entries] * each.prod(axis=1)

    def mixture(self) -> Mixture:
        """The entries as normal distributions."""
        parts = [slice(k, k + AT_ONCE) for k in range(0, len(self.mean), AT_ONCE)]
        return joined(
            [mixture(self.means(part), self.spread(part), self.chances(part)) for part in parts]
        )

    def _summed(self, of_touch: NDArray, entries: slice | NDArray) -> Real:
        """Sum over the touches of each entry."""
        place, strength = self.place[entries], self.strength[entries]
        there = (place != NONE).reshape(*place.shape, *(1,) * (of_touch.ndim - 2))
        return np.where(there, of_touch[place, strength], 0.0).sum(axis=1)


def hypotheses(tables: Mapping[str, NDArray], target: str, noise: Real) -> Hypotheses:
    """All hypotheses for the answers of a target. noise: standard deviation of each number."""
    two = "pairs" in tables and target in ("touches", "pair")
    most = 2 if two else 1
    shape = tables["single"].shape
    place, strength = np.indices(shape[:2]).reshape(2, -1, 1)
    chance = _chances(tables["chances"][: most + 1])
    count = shape[0]
    single = Hypotheses(
        mean=(tables["single"] / noise).reshape(-1, shape[2]),
        slope=(tables["spread"] * tables["slope"] / noise).reshape(-1, shape[2], 1),
        place=place,
        strength=strength,
        weight=np.full(place.size, chance[1] / count),
        strengths=tables["weights"],
        skin=tables["skin"] / noise[:, None],
        shift=tables["shift"] / noise,
    )
    found = _with_unpressed(single, chance[0])
    return _with_pairs(found, tables, noise, chance[2]) if two else found


def _chances(given: Real) -> Real:
    """Prior of 0, 1 (and 2) touches, each at least 0.01 before it is normalized."""
    chance = np.maximum(given, 0.01)
    return chance / chance.sum()


def _with_unpressed(single: Hypotheses, chance: float) -> Hypotheses:
    def first(a: NDArray, value: float) -> NDArray:
        return np.concatenate([np.full((1, *a.shape[1:]), value, dtype=a.dtype), a])

    return replace(
        single,
        mean=first(single.mean, 0.0),
        slope=first(single.slope, 0.0),
        place=first(single.place, NONE),
        strength=first(single.strength, NONE),
        weight=first(single.weight, chance),
    )


def _with_pairs(
    known: Hypotheses, tables: Mapping[str, NDArray], noise: Real, chance: float
) -> Hypotheses:
    pairs, values = tables["pairs"], tables["pair"] / noise
    numbers, strengths = values.shape[-1], len(known.strengths)
    pair, *strength = np.indices(values.shape[:3]).reshape(3, -1)
    slope = np.zeros((*values.shape, 2))
    if strengths > 1:
        slopes = [np.gradient(values, tables["strengths"], axis=k, edge_order=2) for k in (1, 2)]
        slope = tables["spread"] * np.stack([np.asarray(each) for each in slopes], axis=-1)

    def wider(a: NDArray, value: float) -> NDArray:
        return np.concatenate([a, np.full_like(a, value)], axis=-1)

    return replace(
        known,
        mean=np.concatenate([known.mean, values.reshape(-1, numbers)]),
        slope=np.concatenate([wider(known.slope, 0.0), slope.reshape(-1, numbers, 2)]),
        place=np.concatenate([wider(known.place, NONE), pairs[pair]]),
        strength=np.concatenate([wider(known.strength, NONE), np.stack(strength, axis=1)]),
        weight=np.concatenate([known.weight, np.full(pair.size, chance / len(pairs))]),
    )


def labels(known: Hypotheses, pixels: Integer, target: str) -> Integer | NDArray[np.str_]:
    """The answer of each entry, as in `targets.labels`, shape (entry,).

    pixels: row and column of each place.
    """
    touched = known.place != NONE
    if target == "touches":
        return touched.sum(axis=1)
    if target in ("row", "column"):
        of_place = pixels[known.place[:, 0], ("row", "column").index(target)]
        return np.where(touched[:, 0], of_place, 0)
    names = np.array([f"{row},{column}" for row, column in pixels], dtype=object)
    found = ["+".join(names[own[own != NONE]]) or "0,0" for own in known.place]
    return np.array(found)
