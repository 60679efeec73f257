"""A sweep sampled at a few frequencies, and a rational function of s put through the samples.

AAA: Nakatsukasa, Sete, Trefethen, SIAM J. Sci. Comput. 40 (2018) A1494. Quotient of polynomials
by least squares: C. Sanathanan, J. Koerner, IEEE Trans. Automat. Control 8 (1963) 56.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.scene import Scene
from scipy.interpolate import AAA

SAMPLES = 20
DECADES = 2.3
RTOL_OF_SAMPLES = 1e-8
BELOW_ALL, NEARLY = 1e-3, 1e-2
ROUNDS = 8


@dataclass(frozen=True)
class Fit:
    """A rational function of s / unit; its poles in rad/s; the lowest sample in rad/s."""

    function: Callable[[NDArray], NDArray]
    poles: NDArray[np.complex128]
    unit: float
    lowest: float

    def impedance(self, frequencies: NDArray) -> NDArray:
        """Z in ohm; frequencies in Hz."""
        return self.function(2j * np.pi * np.asarray(frequencies) / self.unit)

    @property
    def poles_off_axis(self) -> int:
        """How many poles lie elsewhere than on s <= 0, where those of every passive skin lie.

        One far below the samples stands for the pole of the capacitance at s = 0.
        """
        at_zero = abs(self.poles) < BELOW_ALL * self.lowest
        on_axis = (self.poles.real < 0) & (abs(self.poles.imag) < NEARLY * abs(self.poles))
        return int((~(at_zero | on_axis)).sum())


def aaa(frequencies: NDArray, Z: NDArray) -> Fit:
    """Interpolation at samples chosen one by one, at both signs of the frequency."""
    s, unit = _scaled(frequencies)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        function = AAA(np.concatenate([s, -s]), np.concatenate([Z, Z.conj()]))
    return Fit(function, unit * function.poles().astype(np.complex128), unit, unit * abs(s).min())


def polynomials(frequencies: NDArray, Z: NDArray, degree: int = 8) -> Fit:
    """N/D with real coefficients: the smallest |N - Z D| / |Z D'|, D' the D of the round before."""
    s, unit = _scaled(frequencies)
    powers = np.vander(s, degree + 1)
    size = abs(Z).max()
    rows = np.hstack([powers / (Z[:, None] / size), -powers])
    N, D = np.zeros(degree + 1), np.eye(degree + 1)[-1]
    for _ in range(ROUNDS):
        weighted = rows / abs(np.polyval(D, s))[:, None]
        *_, right = np.linalg.svd(np.vstack([weighted.real, weighted.imag]))
        N, D = np.split(right[-1], 2)

    def function(x: NDArray) -> NDArray:
        return size * np.polyval(N, x) / np.polyval(D, x)

    return Fit(function, unit * np.roots(D).astype(np.complex128), unit, unit * abs(s).min())


def sampled(
    scene: Scene, press: Press, frequencies: NDArray, digits: int | None = None
) -> tuple[NDArray, NDArray]:
    """Frequencies in Hz around those asked, and Z there; |Z| and phase rounded to `digits`."""
    middle = np.sqrt(np.min(frequencies) * np.max(frequencies))
    half = 10 ** (DECADES / 2) * np.sqrt(np.max(frequencies) / np.min(frequencies))
    at = np.geomspace(middle / half, middle * half, SAMPLES)
    sweep = scene.sweep.model_copy(update={"frequencies": tuple(at.tolist())})
    there = scene.model_copy(update={"sweep": sweep})
    Z = Solver(there.parts, RTOL_OF_SAMPLES).solve(press).Z[0]
    if digits is None:
        return at, Z
    shown = [[float(f"{x:.{digits}g}") for x in part] for part in (abs(Z), np.angle(Z, deg=True))]
    return at, np.array(shown[0]) * np.exp(1j * np.radians(shown[1]))


def impedance(
    scene: Scene,
    press: Press,
    frequencies: NDArray,
    fit: Callable[[NDArray, NDArray], Fit] = aaa,
    digits: int | None = None,
) -> NDArray:
    """Z between the samples of a sweep over 2.3 decades (or as much more as is asked)."""
    return fit(*sampled(scene, press, frequencies, digits)).impedance(frequencies)


def _scaled(frequencies: NDArray) -> tuple[NDArray, float]:
    unit = float(2 * np.pi * np.sqrt(frequencies.min() * frequencies.max()))
    return 2j * np.pi * frequencies / unit, unit
