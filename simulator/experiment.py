"""A scene's experiment: every pixel pressed several times, each press a little different."""

from __future__ import annotations

import numpy as np

from simulator.press import Press, Touch
from simulator.scene import Scene

PRESSES, METER = 0, 1


def stream(scene: Scene, purpose: int) -> np.random.Generator:
    """The random numbers of one purpose (PRESSES or METER), from the scene's seed."""
    return np.random.default_rng([scene.experiment.seed, purpose])


def planned_presses(scene: Scene, random: np.random.Generator) -> list[Press]:
    """Every repetition of every pixel, and of nothing pressed where that is a class.

    The rise of capacitance (factor - 1) of a press is drawn from a normal distribution about the
    nominal one, with the scene's `factor_spread` as its relative standard deviation.
    """
    at_rest = [Press()] * (scene.experiment.repetitions if scene.experiment.unpressed else 0)
    pixels = np.ndindex(scene.pixels.rows, scene.pixels.columns)
    return at_rest + [
        Press((Touch(row + 1, column + 1, _drawn_factor(scene, random)),))
        for row, column in pixels
        for _ in range(scene.experiment.repetitions)
    ]


def _drawn_factor(scene: Scene, random: np.random.Generator) -> float:
    rise = scene.press.capacitance_factor - 1
    return float(1 + rise * (1 + scene.press.factor_spread * random.standard_normal()))
