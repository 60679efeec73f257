"""How strongly presses press: a distribution as a sum over strengths, and draws from it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simulator.distribution import AnyDistribution, Fixed, Normal
from simulator.scene import Scene

QUANTILES = 20_001


class Strengths(NamedTuple):
    """Factors of capacitance and their weights, which sum to 1; shape (strength,)."""

    factor: NDArray[np.float64]
    weight: NDArray[np.float64]


def own_presses(scene: Scene) -> AnyDistribution:
    """The factors that the scene's experiment presses with."""
    factor, spread = scene.press.capacitance_factor, scene.press.factor_spread
    if spread == 0:
        return Fixed(value=factor)
    return Normal(mean=factor, deviation=abs(factor - 1) * spread)


def strengths(presses: AnyDistribution, count: int) -> Strengths:
    """The distribution as so many strengths a step apart, weighed by what lies around each."""
    if presses.low == presses.high:
        return Strengths(np.array([float(presses.low)]), np.ones(1))
    chance = np.linspace(0, 1, QUANTILES)
    edges = np.linspace(presses.low, presses.high, count + 1)
    below = np.interp(edges, presses.at(chance), chance)
    weight = np.diff(below)
    return Strengths((edges[1:] + edges[:-1]) / 2, weight / weight.sum())


def quantiles(presses: AnyDistribution, count: int) -> Strengths:
    """The distribution as so many equally likely strengths."""
    if presses.low == presses.high:
        count = 1
    factor = presses.at((np.arange(count) + 0.5) / count)
    return Strengths(factor, np.full(count, 1 / count))


def together(each: Sequence[Strengths]) -> Strengths:
    """Strengths of several touches in all ways, factor of shape (touch, way)."""
    factor, weight = np.zeros((0, 1)), np.ones(1)
    for one in each:
        repeated = np.repeat(factor, len(one.factor), axis=1)
        factor = np.vstack([repeated, np.tile(one.factor, len(weight))])
        weight = np.multiply.outer(weight, one.weight).ravel()
    return Strengths(factor, weight)
