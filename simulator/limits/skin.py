"""What is not known of a skin: its parameters, with the spread that sessions of a data set have."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from simulator.distribution import AnyDistribution
from simulator.scene import Scene

QUANTILES = 4001


def deviations(scene: Scene, parameters: Iterable[str]) -> dict[str, float]:
    """Standard deviation of each of `parameters` by [dataset.session], of those that vary.

    Counted as in `parameters`: factors by their logarithm. The mismatch of sheets is that of two
    independent factors, of which half also counts as both sheets' resistance.
    """
    drawn = scene.dataset.session
    single = _deviation(drawn.sheet_mismatch, logarithm=True)
    known = {
        "sheet_resistance": math.hypot(
            _deviation(drawn.sheet_resistance, logarithm=True), single / math.sqrt(2)
        ),
        "sheet_mismatch": single * math.sqrt(2),
        "capacitance": _deviation(drawn.capacitance, logarithm=True),
        "contact_resistance": _deviation(drawn.contact_resistance, logarithm=True),
        "loss_tangent": _deviation(drawn.loss_tangent),
        "lead_resistance": _deviation(drawn.lead_resistance),
        "stray_capacitance": _deviation(drawn.stray_capacitance),
    }
    return {name: known[name] for name in parameters if known.get(name, 0) > 0}


def pixel_maps(scene: Scene, cells: int) -> dict[str, NDArray[np.float64]]:
    """Where each pixel lies on a grid of so many cells along its sides, (row, column) of cells."""
    rows, columns = scene.pixels.rows, scene.pixels.columns
    units = np.eye(rows * columns).reshape(-1, rows, columns)
    return {
        f"foam {k}": np.kron(unit, np.ones((cells, cells))).astype(np.float64)
        for k, unit in enumerate(units)
    }


def _deviation(distribution: AnyDistribution, *, logarithm: bool = False) -> float:
    values = distribution.at((np.arange(QUANTILES) + 0.5) / QUANTILES)
    return float(np.std(np.log(values) if logarithm else values))
