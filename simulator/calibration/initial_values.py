"""Where a fit begins: the scene's own values, and what the sweep's two ends say at a glance."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping

import numpy as np

from ..models.line_slopes import LineModel
from ..scene.scene import Scene
from .measurements import Measurements
from .problem import FitSpec, LeastSquaresProblem

SHARES = (0.03, 0.1, 0.3, 1.0)
"""Of the largest resistance read: what may be the skin's and not the leads'."""
LOW_FREQUENCY = 3.0
"""Resistance of a line over its Rs at low frequency."""
STEPS = (0.0, -0.5, 0.5)
NEAR = 1000.0
"""Chi-squared over how many numbers there are, below which a fit begins where it is."""
FAR = math.log(2)
LEAST_INDUCTANCE = 1e-4
LOSSY = 0.95


def initial_values(problem: LeastSquaresProblem) -> list[dict[str, float]]:
    """Values of all parameters to begin at: several for a line, else the nearest of a coarse grid.

    A grid, because a fit by a reduced model costs more than a look at each of its points.
    """
    asked, around = problem.spec, problem.around
    own = asked.values(asked.unknowns({n: p.center for n, p in asked.fitted.items()}))
    if isinstance(around.model, LineModel):
        return [own, *({**own, **_fitted_only(asked, each)} for each in _of_line(asked))]
    begun = own | {name: at for name, at in around.about.items() if name in asked.fitted}
    if _misfit(problem, begun) < NEAR * asked.measurements.numbers:
        return [begun]
    return [min(_grid(begun, asked), key=lambda values: _misfit(problem, values))]


def _grid(values: Mapping[str, float], asked: FitSpec) -> list[dict[str, float]]:
    """Steps up and down of the sheets and of the foam, the values themselves first."""
    steps = [
        STEPS if name in asked.fitted else (0.0,) for name in ("sheet_resistance", "capacitance")
    ]
    return [
        {
            **values,
            "sheet_resistance": values["sheet_resistance"] + sheets,
            "capacitance": values["capacitance"] + foam,
        }
        for sheets, foam in itertools.product(*steps)
    ]


def _misfit(problem: LeastSquaresProblem, values: Mapping[str, float]) -> float:
    residuals = problem.residuals(problem.spec.unknowns(values))
    return float(residuals @ residuals)


def capacitance_off(measured: Measurements) -> float:
    """Logarithm of what the lowest frequency shows over the scene's capacitance, 0 where near."""
    frequency, Z = measured.first
    if Z.imag[0] >= 0:
        return 0.0
    shown = -1 / (2 * np.pi * frequency[0] * Z.imag[0])
    off = math.log(shown / total_capacitance(measured.scene))
    return off if abs(off) > FAR else 0.0


def total_capacitance(scene: Scene) -> float:
    """Of the skin at rest, F."""
    skin = scene.skin
    return skin.foam.unpressed_capacitance_per_area * skin.length * skin.width


def _fitted_only(asked: FitSpec, values: Mapping[str, float]) -> dict[str, float]:
    return {name: value for name, value in values.items() if name in asked.fitted}


def _of_line(asked: FitSpec) -> list[dict[str, float]]:
    """The line's share of the resistance from little to all of it."""
    scene, (frequency, Z) = asked.measurements.scene, asked.measurements.first
    omega = 2 * np.pi * frequency
    total, floor = float(Z.real.max()), float(np.abs(Z.real).min())
    skin, edge = scene.skin, scene.contacts[0].edge
    squares = skin.length / skin.width if edge in ("left", "right") else skin.width / skin.length
    sheets = skin.both_sheets * squares
    shown = abs(1 / (omega[0] * Z.imag[0]))
    inductance = max(float(Z.imag[-1]), LEAST_INDUCTANCE * abs(Z[-1])) / omega[-1]
    return [
        {
            "sheet_resistance": math.log(LOW_FREQUENCY * share * total / sheets),
            "capacitance": math.log(shown / total_capacitance(scene)),
            "lead_resistance": floor / 2,
            "lead_inductance": float(inductance),
            "phase_exponent": exponent,
        }
        for share in SHARES
        for exponent in (1.0, LOSSY)
    ]
