"""The laws of pressed foam once more, written from what the pages say, not from the simulator."""

from __future__ import annotations

import numpy as np
from rcskin.benchmarks.accuracy.campaign_parts.problem import Tables
from scipy.optimize import brentq

PLATEAU, DENSIFICATION = 0.05, 2.3
"""Of Young's modulus, and D of the law."""


def stress(mechanics: Tables, strain: float) -> float:
    """P (1 - exp(-E e / P)) + P / D r² / (1 - r), r = e / e_D, in Pa."""
    E, r = mechanics["modulus"], strain / mechanics["densification_strain"]
    P = PLATEAU * E
    return P * (1 - np.exp(-E * strain / P)) + P / DENSIFICATION * r**2 / (1 - r)


def capacitance_factor(mechanics: Tables, strain: float) -> float:
    """eps(e) / eps(0) / (1 - e)."""
    if mechanics["effective_medium"] == "constant":
        return 1 / (1 - strain)
    return permittivity(mechanics, strain) / permittivity(mechanics, 0.0) / (1 - strain)


def permittivity(mechanics: Tables, strain: float) -> float:
    """By the implicit forms of the laws, solved for the mixture's between that of air and solid."""
    p = (mechanics["porosity"] - strain) / (1 - strain)
    solid = mechanics["solid_permittivity"]
    mixed = {
        "looyenga": lambda e: e ** (1 / 3) - (1 - p) * solid ** (1 / 3) - p,
        "lichtenecker": lambda e: np.log(e) - (1 - p) * np.log(solid),
        "bruggeman": lambda e: (1 - p) * (solid - e) / (solid + 2 * e) + p * (1 - e) / (1 + 2 * e),
        "maxwell-garnett": lambda e: (
            (e - solid) / (e + 2 * solid) - p * (1 - solid) / (1 + 2 * solid)
        ),
    }[mechanics["effective_medium"]]
    return float(brentq(mixed, 1.0, solid, xtol=1e-15, rtol=1e-15))
