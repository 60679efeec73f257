"""Potentials of one pressed skin in the small basis of its reduced model, for any readings.

In coordinates in which K is 1, M of the inner unknowns is diagonalized once for a press; the system
is then diagonal for every s. It is solved for each terminal at 1 V. Floating terminals are
eliminated afterwards, so energies for any number of readings cost as much as for the terminals.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...arrays import Complex, Real
from ...fem.terminals import Combination
from ...models.reduced.reduced_skin import ReducedSkin
from ...models.small_system.system import added, at_terminals, diagonalised, mass_of


@dataclass(frozen=True)
class Potentials:
    """Potentials of a press.

    of_terminals: at 1 V of each terminal, shape (N + n, N, s). at: potentials of the terminals for
    each excitation, V, shape (excitation, N, s). Y: S, shape (reading, s). combination: of
    excitations to readings.
    """

    of_terminals: Complex
    at: Complex
    Y: Complex
    combination: Combination

    def energy(self, form: Real) -> Complex:
        """u'(form)u of each reading, shape (reading, s); form: shape (N + n, N + n)."""
        T, count = self.of_terminals, len(form)
        turned = (form @ T.reshape(count, -1)).reshape(T.shape)
        own = np.einsum("ias,ibs->abs", T, turned)
        each = np.einsum("ras,abs,rbs->rs", self.at, own, self.at, optimize=True)
        return np.asarray(self.combination.admittance(each), dtype=np.complex128)


class PressedSkin:
    """A skin of a model of all terminals, with presses of any of its parts."""

    def __init__(self, skin: ReducedSkin) -> None:
        self._skin = skin

    @cached_property
    def unpressed(self) -> Real:
        """M of the unpressed skin in F, shape (N + n, N + n)."""
        return mass_of(self._skin.unpressed_mass, np.zeros(0, dtype=np.int64), np.zeros(0))

    @cached_property
    def stiffness(self) -> Real:
        """K of each sheet, then of each film, in S, shape (term, N + n, N + n)."""
        turn = self._skin.turn
        return turn.T @ self._skin.reduced.stiffness @ turn

    def mass(self, change: Real) -> Real:
        """Change of M in F by changes of the parts over the scene's own, shape (part,)."""
        skin, weights = self._skin, change * self._skin.unpressed_factors
        factors = skin.unpressed_mass.factors
        cells = np.flatnonzero(weights[: len(factors)])
        found = added(factors, cells, weights[cells])
        if weights[len(factors) :].any():
            fixed = np.tensordot(weights[len(factors) :], skin.reduced.fixed, axes=1)
            found += skin.turn.T @ fixed @ skin.turn
        return found

    def solved(self, M: Real, s: Complex) -> Potentials:
        """Potentials of a press with this M, at s in rad/s."""
        skin, N = self._skin, len(self._skin.conductance)
        Y, (inside,), axes = diagonalised(M[None], N, s)
        assert axes is not None
        u = np.empty((len(M), N, len(s)), dtype=np.complex128)
        turned = axes[0] @ inside.transpose(1, 2, 0).reshape(len(M) - N, -1)
        u[:N], u[N:] = np.eye(N)[:, :, None], turned.reshape(u[N:].shape)
        at, forms = zip(*(at_terminals(own, Y) for own in skin.excited_terminals), strict=True)
        combined = skin.combination
        shown = np.asarray(combined.admittance(np.concatenate(forms)), dtype=np.complex128)
        return Potentials(u, np.concatenate(at).swapaxes(1, 2), shown, combined)
