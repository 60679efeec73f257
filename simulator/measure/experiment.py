"""The presses of a scene's experiment."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..arrays import Real
from ..press.pixels import pixels_with_skin
from ..press.press import Press, pixel_pressed
from ..scene.parts import Plan, Pressing, Skin
from ..scene.randomisation import AnyDistribution, Fixed, Normal
from ..sweeps import InputError

PRESSES, METER = 0, 1


def stream(plan: Plan, purpose: int) -> np.random.Generator:
    """Random generator of one purpose (PRESSES or METER), from the scene's seed."""
    return np.random.default_rng([plan.seed, purpose])


def planned_presses(skin: Skin, plan: Plan, random: np.random.Generator) -> list[Press]:
    """Every repetition of every pixel on the skin, and of the unpressed skin if that is a class.

    Strengths are drawn from `own_presses`, separately for each. Raises what `own_presses` raises.
    """
    drawn = own_presses(skin, plan.press)
    unpressed = [Press()] * (plan.repetitions if plan.unpressed else 0)
    pixels = [each for each in pixels_with_skin(skin) for _ in range(plan.repetitions)]
    factors = np.broadcast_to(drawn.at(random.random(len(pixels))), len(pixels)).tolist()
    return unpressed + [
        Press((pixel_pressed(skin, plan.press, row, column, factor),))
        for (row, column), factor in zip(pixels, factors, strict=True)
    ]


QUANTILES = 20_001


class Strengths(NamedTuple):
    """Factors of capacitance and their weights, which sum to 1; shape (strength,)."""

    factor: Real
    weight: Real


def own_presses(skin: Skin, pressing: Pressing) -> AnyDistribution:
    """Factors by which the scene's experiment presses.

    The rise of capacitance (factor - 1) is normal about the nominal one, with the scene's
    `factor_spread` as its relative standard deviation, truncated as in data sets. Where pixels are
    pressed by depth it is the factor under the applicator. Raises InputError for presses by force,
    or if a factor might be 0 or less.
    """
    factor, spread = pressing.factor(skin), pressing.factor_spread
    if spread == 0:
        return Fixed(value=factor)
    drawn = Normal(mean=factor, deviation=abs(factor - 1) * spread)
    if drawn.low <= 0:
        most = factor / abs(factor - 1) / drawn.cut
        raise InputError(
            f"{skin.name}: `press.factor_spread` must be < {most:.3g} where factors about "
            f"{factor:g} are drawn, got {spread:g}"
        )
    return drawn


def strengths(presses: AnyDistribution, count: int) -> Strengths:
    """Distribution as `count` strengths at equal distances, each weighted by the probability around
    it."""
    if presses.low == presses.high:
        return Strengths(np.array([float(presses.low)]), np.ones(1))
    chance = np.linspace(0, 1, QUANTILES)
    edges = np.linspace(presses.low, presses.high, count + 1)
    below = np.interp(edges, presses.at(chance), chance)
    weight = np.diff(below)
    return Strengths((edges[1:] + edges[:-1]) / 2, weight / weight.sum())


def quantiles(presses: AnyDistribution, count: int) -> Strengths:
    """Distribution as `count` equally likely strengths."""
    if presses.low == presses.high:
        count = 1
    factor = presses.at((np.arange(count) + 0.5) / count)
    return Strengths(factor, np.full(count, 1 / count))


def combined_strengths(each: Sequence[Strengths]) -> Strengths:
    """All combinations of the strengths of several touches, factor of shape (touch, way)."""
    factor, weight = np.zeros((0, 1)), np.ones(1)
    for one in each:
        repeated = np.repeat(factor, len(one.factor), axis=1)
        factor = np.vstack([repeated, np.tile(one.factor, len(weight))])
        weight = np.multiply.outer(weight, one.weight).ravel()
    return Strengths(factor, weight)
