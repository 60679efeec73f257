"""One press on one mesh, in trial functions of two orders: the answer, and what checks it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simulator.answer import Rung
from simulator.circuit import Circuit
from simulator.estimate import Swept, checked
from simulator.frequency import Loss, laplace_variable
from simulator.galerkin import Galerkin
from simulator.sheet import one_blas_thread, swept
from simulator.unknowns import on_cells
from simulator.varied.coefficients import Coefficients
from simulator.varied.elements import Elements
from simulator.varied.system import PressedSystem

LESS_GAINED = 2.0
"""How much less than on plain skins the next order may gain, at the worst of singularities: where a
foil ends at an inner corner, or in a sheet that conducts far better along one direction. Without
it one of some fifty random skins was off by more than was told; with it, of forty others none by
more than a third of that."""


@dataclass(frozen=True)
class Solved:
    """Trial functions of one order, and the system that their space is taken from."""

    space: Galerkin
    system: PressedSystem
    elements: Elements


@dataclass(frozen=True)
class Discretised:
    """told: the mesh in words. error: relative, of the capacitance where it is pressed. coarser: of
    an order less than `coarse`, where the one finer may agree with it by chance.
    """

    circuit: Circuit
    loss: Loss
    coefficients: Coefficients
    coarse: Solved
    fine: Solved
    told: str
    error: float = 0.0
    coarser: Solved | None = None

    def rung(self, frequency: NDArray[np.float64], rtol: float) -> Rung:
        """The answer at these frequencies in Hz, and its error.

        Parts of the error may cancel in the difference of two orders alone, in Rs or in Cp: the
        geometric mean with the larger one covers that.
        """

        def sweep(around: NDArray[np.float64], tolerance: float) -> list[Swept]:
            s = laplace_variable(around, self.loss)
            drives = self.circuit.drives
            with one_blas_thread():
                return [
                    swept(each.space, each.system.mass, drives, s, tolerance)
                    for each in (self.coarse, self.fine, self.coarser)
                    if each is not None
                ]

        Z, error = checked(sweep, frequency, rtol)
        both = np.sqrt(error * error.max(axis=0))
        return Rung(self.told, self.coarse.space.inner, Z, LESS_GAINED * both + self.error)

    def coefficients_of(self, solved: Solved, drive: int, s: complex) -> NDArray:
        """Potentials of 1 V at s in rad/s, real or complex, shape (field, function, cell)."""
        with one_blas_thread():
            v = solved.space.potentials(solved.system.mass, self.circuit.drives[drive], s)
        return on_cells(solved.system.unknowns, solved.elements.trial, v)
