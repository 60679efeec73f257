"""One skin of a reduced model's family, in coordinates with K = 1 and unpressed M diagonal."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from ...arrays import Complex, Integer, Real
from ...fem.error_estimate import reference_susceptance
from ...fem.factors import one_blas_thread
from ...fem.terminals import excited_terminals
from ...method_cache import cached_method
from ...press.batch import NOTHING, PressBatch
from ...press.parts import parts_of
from ...scene.air_nodes import LOSSLESS_FOAM, AirNodes, air_factor, air_nodes
from ...scene.frequency import LOSSLESS, laplace_variable
from ...sweeps import ToleranceError
from ..heterogeneous.materials import gauged
from ..parameters import Variation, foam_parts, nominal
from ..small_system.system import (
    DenseExcitation,
    Networks,
    Solved,
    UnpressedMass,
    added,
    aligned,
    dense_excitation,
    mass_of,
    networks,
    networks_in_air,
    of_one,
    own_coordinates,
    solved,
    with_terms,
)
from .cases import touched
from .certificate import certificates
from .family import Family, changes, weights_under
from .family_meshes import family_on, finer_meshes
from .projection import Projection

if TYPE_CHECKING:
    from ..small_system.lanczos import Skins

KRYLOV_SHARE = 0.03
MAX_SKINS = 64
"""Number of cached skins with other factors on air."""
CANCELLED_UNDER_PRESS, MAX_CANCELLATION = 3.0, 1e6
"""Cancellation between excitations under a press over that of the unpressed skin, which strong
presses change two- or threefold. Largest cancellation that the tolerance of Lanczos' method
follows: beyond it the method ends at rounding, and the certificate covers the loss."""


class ReducedSkin:
    """One skin of a family, which solves any press on its pixels in microseconds.

    turn: matrix from this skin's coordinates, in which K is 1 and the unpressed M is diagonal
    except at terminals, to those of the model, shape (N + n, N + n). conductance: between
    terminals, S, shape (N, N). unpressed_factors: unpressed amount of each part of M over the
    scene's own, see `Parts`; the unit of rises.
    """

    def __init__(
        self, reduced: Projection, variation: Variation | None, pressed: Real | None = None
    ) -> None:
        """pressed: factors on c by touches, shape (part,); only piezoresistive sheets use them."""
        self.reduced, self.variation, self._pressed = reduced, variation, pressed
        factors = np.ones(foam_parts(reduced.parts.skin)) if pressed is None else pressed
        given = reduced.parts.skin, reduced.circuit, reduced.modes
        self.weights = weights_under(variation, *given, factors)
        own = nominal(reduced.parts.skin, reduced.modes) if variation is None else variation
        self.loss = own.loss
        self.unpressed_factors = own.factors(reduced.parts.skin)
        self.parts = parts_of(reduced.parts.skin)
        self.s = laplace_variable(reduced.frequency, own.loss)
        K = self.stiffness
        unpressed = (self.unpressed_factors * self.parts.resting)[
            : len(reduced.factors), None, None
        ]
        rows = (np.sqrt(unpressed) * reduced.factors).reshape(-1, len(K))
        M = rows.T @ rows + self.fixed_mass
        self.conductance, self.turn = own_coordinates(K, M, reduced.terminal_field)
        terminals, M = len(self.conductance), self.turn.T @ M @ self.turn
        self._own = M[:terminals].copy(), M.diagonal()[terminals:].copy()
        self.excited_terminals = [
            excited_terminals(drive, reduced.terminal_field, self.conductance, np.eye(terminals))
            for drive in reduced.circuit.excitations
        ]
        self.dense_excitations = [dense_excitation(driven) for driven in self.excited_terminals]
        self.combination = reduced.circuit.combination

    @property
    def fixed_factors(self) -> Real:
        """Factors of the parts that no press changes, over the scene's own, shape (part,)."""
        return self.unpressed_factors[self.parts.touched :]

    @property
    def in_lossy_foam(self) -> bool:
        """True if a part of M is in air, whose s is then not that of the foam."""
        return self.loss != LOSSLESS and bool(self.parts.in_air.any())

    @property
    def fixed_mass(self) -> Real | float:
        """M of the parts that no press changes, F, in the model's coordinates; 0 for none."""
        fixed = self.reduced.fixed
        return np.tensordot(self.fixed_factors, fixed, axes=1) if len(fixed) else 0.0

    @cached_property
    def unpressed_mass(self) -> UnpressedMass:
        """Unpressed M, and the factors of the terms that cells add."""
        return self.pressed_by(self.reduced.factors @ self.turn)

    @cached_property
    def alone(self) -> Skins:
        """Arrays of this skin for Lanczos' method."""
        from ..small_system.lanczos import Skins

        unit = self.unpressed_factors[: self.parts.touched]
        return Skins.of_one(aligned(self.unpressed_mass), unit, self.s, self.krylov_rtol)

    @cached_property
    def krylov_rtol(self) -> float:
        """Tolerance of Lanczos' method for each excitation."""
        return KRYLOV_SHARE * self.reduced.rtol / self._cancelled

    @cached_property
    def of_touches(self) -> Any:
        """Arrays of the touches on this skin, see `Touches.on`."""
        return self.reduced.touches.on(self)

    @cached_property
    def excited_alone(self) -> list[DenseExcitation]:
        """Excitations of this skin, with a first axis (skin,)."""
        return [of_one(excitation) for excitation in self.dense_excitations]

    def pressed_by(self, factors: Real) -> UnpressedMass:
        """Unpressed M, and the factors of touches, shape (touch, rank, N + n)."""
        return UnpressedMass(*self._own, np.ascontiguousarray(factors))

    def sweeps(self, batch: PressBatch, frequency: Real | None = None) -> Complex:
        """Z in ohm of many presses of pixels, shape (press, interface, frequency).

        frequency: Hz, by default those of the model.
        """
        own = frequency is None
        s = self.s if own else laplace_variable(frequency, self.loss)
        air, skins = self._with_own_air if own else self.with_air(frequency)
        if air.single:
            return self._at_own_air(batch, s, 1.0)
        return 1 / air.mean(1 / skin._at_own_air(batch, s, air.precision) for skin in skins)

    def sweep(self, cells: Integer, rises: Real, frequency: Real | None = None) -> Complex:
        """Z in ohm of one press, shape (interface, frequency), see `sweeps`."""
        return self.sweeps(PressBatch.of([(cells, rises)]), frequency)[0]

    def with_air(self, frequency: Real) -> tuple[AirNodes, list[ReducedSkin]]:
        """Nodes at frequencies in Hz, and this skin with each of their factors on air.

        Raises ToleranceError as `air_nodes` does.
        """
        if not self.parts.in_air.any():
            return LOSSLESS_FOAM, [self]
        air = air_nodes(frequency, self.loss, KRYLOV_SHARE * self.reduced.rtol)
        if air.single:
            return air, [self]
        return air, [self._with_air_of(factor) for factor in air.factors.tolist()]

    @cached_property
    def _with_own_air(self) -> tuple[AirNodes, list[ReducedSkin]]:
        return self.with_air(self.reduced.frequency)

    @cached_method(MAX_SKINS)
    def _with_air_of(self, factor: float) -> ReducedSkin:
        own = self.variation or nominal(self.reduced.parts.skin, self.reduced.modes)
        return type(self)(self.reduced, replace(own, air=factor), self._pressed)

    def _at_own_air(self, batch: PressBatch, s: Complex, precision: float) -> Complex:
        """Sweeps with one s for all capacitance. precision: share of the tolerance of Lanczos'
        method."""
        if gauged(self.reduced.parts.skin):
            return self._one_by_one(batch, s, precision)
        return self._swept(batch, s, precision)

    def under(self, cells: Integer, rises: Real) -> ReducedSkin:
        """Skin whose sheets are those under these touches; itself if touches change no sheet."""
        if not gauged(self.reduced.parts.skin):
            return self
        return type(self)(
            self.reduced, self.variation, touched(self.reduced.parts.skin, cells, rises)
        )

    def _one_by_one(self, batch: PressBatch, s: Complex, precision: float) -> Complex:
        """Sweeps with a K of its own for each press, see `sweeps`."""
        interfaces = len(self.combination.weights)
        found = np.empty((batch.count, interfaces, len(s)), dtype=np.complex128)
        with one_blas_thread():
            for press, own in enumerate(batch.each()):
                found[[press]] = self.under(*own)._swept(PressBatch.of([own]), s, precision)
        return found

    def _swept(self, batch: PressBatch, s: Complex, precision: float) -> Complex:
        interfaces = len(self.combination.weights)
        found = np.empty((batch.count, interfaces, len(s)), dtype=np.complex128)
        for which, systems, own in self.reduced.touches.systems(self, batch):
            systems = systems._replace(s=s[None], rtol=precision * systems.rtol)
            found[which] = self._impedances(systems, own)
        return found

    def _impedances(self, systems: Skins, batch: PressBatch) -> Complex:
        """Z in ohm of presses on this skin alone, shape (press, interface, s)."""
        every, none = np.arange(batch.count), np.zeros(batch.count, dtype=np.int64)
        Y = [systems.admittances(own, batch, none, every) for own in self.excited_alone]
        Y = Y if self.combination.one_to_one else [*self.combination.admittance(np.stack(Y))]
        return (1 / np.stack(Y, axis=1)).astype(np.complex128)

    @cached_property
    def _cancelled(self) -> float:
        """Cancellation between excitations: their size over what remains in Rs or Cp.

        It includes the change by strong presses, and is 1 if each excitation is an interface.
        """
        if self.combination.one_to_one:
            return 1.0
        Q = np.stack([Y for _, Y in self.solved(*NOTHING, self.s)])
        Y = np.asarray(self.combination.admittance(Q), dtype=np.complex128)
        size = self.combination.bound(np.abs(Q))
        of_Rs, of_B = np.abs(Y) ** 2 / size / np.abs(Y.real), size / reference_susceptance(Y)
        return CANCELLED_UNDER_PRESS * float(
            np.clip([1 / of_Rs, of_B], 1.0, MAX_CANCELLATION).max()
        )

    def certificate(self, cells: Integer, rises: Real, frequency: Real | None = None) -> Real:
        """Bound on the relative errors of Rs and Cp of one press by the reduction, with its foam.

        Shape (2, interface, frequency). frequency: Hz, by default those of the model.
        """
        f = self.reduced.frequency if frequency is None else frequency
        with one_blas_thread():
            reduction = self.under(cells, rises)._by_reduction(cells, rises, f)
        s = laplace_variable(f, self.loss)
        return reduction + self.reduced.touches.uncertainty(self, cells, rises, s)

    def _by_reduction(self, cells: Integer, rises: Real, frequency: Real) -> Real:
        """Bound of `certificate` by the reduction alone, for sheets as they are here, see `under`.

        Where the foam conducts too much for `air_nodes`, air has its loss here.
        """
        s = laplace_variable(frequency, self.loss)
        try:
            air, skins = self.with_air(frequency)
        except ToleranceError:
            air, skins = LOSSLESS_FOAM, [self]
        each = [map(np.stack, zip(*skin.solved(cells, rises, s), strict=True)) for skin in skins]
        u, Q = (air.mean(own) for own in zip(*each, strict=True))
        solved = u.swapaxes(0, 1).reshape(u.shape[1], -1), Q[None]
        more = None if air.single else air_factor(frequency, self.loss) - 1
        foams = [self.map_of(cells, rises)]
        return certificates(self.reduced, self.weights, foams, solved, s, more)[:, 0]

    def by_mesh(self, cells: Integer, rises: Real) -> float:
        """Estimated relative error of Rs and Cp of one press by the mesh; 0 for uniform scenes."""
        reduced = self.reduced
        if reduced.parts.skin.uniform:
            return 0.0
        pressed = self.under(cells, rises).weights, self.loss, self.map_of(cells, rises)
        with one_blas_thread():
            read = reduced.rtol, reduced.frequency, reduced.circuit.excitations
            return reduced.family.solved(*pressed, *read)[1]

    def exact(self, cells: Integer, rises: Real) -> Complex:
        """Z in ohm of one press by the full system, shape (interface, frequency).

        The mesh is the one that was reduced if it keeps rtol for this press, a finer one otherwise.
        Raises ToleranceError if none keeps it.
        """
        reduced, rtol, error = self.reduced, self.reduced.rtol, np.inf
        pressed = self.under(cells, rises).weights, self.loss, self.map_of(cells, rises)
        with one_blas_thread():
            for family in self._families(cells, rises):
                Z, error = family.solved(
                    *pressed, rtol, reduced.frequency, reduced.circuit.excitations
                )
                if error <= rtol:
                    return Z
        raise ToleranceError(
            f"the full system leaves an error of {error:.1e} under this press, tolerance {rtol:g}"
        )

    def _families(self, cells: Integer, rises: Real) -> Iterator[Family]:
        """Family that was reduced, then families on finer and finer meshes for this press."""
        reduced, skin, touches = self.reduced, self.reduced.parts.skin, self.reduced.touches
        yield reduced.family
        given = skin, reduced.circuit, reduced.rtol, [touches.trial(skin, cells, rises)]
        first = reduced.family.rises.domain if touches.spread else None
        for mesh in finer_meshes(*given, reduced.frequency, first):
            yield family_on(skin, reduced.circuit, mesh, reduced.modes, touches)

    def map_of(self, cells: Integer, rises: Real) -> Real:
        """Amount of each part of M over the scene's own, see `Touches.amounts`."""
        return self.reduced.touches.amounts(self.parts, self.unpressed_factors, cells, rises)

    def solved(self, cells: Integer, rises: Real, s: Complex) -> list[Solved]:
        """Potentials and form of each excitation, for sheets as they are here, see `under`.

        The potentials are V in the model's coordinates, shape (N + n, s); the form is in S, shape
        (s,).
        """
        rest, which, weights = self.reduced.touches.terms(self, cells, rises)
        return self._each(networks(rest, which[None], weights[None], s))

    def solved_in_air(self, cells: Integer, rises: Real, frequency: Real) -> list[Solved]:
        """`solved` where air has no loss, unlike the foam. frequency: Hz."""
        M, s = (
            mass_of(*self.reduced.touches.terms(self, cells, rises)),
            laplace_variable(frequency, self.loss),
        )
        _, fingers = self.parts.by_kind(cells, rises)
        charges = fingers.rises * self.unpressed_factors[fingers.cells]
        air = added(self.reduced.factors, fingers.cells, charges) + self.fixed_mass
        masses = [(M, self.turn.T @ air @ self.turn)]
        return self._each(networks_in_air(masses, len(self.conductance), s, 2 * np.pi * frequency))

    def _each(self, press: Networks) -> list[Solved]:
        return [(self.turn @ u[0].T, Y[0]) for u, Y in solved(self.excited_terminals, press)]

    def squares(self, u: Complex) -> Complex:
        """u'Mu of each part as it is on the scene's own skin, F V², shape (s, part)."""
        squares = ((self.reduced.factors @ u) ** 2).sum(axis=1).T
        if not len(self.reduced.fixed):
            return squares
        return np.column_stack([squares, *(((M @ u) * u).sum(axis=0) for M in self.reduced.fixed)])

    @property
    def stiffness(self) -> Real:
        """K in the model's coordinates, S, shape (N + n, N + n)."""
        reduced = self.reduced
        change = changes(self.weights, reduced.parts.skin, reduced.circuit, reduced.modes)
        return with_terms(reduced.conductance, reduced.stiffness, *change)
