"""Impedance of any map of capacitance on one mesh, and its exact derivatives.

The mesh conforms to cells, several along each side of a pixel; a touch is rasterized on them by the
area it covers. K + s M is symmetric, so the problem is its own adjoint: dY = u'(dK + s dM + ds M) u
with the potentials u of 1 V, for any number of directions and without another solve. There is no
training: a sweep with its derivatives takes some tens of milliseconds.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.sparse import csc_matrix

from ..arrays import Complex, Real
from ..fem.error_estimate import ROUNDING
from ..fem.factors import LowRankMass, Mass, one_blas_thread
from ..fem.galerkin import Galerkin
from ..fem.lanczos import Pencil, potentials, respond
from ..fem.terminals import Combination, Excitation, combination
from ..models.heterogeneous.elements_model import circuit_of
from ..models.heterogeneous.materials import gauge_slopes, gauged
from ..models.parameters import by_sheets
from ..models.reduced.family import Weights, weights_under
from ..models.reduced.family_meshes import unreduced
from ..models.solution import Response, at_meter
from ..scene.air_nodes import LOSSLESS_FOAM, air_nodes
from ..scene.frequency import laplace_variable, slopes_of_s
from ..scene.parts import SceneParts
from ..sweeps import InputError
from .part_maps import PartMaps

Maps = Mapping[str, Real]
"""Maps of c over the unpressed c, or of its changes, by name."""
RTOL = 1e-3
CELLS_PER_PIXEL = 4
KRYLOV_RTOL = 1e-6


class _Pressed(NamedTuple):
    """Space of a press, its M in F, and the changes of M and of sheet weights by each direction.

    mass: in the pattern of the system. foam: share of the foam, and masses: changes, both for the
    unknowns of the space. rtol: of Lanczos' method.
    """

    space: Galerkin
    weights: Weights
    mass: Mass
    foam: csc_matrix
    masses: Mapping[str, csc_matrix]
    gauges: Mapping[str, Real | None]
    skin_unknown: bool
    rtol: float


class FullFields:
    """A scene on the cells of a grid, at any frequencies up to `highest`."""

    def __init__(self, parts: SceneParts, highest: float, cells: int = CELLS_PER_PIXEL) -> None:
        """cells: along each side of a pixel. highest: Hz."""
        self.parts, self.cells, divided = parts, cells, parts.divided(cells)
        self.grid = divided.skin.pixels.shape
        self._circuit = circuit_of(divided.skin, divided.setup)
        self._family = unreduced(divided.skin, divided.plan, self._circuit, RTOL, highest)

    def respond(
        self, factors: Real, directions: Maps, frequency: Real, of_foam: Maps | None = None
    ) -> Response:
        """Response of one map of c over the unpressed c, shape (row, column) of cells.

        With fingers the map has shape (2, row, column): c, then the F of fingers in each cell.
        directions: derivatives of the map by name, of the same shape. frequency: Hz. of_foam:
        changes of the foam itself, which do not change how far it is pressed; None where the skin
        is known. The response has derivatives by both and by the leads' parameters and, unless the
        skin is known, by the skin's (see `parameters`). Raises InputError where frequencies are too
        far above cut-off.
        """
        of_maps, edges = self._maps, self._maps.edges(factors, directions)
        pressed = of_maps.pressed(factors, edges)
        foam = pressed[of_maps.foam]
        weights = weights_under(None, self._family.skin, self._circuit, 1, foam)
        maps = {
            name: of_maps.by_press(name, each, foam, edges) for name, each in directions.items()
        }
        if of_foam is not None:
            maps |= {name: of_maps.by_foam(each, foam, edges) for name, each in of_foam.items()}
            maps |= of_maps.by_skin(pressed)
        space, in_air = self._family.space_of(weights), of_maps.parts.in_air
        gauges = {name: self._gauged(foam, change) for name, change in directions.items()}
        air = LOSSLESS_FOAM
        if pressed[in_air].any():
            air = air_nodes(frequency, self.parts.skin.foam.loss, KRYLOV_RTOL)

        def with_air(factor: float) -> tuple[Complex, dict[str, Complex]]:
            parts = np.where(in_air, factor, 1.0)
            masses = {name: self._family.masses.mass(parts * each) for name, each in maps.items()}
            return self._solved(
                _Pressed(
                    space,
                    weights,
                    self._family.mass(parts * pressed),
                    self._own(self._family.masses.mass(np.where(in_air, 0.0, pressed))),
                    {name: self._own(mass) for name, mass in masses.items()},
                    gauges,
                    of_foam is not None,
                    KRYLOV_RTOL * air.precision,
                ),
                frequency,
            )

        Y, by = map(list, zip(*(with_air(factor) for factor in air.factors.tolist()), strict=True))
        Z = (1 / air.mean(Y)).astype(np.complex128)
        found = {name: air.mean(each[name] for each in by) for name in by[0]}
        return at_meter(Z, found, self.parts.setup.at(frequency))

    def _solved(self, on: _Pressed, frequency: Real) -> tuple[Complex, dict[str, Complex]]:
        """Y of the interfaces and its derivatives, with one s for all capacitance."""
        s, combined = laplace_variable(frequency, self.parts.skin.foam.loss), self._combined
        with one_blas_thread():
            found = [
                self._excitation_response(excitation, on, s, frequency)
                for excitation in self._circuit.excitations
            ]
        Y = combined.admittance(np.stack([own for own, _ in found])).astype(np.complex128)
        by = {name: np.stack([each[name] for _, each in found]) for name in found[0][1]}
        return Y, {name: combined.admittance(each) for name, each in by.items()}

    @cached_property
    def _combined(self) -> Combination:
        """Combination of the solved excitations to interfaces."""
        return combination(self._circuit.excitations)

    @cached_property
    def _maps(self) -> PartMaps:
        return PartMaps(self._family.skin, self.parts.plan.press)

    @cached_property
    def _sheet_terms(self) -> list[csc_matrix]:
        return [self._own(term) for term in self._family.sheet_terms]

    def _own(self, matrix: csc_matrix) -> csc_matrix:
        """A matrix for the unknowns of the space, without stored zeros."""
        own = self._family.space.restricted(matrix).copy()
        own.eliminate_zeros()
        return own

    def _gauged(self, foam: Real, change: Real) -> Real | None:
        """Change of the weights of the sheet terms of K; None where no press changes them."""
        if not gauged(self._family.skin):
            return None
        by_factor = gauge_slopes(self._family.skin, foam)[: self._circuit.fields]
        return (by_factor * self._maps.of_foam(change, 0.0)).ravel()

    def _excitation_response(
        self, excitation: Excitation, on: _Pressed, s: Complex, frequency: Real
    ) -> tuple[Complex, dict[str, Complex]]:
        pencil = on.space.pencil(on.mass, excitation, 0.0)
        Y, _ = respond(pencil, s, on.rtol)
        u = self._potentials(excitation, pencil, on, s, Y)
        parts = np.hstack([u.real, u.imag])
        by = {name: s * _energy(parts, each) for name, each in on.masses.items()}
        gauges = {name: each for name, each in on.gauges.items() if each is not None}
        if not (gauges or on.skin_unknown):
            return Y, by
        sheets = np.stack([_energy(parts, term) for term in self._sheet_terms])
        by |= {name: by[name] + each @ sheets for name, each in gauges.items()}
        if not on.skin_unknown:
            return Y, by
        by_s = _energy(parts, on.foam)
        of_s = slopes_of_s(frequency, self.parts.skin.foam.loss)
        by = {name: by_s * of_s[name] for name in ("capacitance", "loss_tangent")} | by
        if on.weights is not None:
            sheets = sheets * on.weights[: len(sheets), None]
        return Y, by | self._by_resistance(
            u, sheets.reshape(self._circuit.fields, -1, len(s)).sum(1)
        )

    def _potentials(
        self, excitation: Excitation, pencil: Pencil, on: _Pressed, s: Complex, Y: Complex
    ) -> Complex:
        """Potentials u at 1 V, shape (unknown, s). Raises InputError where they do not match Y.

        For an excitation with nearly no charge, such as against an earth without coupling, Y is the
        rounding error of the sum of all charges.
        """
        driven, space = on.space.driven(excitation), on.space
        near = on.mass.near if isinstance(on.mass, LowRankMass) else on.mass
        lost = ROUNDING * np.abs(s) * np.abs(space.restricted(near).data).sum()
        g, sheets = driven.potential, driven.floating[:, driven.common]
        if sheets.size:
            charge = space.restricted(on.mass) @ sheets
            g = g - sheets @ np.linalg.solve(sheets.T @ charge, charge.T @ g)
        u = g[:, None] + potentials(pencil, s, on.rtol)  # pyright: ignore[reportArgumentType]
        found = pencil.admittance + s * (pencil.start @ u)
        if not (np.abs(found - Y) <= RTOL * np.abs(Y) + lost).all():
            highest = np.abs(s).max() / (2 * np.pi)
            raise InputError(f"frequencies up to {highest:.4g} Hz are too far above cut-off")
        return u.astype(np.complex128)

    def _by_resistance(self, u: Complex, sheets: Complex) -> dict[str, Complex]:
        """Derivatives of `by_sheets`, and by contact resistance."""
        family, found = self._family, by_sheets(sheets, *self.parts.skin.sheet_resistances)
        if any(not contact.ideal for contact in self.parts.skin.contacts):
            films = family.space.film_energy(u, family.system.films)  # pyright: ignore[reportArgumentType]
            found["contact_resistance"] = np.asarray(-films.diagonal(), dtype=np.complex128)
        return found


def _energy(parts: Real, matrix: Mass) -> Complex:
    """u'Mu in W of a symmetric M. parts: real, then imaginary parts of u, (unknown, 2 s)."""
    Mu, count = matrix @ parts, parts.shape[1] // 2
    own = np.einsum("ik,ik->k", parts, Mu)
    between = np.einsum("ik,ik->k", parts[:, :count], Mu[:, count:])
    return own[:count] - own[count:] + 2j * between
