"""What leads make of a skin's impedance, and of what it may be off by."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.accuracy.campaign_parts.problem import Problem, Route, Truth
from rcskin.simulator.scene.meter import Leads

AT_45_DEGREES = 4.0
"""Error of X over that of R and of |Z|² omega Cp, where Cp does not tell X."""


def through_leads(problem: Problem, skin: Route) -> Route:
    """Z' = R + Z / (1 + j omega C Z) of what a route says of the skin alone."""
    leads, frequency = problem.scene.leads, problem.scene.frequencies

    def route(rtol: float) -> Truth:
        return _seen(leads, 2 * np.pi * frequency, skin(rtol))

    return route


def _seen(leads: Leads, omega: NDArray[np.float64], skin: Truth) -> Truth:
    passed = 1 / (1 + 1j * omega * (1 - leads.guard) * leads.stray_capacitance * skin.Z)
    Z = leads.resistance + 1j * omega * leads.inductance + skin.Z * passed
    off_R, off_X = _of_parts(skin)
    turned = passed**2
    real = np.abs(turned.real) * off_R + np.abs(turned.imag) * off_X
    imaginary = np.abs(turned.imag) * off_R + np.abs(turned.real) * off_X
    R, X = Z.real, Z.imag
    of_B = np.abs(X**2 - R**2) * imaginary + 2 * np.abs(R * X) * real
    return Truth(Z, np.stack([real / np.abs(R), of_B / (np.abs(X) * np.abs(Z) ** 2)]))


def _of_parts(skin: Truth) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """What R and X may be off by, ohm, from Rs and Cp; B = -X / |Z|²."""
    R, X, of_Rs, of_Cp = skin.Z.real, skin.Z.imag, *skin.doubt
    off_R, off_B = of_Rs * np.abs(R), of_Cp * np.abs(X)
    with np.errstate(divide="ignore"):
        off_X = (np.abs(skin.Z) ** 2 * off_B + 2 * np.abs(X * R) * off_R) / np.abs(X**2 - R**2)
    return off_R, np.minimum(off_X, AT_45_DEGREES * np.maximum(off_R, off_B))
