"""Prior of a touch: mixtures for its strength, and for its finger."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Real
from ..press.finger import finger_capacitance
from ..press.touch import Touch
from ..scene.parts import Plan, Pressing, Skin
from ..sweeps import InputError

OVERLAP = 0.5
"""Standard deviation of each value over the step to the next: their sum is flat to 1 %."""


def normal_mixture(
    quantile: Callable[[NDArray], NDArray], count: int
) -> tuple[NDArray, NDArray, float]:
    """Values at `count` equal steps of a distribution, their probabilities and their deviation."""
    draws = quantile((np.arange(2000) + 0.5) / 2000)
    low, high = quantile(np.array([0.0, 1.0]))
    if not high > low:
        return np.array([low]), np.ones(1), 0.0
    edges = np.linspace(low, high, count + 1)
    counts, _ = np.histogram(draws, edges)
    step = edges[1] - edges[0]
    return (edges[:-1] + edges[1:]) / 2, np.maximum(counts, 1) / counts.sum(), OVERLAP * step


COUNT = 6
"""Number of capacitances, where they are drawn."""


class PixelTouch(NamedTuple):
    """One touch of a pixel: factor, capacitance of the finger in F, and probability.

    presses: True if the touch presses; its factor is uncertain then.
    """

    factor: float
    finger: float
    chance: float
    presses: bool


class FingerPrior(NamedTuple):
    """Prior of a finger.

    capacitance: F, with the probability of each (`chance`), shape (finger,). deviation: of each, F.
    alone: share of touches that do not press.
    """

    capacitance: Real
    chance: Real
    deviation: float
    alone: float

    def pixel_touches(self, factors: Real, chances: Real) -> list[PixelTouch]:
        """All touches of a pixel, those that press first; their probabilities sum to 1."""
        each = list(zip(self.capacitance.tolist(), self.chance.tolist(), strict=True))
        pressed = [
            PixelTouch(factor, C, (1 - self.alone) * by_factor * by_C, True)
            for factor, by_factor in zip(factors.tolist(), chances.tolist(), strict=True)
            for C, by_C in each
        ]
        return pressed + [PixelTouch(1.0, C, self.alone * p, False) for C, p in each if self.alone]


def finger_prior(skin: Skin, plan: Plan, presses: str) -> FingerPrior:
    """Fingers of [dataset.press] or, for presses "press", the finger of [press]."""
    drawn = plan.draws.press
    if presses == "dataset" and drawn.finger is not None:
        return FingerPrior(*normal_mixture(drawn.finger.at, COUNT), drawn.without_press or 0.0)
    alone = (drawn.without_press or 0.0) if presses == "dataset" else 0.0
    return FingerPrior(np.array([_own(skin, plan.press)]), np.ones(1), 0.0, alone)


def require_rods(skin: Skin, plan: Plan, presses: str, target: str) -> None:
    """Raises InputError where touches have fingers, which tables of some targets do not support."""
    if finger_prior(skin, plan, presses).capacitance.any():
        raise InputError(
            f"{skin.name}: localizers that invert the simulator support the target {target} for "
            "presses by a rod only; train another localizer on a data set with these fingers, or "
            "leave out the finger"
        )


def _own(skin: Skin, pressing: Pressing) -> float:
    """The finger of the scene's `press` on a whole pixel, F; 0 for a rod."""
    how = pressing.finger
    return finger_capacitance(skin, Touch(1, 1, 1.0), how) if how else 0.0
