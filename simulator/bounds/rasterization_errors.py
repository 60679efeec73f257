"""Errors of touches by depth that are rasterized on cells."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

import numpy as np

from ..arrays import Complex
from ..fem.error_estimate import SAMPLED
from ..models.mechanics.lattice_presses import as_press, traced
from ..models.mechanics.relaxation_kernel import Bodies
from ..models.mechanics.skin_lattice import Lattice
from ..models.solution import reading_difference
from ..models.solver import Solver
from ..press.batch import PressBatch
from ..press.press import Press
from ..scene.parts import SceneParts
from ..sweeps.reading_quantities import IMPEDANCE

SAMPLE = 8
"""Largest number of compared touches; all have one size and similar depths."""
RTOL = 1e-4

Impedances = Callable[[PressBatch], Complex]


class RasterizationErrors(NamedTuple):
    """Estimated largest relative errors of readings: SAMPLED times those of a sample.

    cells: of cells and lattice together, compared with the full model. deflection: of the lattice
    alone, compared with the membrane on triangles, rasterized on the same cells. quantities: names
    of those with these errors.
    """

    cells: float
    deflection: float
    quantities: tuple[str, ...] = IMPEDANCE.with_errors

    def summary(self) -> dict[str, float]:
        """Content of a file, by the names that data sets use."""
        return {
            "cells_error": float(f"{self.cells:.2g}"),
            "deflection_error": float(f"{self.deflection:.2g}"),
        }

    @property
    def sentence(self) -> str:
        """Line for the terminal."""
        return (
            f"touches by depth are rasterized on cells: error of {' and '.join(self.quantities)} "
            f"up to {self.cells:.1e}, of which the lattice of the deflection causes up to "
            f"{self.deflection:.1e}"
        )


def rasterization_errors(
    parts: SceneParts,
    lattice: Lattice,
    each: Sequence[Bodies],
    own: PressBatch,
    impedances: Impedances,
) -> RasterizationErrors:
    """Errors of a sample of touches.

    own: the touches rasterized on the lattice's cells. impedances: function from presses of these
    cells to readings. Raises InputError and ToleranceError as `Solver` does.
    """
    found = impedances(own)
    cells = error_against_solver(parts, map(as_press, each), found, RTOL)
    by_triangles = impedances(
        PressBatch.of(traced(parts.skin, lattice, applied) for applied in each)
    )
    kind = parts.setup.kind
    deflection = float(reading_difference(found, by_triangles, kind).max())
    return RasterizationErrors(SAMPLED * cells, SAMPLED * deflection, kind.with_errors)


def error_against_solver(
    parts: SceneParts, presses: Iterable[Press], found: Complex, rtol: float
) -> float:
    """Largest relative error of given readings, for some presses.

    The reference is the full model, which resolves every edge, at `rtol`. Raises as `Solver` does.
    """
    solver = Solver(parts, rtol)
    exact = np.stack([solver.solve(press).Z for press in presses])
    return float(reading_difference(found, exact, parts.setup.kind).max())


def sample_indices(count: int) -> list[int]:
    """Indices of at most SAMPLE of `count` items, evenly spread."""
    return np.unique(np.linspace(0, count - 1, min(count, SAMPLE)).round().astype(int)).tolist()
