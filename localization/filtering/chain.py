"""Touches over time: their rates, and a hidden Markov model whose state may change within a sweep.

The model is the forward pass of L. R. Rabiner, Proc. IEEE 77 (1989) 257-286, section III A. If the
state changes within a sweep, the readings before the cut are of one state and those after it of
another.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np

from ...simulator.arrays import Integer, Mask, Real
from ...simulator.sweeps import InputError

MIN_LIKELIHOOD = 1e-300


@dataclass(frozen=True)
class TouchDynamics:
    """Mean durations of exponential distributions, and a speed.

    lasts: duration of a touch, s. every: time from a touch's end to the next one, s. speed: speed
    of a touch along the skin, mm/s; it keeps its direction for a second. Raises InputError for a
    value that is not above 0.
    """

    lasts: float = 2.0
    every: float = 5.0
    speed: float = 20.0

    def __post_init__(self) -> None:
        for each in fields(self):
            value = getattr(self, each.name)
            if not 0 < value < math.inf:
                raise InputError(f"`touch-{each.name}` must be above 0, got {value:g}")

    def crossings(self, width: float) -> float:
        """Rate in 1/s at which a touch leaves a part of the skin of this width in mm.

        If it crosses the part within a second, the rate is that of a random walk: speed² / width².
        """
        return self.speed / width * max(1.0, self.speed / width)


@dataclass(frozen=True, eq=False)
class Cut:
    """ln likelihood of each state by a sweep's readings before a cut and after it, (state,)."""

    before: Real
    after: Real


@dataclass(frozen=True, eq=False)
class Evidence:
    """Likelihoods of one sweep.

    whole: ln likelihood of each state throughout, (state,). cuts: for changes within the sweep.
    """

    whole: Real
    cuts: tuple[Cut, ...] = ()


@dataclass(frozen=True, eq=False)
class Belief:
    """Probability of each state, shape (state,).

    changed: probability of a change to another kind of state within the sweep.
    """

    states: Real
    changed: float = 0.0


@dataclass(frozen=True, eq=False)
class Chain:
    """Reversible Markov chain in continuous time.

    stationary: weight of each state in equilibrium, (state,). flows: equilibrium flow between each
    pair of states, 1/s, symmetric, (state, state); the diagonal is not used. kinds: number of each
    state's kind, (state,); changes within a kind do not count as changes. None makes each state a
    kind of its own.
    """

    stationary: Real
    flows: Real
    kinds: Integer | None = None

    def propagated(self, weights: Real, seconds: float) -> Real:
        """Weights of states after some seconds: w exp(Q t), shape (state,)."""
        power, turn = self._modes
        root = np.sqrt(self.stationary)
        found = ((weights / root) @ turn * np.exp(power * seconds)) @ turn.T * root
        return np.maximum(found, 0.0)

    def start(self) -> Belief:
        """Belief before the first sweep."""
        return Belief(self.stationary / self.stationary.sum())

    def after(self, belief: Belief, seconds: float) -> Belief:
        """Belief some seconds later, without a sweep in between."""
        return Belief(_normal(self.propagated(belief.states, seconds))) if seconds > 0 else belief

    def updated(self, belief: Belief, evidence: Evidence, seconds: float) -> Belief:
        """Belief after a sweep of this duration, given the belief at its start.

        Either the state stays, or it changes at one of the cuts or at the start or the end, where
        changes are half as likely as at a cut.
        """
        alpha, stay = belief.states, np.exp(-self._leaving * seconds)

        def changed(weights: Real) -> Real:
            return np.maximum(self.propagated(weights, seconds) - weights * stay, 0.0)

        top = max([evidence.whole.max(), *(c.before.max() + c.after.max() for c in evidence.cuts)])
        whole, share = np.exp(evidence.whole - top), 1 / (len(evidence.cuts) + 1)
        at_ends = changed(alpha) * whole + changed(alpha * whole)
        within, within_kind = np.zeros_like(alpha), 0.0
        for cut in evidence.cuts:
            last = cut.after.max()
            early, late = alpha * np.exp(cut.before + last - top), np.exp(cut.after - last)
            within += changed(early) * late
            within_kind += sum((changed(early * kind) * late)[kind].sum() for kind in self._members)
        steady, within = alpha * stay * whole + share / 2 * at_ends, share * within
        total = (steady + within).sum()
        if not total > MIN_LIKELIHOOD:
            return Belief(_normal(self.propagated(alpha, seconds)), 1.0)
        return Belief(
            (steady + within) / total, float((within.sum() - share * within_kind) / total)
        )

    @cached_property
    def _members(self) -> list[Mask]:
        """Masks of the states of each kind that has several."""
        if self.kinds is None:
            return []
        members = [self.kinds == kind for kind in np.unique(self.kinds)]
        return [each for each in members if each.sum() > 1]

    @cached_property
    def _rates(self) -> Real:
        rates = self.flows / self.stationary[:, None]
        np.fill_diagonal(rates, 0.0)
        return rates - np.diag(rates.sum(axis=1))

    @property
    def _leaving(self) -> Real:
        return -np.diag(self._rates)

    @cached_property
    def _modes(self) -> tuple[Real, Real]:
        root = np.sqrt(self.stationary)
        symmetric = self._rates * root[:, None] / root
        power, turn = np.linalg.eigh((symmetric + symmetric.T) / 2)
        return np.minimum(power, 0.0), turn


def _normal(weights: Real) -> Real:
    return weights / weights.sum()
