"""Deviations of sweeps: of Rs and Cp in per cent, and in standard deviations of the meter."""

from __future__ import annotations

import numpy as np
from rcskin.simulator.scene.scene import Scene

from .lines import Array
from .reduction import Complex


def resistance(Z: Complex, other: Complex) -> Array:
    """Of Rs, relatively, shape (frequency,)."""
    return Z.real / other.real - 1


def capacitance(Z: Complex, other: Complex) -> Array:
    """Of Cp, relatively, shape (frequency,)."""
    return (1 / Z).imag / (1 / other).imag - 1


def worst(Z: Complex, other: Complex) -> tuple[float, float]:
    """Largest deviation of Rs and of Cp over all frequencies, per cent."""
    of = resistance(Z, other), capacitance(Z, other)
    return tuple(100 * float(abs(each).max()) for each in of)


def sigmas(ratio: Complex, scene: Scene) -> float:
    """Norm of ln |ratio| and of its phase over all frequencies, in the meter's noise."""
    magnitude = np.log(abs(ratio)) / scene.readout.magnitude_noise
    phase = np.angle(ratio) / scene.readout.phase_noise
    return float(np.sqrt((magnitude**2 + phase**2).sum()))


def changes(
    pressed: Complex, unpressed: Complex, other: tuple[Complex, Complex], scene: Scene
) -> float:
    """By how much the change by a press differs from another pair, pressed and not; sigma."""
    return sigmas(pressed / unpressed * other[1] / other[0], scene)


def spanned(values: Array) -> str:
    """The first and the last of relative deviations, per cent."""
    return " → ".join(f"{100 * each:+.2f}" for each in (values[0], values[-1]))
