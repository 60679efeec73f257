"""Random sizes, sheets, frequencies and tolerances."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.accuracy.campaign_parts.problem import Tables

Rng = np.random.Generator
U_RANGE = (1e-3, 1e3)
FREQUENCIES = 3
EXACTLY_LOOSEST = 0.15
EXTREME = 0.15
"""How often a size, a factor or a ratio comes from far beyond what is built."""
LOOSEST, DECADES = 1e-3, 3.0
"""Tolerances from LOOSEST down over DECADES, the tightest the rarest: they cost most."""


def logarithmic(rng: Rng, low: float, high: float) -> float:
    """A positive number, its logarithm evenly distributed."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def usual_or_extreme(rng: Rng, usual: tuple[float, float], extreme: tuple[float, float]) -> float:
    """A positive number of one range or, now and then, of the wider one."""
    return logarithmic(rng, *(extreme if rng.random() < EXTREME else usual))


def tolerance(rng: Rng, decades: float = DECADES) -> float:
    """Of two digits; often the loosest, at which other orders of elements serve."""
    if rng.random() < EXACTLY_LOOSEST:
        return LOOSEST
    return float(f"{LOOSEST * 10 ** (-decades * rng.random() ** 2):.1e}")


def charging(rng: Rng, low: float = U_RANGE[0], high: float = U_RANGE[1]) -> NDArray[np.float64]:
    """u = omega R C L² of a few frequencies, one drawn from each part of the decades."""
    marks = np.geomspace(low, high, FREQUENCIES + 1)
    return np.array([logarithmic(rng, a, b) for a, b in zip(marks, marks[1:], strict=False)])


def skin(rng: Rng) -> Tables:
    """A rectangle of even sheets and foam."""
    top = logarithmic(rng, 1e3, 1e6)
    apart = usual_or_extreme(rng, (0.1, 10.0), (1e-4, 1e4))
    bottom = top * (1.0 if rng.random() < 0.3 else apart)
    return {
        "length": usual_or_extreme(rng, (0.05, 0.2), (0.02, 0.4)),
        "width": usual_or_extreme(rng, (0.05, 0.2), (0.02, 0.4)),
        "top": {"sheet_resistance": top},
        "bottom": {"sheet_resistance": bottom},
        "foam": {"capacitance_per_area": logarithmic(rng, 1e-9, 2e-8)},
    }


def pixels(rng: Rng) -> Tables:
    """Up to four a side."""
    return {"rows": int(rng.integers(1, 5)), "columns": int(rng.integers(1, 5))}


def anisotropy(rng: Rng) -> Tables:
    """Better or worse along any direction, or along an axis."""
    angle = rng.uniform(0, np.pi) if rng.random() < 0.8 else rng.choice([0.0, np.pi / 2])
    return {"ratio": usual_or_extreme(rng, (0.1, 10.0), (0.01, 100.0)), "angle": float(angle)}


def piezoresistance(rng: Rng) -> float:
    """Sheets that conduct worse where they are pressed, and some that conduct better."""
    return float(rng.uniform(0, 5) if rng.random() < 0.8 else rng.uniform(-0.8, 0))


def grid_map(rng: Rng) -> Tables:
    """Of a few values, kinks between them."""
    rows, columns = rng.integers(1, 5, 2)
    values = np.exp(rng.uniform(-0.7, 0.7, (rows, columns)))
    return {"kind": "grid", "values": values.tolist()}


def smooth_map(rng: Rng, longest: float) -> Tables:
    """A gradient or a random field. longest: the skin's longer side, m."""
    if rng.random() < 0.5:
        x, y = rng.uniform(-0.9, 0.9, 2)
        return {"kind": "gradient", "x": float(x), "y": float(y)}
    return {
        "kind": "random",
        "deviation": float(rng.uniform(0.05, 0.4)),
        "correlation_length": float(rng.uniform(0.1, 0.5)) * longest,
        "seed": int(rng.integers(1000)),
    }
