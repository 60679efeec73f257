"""One skin of a reduced model's family: K is 1 and M at rest diagonal in its own coordinates."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...fem.error_estimate import reference_susceptance
from ...fem.excited_terminals import excited_terminals
from ...fem.factors import one_blas_thread
from ...press.batch import NOTHING, PressBatch
from ...press.parts import parts_of
from ...scene.frequency import laplace_variable
from ...sweeps import ToleranceError
from ..heterogeneous.materials import gauged
from ..parameters import Variation, foam_parts, nominal
from .cases import Case, touched
from .certificate import certificate, least_conductance
from .dense import Rest, aligned, feed_of, own_coordinates, solved, with_terms
from .families.family import Family, changes, weights_under
from .families.resolving import finer_families
from .projection import Projection

KRYLOV_SHARE = 0.03
CANCELLED_UNDER_PRESS, MOST_CANCELLED = 3.0, 1e6
"""Of digits lost between excitations over those lost at rest: strong presses change either two or
three times. What is lost beyond the most is left to the certificate: Lanczos' method ends at
rounding."""


class ReducedSkin:
    """One skin of a family: answers any press on its pixels in microseconds.

    turn: from this skin's coordinates, in which K is 1 and M at rest diagonal but for terminals, to
    those of the model, shape (N + n, N + n). conductance: between terminals, S, shape (N, N).
    rest_factors: of each part of M over the scene's own, see `Parts`; what rises count in.
    """

    def __init__(
        self,
        reduced: Projection,
        variation: Variation | None,
        pressed: NDArray[np.float64] | None = None,
    ) -> None:
        """pressed: by what touches multiply c, shape (part,); it tells on gauges alone."""
        self.reduced, self.variation = reduced, variation
        factors = np.ones(foam_parts(reduced.scene)) if pressed is None else pressed
        told = reduced.scene, reduced.circuit, reduced.modes
        self.weights = weights_under(variation, *told, factors)
        own = nominal(reduced.scene, reduced.modes) if variation is None else variation
        self.loss, self.rest_factors = own.loss, own.factors(reduced.scene)
        self.s, self.parts = laplace_variable(reduced.frequency, own.loss), parts_of(reduced.scene)
        K = self.stiffness
        at_rest = (self.rest_factors * self.parts.resting)[: len(reduced.factors), None, None]
        rows = (np.sqrt(at_rest) * reduced.factors).reshape(-1, len(K))
        M = rows.T @ rows
        if len(reduced.fixed):
            M += np.tensordot(self.fixed_factors, reduced.fixed, axes=1)
        self.conductance, self.turn = own_coordinates(K, M, reduced.terminal_field)
        terminals, M = len(self.conductance), self.turn.T @ M @ self.turn
        self._own = M[:terminals].copy(), M.diagonal()[terminals:].copy()
        self.drives = [
            excited_terminals(drive, reduced.terminal_field, self.conductance, np.eye(terminals))
            for drive in reduced.circuit.excitations
        ]
        self.feeds = [feed_of(driven) for driven in self.drives]
        self.combination = reduced.circuit.combination

    @property
    def fixed_factors(self) -> NDArray[np.float64]:
        """Of what no press changes, over the scene's own, shape (part,)."""
        return self.rest_factors[self.parts.touched :]

    @cached_property
    def rest(self) -> Rest:
        """M at rest, and what every cell adds."""
        return self.pressed_by(self.reduced.factors @ self.turn)

    @cached_property
    def _aligned(self) -> Rest:
        return aligned(self.rest)

    def pressed_by(self, factors: NDArray[np.float64]) -> Rest:
        """M at rest, and what touches with these factors add, (touch, rank, N + n)."""
        return Rest(*self._own, np.ascontiguousarray(factors))

    def sweeps(
        self, batch: PressBatch, s: NDArray[np.complex128] | None = None
    ) -> NDArray[np.complex128]:
        """Z in ohm of many presses of pixels, shape (press, interface, s).

        s: rad/s, by default of the model's frequencies.
        """
        s = self.s if s is None else s
        if gauged(self.reduced.scene.skin):
            return self._one_by_one(batch, s)
        return self._swept(batch, s)

    def sweep(
        self,
        cells: NDArray[np.int64],
        rises: NDArray[np.float64],
        s: NDArray[np.complex128] | None = None,
    ) -> NDArray[np.complex128]:
        """Z in ohm of one press, shape (interface, s), see `sweeps`."""
        return self.sweeps(PressBatch.of([(cells, rises)]), s)[0]

    def under(self, cells: NDArray[np.int64], rises: NDArray[np.float64]) -> ReducedSkin:
        """The skin with its sheets as these touches change them; itself where they do not."""
        if not gauged(self.reduced.scene.skin):
            return self
        return type(self)(self.reduced, self.variation, touched(self.reduced.scene, cells, rises))

    def _one_by_one(self, batch: PressBatch, s: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """As `sweeps`, K another one for each press."""
        interfaces = len(self.combination.weights)
        found = np.empty((batch.count, interfaces, len(s)), dtype=np.complex128)
        with one_blas_thread():
            for press, own in enumerate(batch.each()):
                found[[press]] = self.under(*own)._swept(PressBatch.of([own]), s)
        return found

    def _swept(self, batch: PressBatch, s: NDArray[np.complex128]) -> NDArray[np.complex128]:
        from .kernel import impedances

        weighted = self.parts.followed(batch).weighted(self.rest_factors)
        rtol = KRYLOV_SHARE * self.reduced.rtol / self._cancelled
        return impedances(self._aligned, self.feeds, self.combination, weighted, s, rtol)

    @cached_property
    def _cancelled(self) -> float:
        """How much larger excitations are than what they leave of Rs or Cp; 1 where each is an
        interface of its own."""
        if self.combination.one_to_one:
            return 1.0
        Q = np.stack([Y for _, Y in self.solved(*NOTHING, self.s)])
        Y = np.asarray(self.combination.admittance(Q), dtype=np.complex128)
        size = self.combination.bound(np.abs(Q))
        of_Rs, of_B = np.abs(Y) ** 2 / size / np.abs(Y.real), size / reference_susceptance(Y)
        return CANCELLED_UNDER_PRESS * float(np.clip([1 / of_Rs, of_B], 1.0, MOST_CANCELLED).max())

    def certificate(
        self,
        cells: NDArray[np.int64],
        rises: NDArray[np.float64],
        s: NDArray[np.complex128] | None = None,
    ) -> NDArray[np.float64]:
        """Bound on what the reduction leaves out of Rs and Cp of one press, and `doubt`.

        Relatively, of shape (2, interface, s); s in rad/s, by default of the model's frequencies.
        """
        s, own = self.s if s is None else s, self.under(cells, rises)
        with one_blas_thread():
            reduction = own.certificates([(cells, rises)], [self.map_of(cells, rises)], s)[:, 0]
        return reduction + self.doubt(cells, rises, s)

    def doubt(
        self, cells: NDArray[np.int64], rises: NDArray[np.float64], s: NDArray[np.complex128]
    ) -> NDArray[np.float64] | float:
        """Of Rs and Cp of one press, relatively, by how little its foam is known; s in rad/s."""
        return 0.0

    def certificates(
        self,
        presses: Sequence[tuple[NDArray[np.int64], NDArray[np.float64]]],
        foams: Sequence[NDArray[np.float64]],
        s: NDArray[np.complex128],
    ) -> NDArray[np.float64]:
        """The same of presses under which sheets are as here, shape (2, press, interface, s).

        foams: c of each pressed skin as the family's `mass` takes it.
        """
        from .spanned import spanned_by_all

        family, W = self.reduced.family, self.reduced.coordinates
        u, Q = spanned_by_all(self.feeds, [self.touched(*press) for press in presses], s)
        u = self.turn @ u[: len(self.turn)]
        potential = W @ np.hstack([u.real, u.imag])
        current = family.currents(self.weights, potential)
        masses = [family.mass_inside(foam) for foam in foams]
        told = potential, current, Q, s, self.least_conductance, self.combination
        return certificate(family.space, masses, *told)

    def by_mesh(self, cells: NDArray[np.int64], rises: NDArray[np.float64]) -> float:
        """Estimated error of Rs and Cp of one press by the mesh, relatively; 0 of plain scenes."""
        reduced = self.reduced
        if reduced.scene.uniform:
            return 0.0
        asked = self.under(cells, rises).weights, self.loss, self.map_of(cells, rises)
        with one_blas_thread():
            read = reduced.rtol, reduced.frequency, reduced.circuit.excitations
            return reduced.family.solved(*asked, *read)[1]

    @property
    def least_conductance(self) -> float:
        """A lower bound of the factor on K anywhere; raises InputError unless above zero."""
        reduced = self.reduced
        parts = foam_parts(reduced.scene) if gauged(reduced.scene.skin) else 1
        return least_conductance(self.weights, reduced.circuit, reduced.modes, parts)

    def exact(self, cells: NDArray[np.int64], rises: NDArray[np.float64]) -> NDArray[np.complex128]:
        """Z in ohm of one press by the full system, shape (interface, frequency).

        On the mesh that was reduced where that keeps rtol for this press, on finer ones otherwise.
        Raises ToleranceError where none does.
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
        raise ToleranceError(f"a press leaves {error:.1e} by the full system, asked {rtol:g}")

    def _families(self, cells: NDArray[np.int64], rises: NDArray[np.float64]) -> Iterator[Family]:
        """The one that was reduced, then those of all levels, meshed for this press."""
        reduced = self.reduced
        yield reduced.family
        asked = reduced.scene, reduced.circuit, reduced.modes, reduced.rtol
        press = Case(None, cells, rises).press_on(reduced.scene)
        yield from finer_families(*asked, [press], reduced.frequency)

    def map_of(self, cells: NDArray[np.int64], rises: NDArray[np.float64]) -> NDArray[np.float64]:
        """How much of each part of M there is over the scene's own, shape (part,), see `Parts`."""
        return self.parts.pressed(cells, rises) * self.rest_factors

    def solved(
        self, cells: NDArray[np.int64], rises: NDArray[np.float64], s: NDArray[np.complex128]
    ) -> list[tuple[NDArray[np.complex128], NDArray[np.complex128]]]:
        """Potentials of each drive in the model's coordinates, V, shape (N + n, s), and its form
        in S.

        Sheets are as they are here, see `under`.
        """
        rest, which, weights = self.touched(cells, rises)
        found = solved(self.drives, rest, which[None], weights[None], s)
        return [(self.turn @ u[0].T, Y[0]) for u, Y in found]

    def touched(
        self, cells: NDArray[np.int64], rises: NDArray[np.float64]
    ) -> tuple[Rest, NDArray[np.int64], NDArray[np.float64]]:
        """What one press adds to M: which of which factors, and how much of each."""
        cells, rises = self.parts.completed(cells, rises)
        rest = self.pressed_by(self.reduced.factors[cells] @ self.turn)
        return rest, np.arange(len(cells)), rises * self.rest_factors[cells]

    def charges(
        self, cells: NDArray[np.int64], rises: NDArray[np.float64], u: NDArray[np.complex128]
    ) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
        """u'Mu by each part over the scene's own, shape (s, part), and whole, (s,); F V²."""
        squares = self.squares(u)
        return squares, squares @ self.map_of(cells, rises)

    def squares(self, u: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """u'Mu by each part over the scene's own, F V², shape (s, part)."""
        squares = ((self.reduced.factors @ u) ** 2).sum(axis=1).T
        if not len(self.reduced.fixed):
            return squares
        return np.column_stack([squares, *(((M @ u) * u).sum(axis=0) for M in self.reduced.fixed)])

    @property
    def stiffness(self) -> NDArray[np.float64]:
        """K in the model's coordinates, S, shape (N + n, N + n)."""
        reduced = self.reduced
        change = changes(self.weights, reduced.scene, reduced.circuit, reduced.modes)
        return with_terms(reduced.conductance, reduced.stiffness, *change)
