"""Fingers that a scene's touches may have, for tables: their capacitances, and what is not known.

Each stands for the normal distribution around it of one common deviation, as strengths do.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..press.finger import finger_capacitance
from ..press.touch import Touch
from ..scene.scene import Scene
from ..sweeps import InputError
from .covering import covered

COUNT = 6
"""Capacitances, where they are drawn."""


class Way(NamedTuple):
    """One way to touch a pixel: the factor under it, the finger's capacitance, F, its chance, and
    whether it presses: its factor is not known to the last then."""

    factor: float
    finger: float
    chance: float
    presses: bool


class Fingers(NamedTuple):
    """capacitance: F, with the chance of each, shape (finger,). deviation: that each stands for, F.
    alone: share of touches that do not press."""

    capacitance: NDArray[np.float64]
    chance: NDArray[np.float64]
    deviation: float
    alone: float

    def ways(self, factors: NDArray[np.float64], chances: NDArray[np.float64]) -> list[Way]:
        """All of them, those that press first; the chances of each sum to 1."""
        each = list(zip(self.capacitance.tolist(), self.chance.tolist(), strict=True))
        pressed = [
            Way(factor, C, (1 - self.alone) * by_factor * by_C, True)
            for factor, by_factor in zip(factors.tolist(), chances.tolist(), strict=True)
            for C, by_C in each
        ]
        return pressed + [Way(1.0, C, self.alone * p, False) for C, p in each if self.alone]


def fingers_of(scene: Scene, presses: str) -> Fingers:
    """As [dataset.press] draws them or, for presses "press", as [press] has one."""
    drawn = scene.dataset.press
    if presses == "dataset" and drawn.finger is not None:
        return Fingers(*covered(drawn.finger.at, COUNT), drawn.without_press or 0.0)
    alone = (drawn.without_press or 0.0) if presses == "dataset" else 0.0
    return Fingers(np.array([_own(scene)]), np.ones(1), 0.0, alone)


def require_rods(scene: Scene, presses: str, target: str) -> None:
    """Raises InputError where touches have fingers, which a target is not told of by tables."""
    if fingers_of(scene, presses).capacitance.any():
        raise InputError(
            f"{scene.name}: localizers that invert the simulator tell the {target} of presses by a "
            "rod alone; train another on a data set with these fingers, or leave out the finger"
        )


def _own(scene: Scene) -> float:
    """The finger of the scene's `press` on a whole pixel, F; 0 of a rod."""
    how = scene.press.finger
    return finger_capacitance(scene, Touch(1, 1, 1.0), how) if how else 0.0
