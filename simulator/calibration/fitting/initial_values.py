"""Initial values of a fit: the scene's own, and estimates from both ends of the sweep."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping

import numpy as np

from ...models.line_slopes import LineModel
from ...scene.parts import Skin
from .fit_options import FitSpec
from .measurements import Measurements
from .problem import LeastSquaresProblem

SHARES = (0.03, 0.1, 0.3, 1.0)
"""Shares of the largest measured resistance that may be the skin's and not the leads'."""
LOW_FREQUENCY = 3.0
"""Resistance of a line over its Rs at low frequency."""
STEPS = (0.0, -0.5, 0.5)
NEAR = 1000.0
"""Chi-squared per number, below which a fit begins at the center of its model."""
FAR = math.log(2)
MIN_INDUCTANCE_SHARE = 1e-4
LOSSY = 0.95


def initial_values(problem: LeastSquaresProblem) -> list[dict[str, float]]:
    """Initial values of all parameters: several for a line, else the best of a coarse grid.

    Evaluating the grid costs less than one fit with a reduced model.
    """
    spec, model = problem.spec, problem.model
    own = spec.values(spec.unknowns({n: p.center for n, p in spec.fitted.items()}))
    if isinstance(model.model, LineModel) and not spec.measurements.parts.setup.gain:
        return [own, *({**own, **_fitted_only(spec, each)} for each in _of_line(spec))]
    begin = own | {name: at for name, at in model.center.items() if name in spec.fitted}
    if _misfit(problem, begin) < NEAR * spec.measurements.numbers:
        return [begin]
    return [min(_grid(begin, spec), key=lambda values: _misfit(problem, values))]


def _grid(values: Mapping[str, float], spec: FitSpec) -> list[dict[str, float]]:
    """Steps up and down of the sheets and of the foam, the values themselves first."""
    steps = [
        STEPS if name in spec.fitted else (0.0,) for name in ("sheet_resistance", "capacitance")
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


def capacitance_offset(measured: Measurements) -> float:
    """Logarithm of the capacitance at the lowest frequency over the scene's; 0 where near."""
    frequency, Z = measured.first
    if measured.parts.setup.gain or Z.imag[0] >= 0:
        return 0.0
    shown = -1 / (2 * np.pi * frequency[0] * Z.imag[0])
    offset = math.log(shown / total_capacitance(measured.parts.skin))
    return offset if abs(offset) > FAR else 0.0


def total_capacitance(skin: Skin) -> float:
    """Capacitance of the unpressed skin, F."""
    return skin.foam.unpressed_capacitance_per_area * skin.length * skin.width


def _fitted_only(spec: FitSpec, values: Mapping[str, float]) -> dict[str, float]:
    return {name: value for name, value in values.items() if name in spec.fitted}


def _of_line(spec: FitSpec) -> list[dict[str, float]]:
    """Initial values of a line, with shares of the resistance from little to all of it."""
    scene, (frequency, Z) = spec.measurements.parts, spec.measurements.first
    omega = 2 * np.pi * frequency
    total, floor = float(Z.real.max()), float(np.abs(Z.real).min())
    skin, edge = scene.skin, scene.skin.contacts[0].edge
    squares = skin.length / skin.width if edge in ("left", "right") else skin.width / skin.length
    sheets = skin.both_sheets * squares
    shown = abs(1 / (omega[0] * Z.imag[0]))
    inductance = max(float(Z.imag[-1]), MIN_INDUCTANCE_SHARE * abs(Z[-1])) / omega[-1]
    return [
        {
            "sheet_resistance": math.log(LOW_FREQUENCY * share * total / sheets),
            "capacitance": math.log(shown / total_capacitance(scene.skin)),
            "lead_resistance": floor / 2,
            "lead_inductance": float(inductance),
            "phase_exponent": exponent,
        }
        for share in SHARES
        for exponent in (1.0, LOSSY)
    ]
