"""Impedance of any map of capacitance on one mesh, and its exact derivatives.

The mesh conforms to cells, some along each side of a pixel; a touch is laid on them by the area it
covers. K + s M is symmetric, so the problem is its own adjoint: dY = u'(dK + s dM + ds M) u with
the potentials u of 1 V, for any number of directions and without a further solve. Nothing is
trained: a sweep with its derivatives costs some tens of milliseconds.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix

from ..fem.circuit import Drive
from ..fem.galerkin import one_blas_thread
from ..fem.lanczos import Pencil, potentials, respond
from ..models.plain import require_factor
from ..models.reduced.resolving import unreduced
from ..models.varied.meshes import circuit_of
from ..scene.frequency import laplace_variable, slopes_of_s
from ..scene.scene import Pixels, Scene
from ..sweeps import InputError

RTOL = 1e-3
CELLS_PER_PIXEL = 4
KRYLOV_RTOL = 1e-6
Maps = Mapping[str, NDArray[np.float64]]


@dataclass(frozen=True)
class Answer:
    """Z in ohm behind the leads, shape (interface, frequency), and its derivatives by name."""

    Z: NDArray[np.complex128]
    by: dict[str, NDArray[np.complex128]]


class Fields:
    """A scene on the cells of a grid, at any frequencies up to `highest`."""

    def __init__(self, scene: Scene, highest: float, cells: int = CELLS_PER_PIXEL) -> None:
        """cells: along each side of a pixel. highest: Hz."""
        pixels = scene.pixels
        self.scene, self.cells = scene, cells
        self.grid = cells * pixels.rows, cells * pixels.columns
        divided = scene.model_copy(
            update={"pixels": Pixels(rows=self.grid[0], columns=self.grid[1])}
        )
        require_factor(scene, "a limit")
        self._circuit = circuit_of(divided)
        self._family = unreduced(divided, self._circuit, RTOL, highest)

    def respond(
        self, factors: NDArray[np.float64], directions: Maps, frequency: NDArray[np.float64]
    ) -> Answer:
        """Of one map of c over that at rest, shape (row, column) of cells; frequency in Hz.

        directions: by name, how the map changes with something, of the same shape. The answer holds
        their derivatives and those of the skin's and leads' parameters (see `parameters`). Raises
        InputError where frequencies lie too far above cut-off.
        """
        masses = {name: self._mass(change) for name, change in directions.items()}
        mass = self._mass(factors)
        s = laplace_variable(frequency, self.scene.skin.foam.loss)
        with one_blas_thread():
            found = [
                self._of_drive(drive, mass, masses, s, frequency) for drive in self._circuit.drives
            ]
        Y = np.stack([own for own, _ in found])
        by = {name: np.stack([each[name] for _, each in found]) for name in found[0][1]}
        return self._at_meter(1 / Y, by, frequency)

    def _mass(self, factors: NDArray[np.float64]) -> csc_matrix:
        return self._family.mass(factors.ravel())

    def _of_drive(
        self,
        drive: Drive,
        mass: csc_matrix,
        masses: Mapping[str, csc_matrix],
        s: NDArray[np.complex128],
        frequency: NDArray[np.float64],
    ) -> tuple[NDArray[np.complex128], dict[str, NDArray[np.complex128]]]:
        space = self._family.space
        pencil = space.pencil(mass, drive, 0.0)
        Y, _ = respond(pencil, s, KRYLOV_RTOL)
        u = self._potentials(drive, pencil, mass, s, Y)
        by = {name: s * self._energy(u, each) for name, each in masses.items()}
        by_s = self._energy(u, mass)
        of_s = slopes_of_s(frequency, self.scene.skin.foam.loss)
        by |= {name: by_s * of_s[name] for name in ("capacitance", "loss_tangent")}
        return Y, by | self._by_resistance(u)

    def _potentials(
        self,
        drive: Drive,
        pencil: Pencil,
        mass: csc_matrix,
        s: NDArray[np.complex128],
        Y: NDArray[np.complex128],
    ) -> NDArray[np.complex128]:
        """u at 1 V, shape (unknown, s). Raises InputError where they do not give Y."""
        driven, space = self._family.space.driven(drive), self._family.space
        g, sheets = driven.potential, driven.floating[:, driven.common]
        if sheets.size:
            charge = space.restricted(mass) @ sheets
            g = g - sheets @ np.linalg.solve(sheets.T @ charge, charge.T @ g)
        u = g[:, None] + potentials(pencil, s, KRYLOV_RTOL)  # pyright: ignore[reportArgumentType]
        found = pencil.admittance + s * (pencil.start @ u)
        if not (np.abs(found - Y) <= RTOL * np.abs(Y)).all():
            highest = np.abs(s).max() / (2 * np.pi)
            raise InputError(f"frequencies up to {highest:.4g} Hz lie too far above cut-off")
        return u.astype(np.complex128)

    def _energy(self, u: NDArray[np.complex128], mass: csc_matrix) -> NDArray[np.complex128]:
        return (u * (self._family.space.restricted(mass) @ u)).sum(axis=0)

    def _by_resistance(self, u: NDArray[np.complex128]) -> dict[str, NDArray[np.complex128]]:
        """dY by the logarithms of resistances and of top over bottom; see `parameters`."""
        family, skin = self._family, self.scene.skin
        sheets = [
            (u * (family.space.restricted(term) @ u)).sum(axis=0) for term in family.sheet_terms
        ]
        if len(sheets) == 2:
            mismatch = (sheets[1] - sheets[0]) / 2
        else:
            top, bottom = skin.top.sheet_resistance, skin.bottom.sheet_resistance
            mismatch = sheets[0] * (bottom - top) / (bottom + top) / 2
        found = {"sheet_resistance": -np.sum(sheets, axis=0), "sheet_mismatch": mismatch}
        if any(not contact.ideal for contact in self.scene.contacts):
            films = family.space.film_energy(u, family.system.films)  # pyright: ignore[reportArgumentType]
            found["contact_resistance"] = -films.diagonal()
        return found

    def _at_meter(
        self,
        Z: NDArray[np.complex128],
        by: Mapping[str, NDArray[np.complex128]],
        frequency: NDArray[np.float64],
    ) -> Answer:
        """From admittance at the skin to impedance behind the leads."""
        leads = self.scene.leads
        by_skin, by_leads = leads.slopes(Z, frequency)
        found = {name: -(Z**2) * by_skin * slope for name, slope in by.items()}
        found |= {name: by_leads[name] for name in ("lead_resistance", "stray_capacitance")}
        return Answer(leads.seen_through(Z, frequency).astype(np.complex128), found)
