"""How far touches by depth that are laid on cells are from touches with their own edges."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...fem.estimate import relative_difference
from ...fem.safety import SAMPLED
from ...models.mechanics.lattice.presses import Applied
from ...models.mechanics.lattice.skin import Lattice
from ...models.mechanics.lattice.triangles import as_press, traced
from ...models.solver import Solver
from ...press.batch import PressBatch
from ...scene.scene import Scene

SAMPLE = 8
"""Touches that are compared; all are of one size, and about as deep."""
RTOL = 1e-4

Impedances = Callable[[PressBatch], NDArray[np.complex128]]


class LaidErrors(NamedTuple):
    """Largest relative errors of Rs and Cp to expect, SAMPLED times those of a sample.

    cells: by cells and lattice together, against the full model. deflection: of that by the
    lattice, against the membrane on triangles laid on the same cells.
    """

    cells: float
    deflection: float

    def summary(self) -> dict[str, float]:
        """As it is written to a file, by the names that data sets have for it."""
        return {
            "cells_error": float(f"{self.cells:.2g}"),
            "deflection_error": float(f"{self.deflection:.2g}"),
        }

    @property
    def told(self) -> str:
        """As it is printed."""
        return (
            f"touches by depth are laid on cells, which changes Rs and Cp by up to {self.cells:.1e}"
            f"; the lattice that the foam gives way on makes up to {self.deflection:.1e} of it"
        )


def laid_errors(
    scene: Scene,
    lattice: Lattice,
    each: Sequence[Applied],
    own: PressBatch,
    impedances: Impedances,
) -> LaidErrors:
    """Of some touches. own: the same as they are laid on the lattice's cells. impedances: of
    presses of these, behind the leads, ohm. Raises InputError and ToleranceError as `Solver`."""
    solver = Solver(scene, RTOL)
    at_skin = np.stack([solver.solve(as_press(applied)).Z for applied in each])
    exact = scene.leads.seen_through(at_skin, scene.frequencies)
    found = impedances(own)
    by_triangles = impedances(PressBatch.of(traced(scene, lattice, applied) for applied in each))
    cells, deflection = (
        SAMPLED * float(relative_difference(found, truth).max()) for truth in (exact, by_triangles)
    )
    return LaidErrors(cells, deflection)


def some(count: int) -> list[int]:
    """Numbers of at most SAMPLE of so many, evenly."""
    return np.unique(np.linspace(0, count - 1, min(count, SAMPLE)).round().astype(int)).tolist()
