"""The skin in two dimensions: finite elements for one or two fields, any contacts, any press.

With the lift G (each terminal at 1 V in turn, the others at 0 V, no capacitance: K G = 0 inside)
the potentials are G U + d, and the deviation d solves (K + s M) d = -s M G U. The terminals'
admittance is then Y = G'KG + s G'MG - s² (MG)' (K + s M)^-1 (MG): the variational form, whose error
is the square of the field's, and which keeps all digits at low frequency. Under a foil with contact
resistance the unknown is lifted to the foil's potential first, so that a small resistance is a
stiff film on a small deviation, and no small difference of large numbers.
"""

from __future__ import annotations

from contextlib import AbstractContextManager
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import SuperLU, splu
from threadpoolctl import ThreadpoolController

from simulator.circuit import Circuit
from simulator.foam import capacitance_map
from simulator.frequency import laplace_variable
from simulator.mesh import Resolution
from simulator.network import Network
from simulator.press import Press
from simulator.scene import Scene
from simulator.system import System, build_system


class Sheet:
    """A scene discretised once, solved for any press and frequency."""

    def __init__(self, scene: Scene, circuit: Circuit, resolution: Resolution) -> None:
        self.scene, self.circuit, self.resolution = scene, circuit, resolution
        self.system = build_system(scene, circuit, resolution)
        self.terminal_field = np.array([terminal.field for terminal in circuit.terminals])
        self._inner = _InnerBlock(self.system)
        self._stiffness = self._inner.values(self.system.stiffness)
        self._lift, self._conductance = self._terminal_lift()

    @property
    def unknowns(self) -> int:
        """Size of the sparse system that is solved at each frequency."""
        return self.system.inner

    def impedance(self, press: Press, frequency: NDArray[np.float64]) -> NDArray[np.complex128]:
        """Z in ohm at every interface, shape (interface, frequency). frequency: Hz."""
        network = self.network(press, frequency)
        return np.stack([network.impedance(drive) for drive in self.circuit.drives])

    def network(self, press: Press, frequency: NDArray[np.float64]) -> Network:
        """The N-terminal network at these frequencies in Hz."""
        mass = self.system.mass(capacitance_map(self.scene, press))
        charge = mass @ self._lift
        at_once = self._lift.T @ charge
        inner_charge = charge[: self.system.inner]
        capacitance = self._inner.values(mass)
        s = laplace_variable(frequency, self.scene.skin.foam.loss_tangent)
        with _one_blas_thread():
            delayed = np.stack(
                [
                    inner_charge.T
                    @ self._inner.solve(self._stiffness + f * capacitance, inner_charge)
                    for f in s
                ]
            )
        s = s[:, None, None]
        return Network(self.terminal_field, self._conductance, s * at_once - s**2 * delayed)

    def moments(self, press: Press, count: int) -> NDArray[np.float64]:
        """Taylor coefficients of Y(s) = Y_0 + Y_1 s + ... + Y_count s^count, shape (k, N, N).

        One real factorisation: Y_1 = G'MG, Y_k = (-1)^(k-1) (MG)' (K^-1 M)^(k-2) K^-1 (MG).
        """
        mass = self.system.mass(capacitance_map(self.scene, press))
        inner_mass = mass[: self.system.inner, : self.system.inner]
        charge = mass @ self._lift
        right = inner_charge = charge[: self.system.inner]
        moments: list[NDArray[np.float64]] = [self._conductance, self._lift.T @ charge]
        for k in range(2, count + 1):
            solution = self._inner.solve(self._stiffness, right)
            moments.append((-1) ** (k - 1) * inner_charge.T @ solution)
            right = inner_mass @ solution
        return np.array(moments)

    def _terminal_lift(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """G, shape (inner + terminals, terminals), and G'KG in S, shape (terminals, terminals).

        The columns of a field add up to 1 V, which costs no current: that gives its first terminal.
        """
        system, terminals = self.system, len(self.terminal_field)
        first_of_field = [
            int(np.argmax(self.terminal_field == f)) for f in range(self.circuit.fields)
        ]
        others = np.setdiff1d(np.arange(terminals), first_of_field)
        at_foils, films = system.at_foils[:, others], system.films
        inner = np.zeros((system.inner, terminals))
        conductance = np.zeros((terminals, terminals))
        if others.size:
            current = system.sheets @ at_foils + films.current[:, others]
            deviation = -self._inner.solve(self._stiffness, current[: system.inner])
            inner[:, others] = at_foils[: system.inner] + deviation
            conductance[np.ix_(others, others)] = (
                at_foils.T @ (system.sheets @ at_foils)
                + films.conductance[np.ix_(others, others)]
                + current[: system.inner].T @ deviation
            )
        for field, first in enumerate(first_of_field):
            rest = others[self.terminal_field[others] == field]
            inner[:, first] = system.one[:, field] - inner[:, rest].sum(axis=1)
            conductance[first, rest] = -conductance[np.ix_(rest, rest)].sum(axis=0)
            conductance[rest, first] = conductance[first, rest]
            conductance[first, first] = -conductance[first, rest].sum()
        return np.vstack([inner, np.eye(terminals)]), conductance


class _InnerBlock:
    """The inner unknowns' block of the pattern, reordered once so that its factors stay sparse."""

    def __init__(self, system: System) -> None:
        entries = np.arange(1, len(system.pattern.indices) + 1, dtype=float)
        numbered = system.pattern.matrix(entries)[: system.inner, : system.inner]
        stiffness = csc_matrix(numbered)
        stiffness.data = system.stiffness.data[numbered.data.astype(np.int64) - 1]
        self._order = np.argsort(_factorised(stiffness, "MMD_AT_PLUS_A").perm_c)
        reordered = csc_matrix(numbered[self._order][:, self._order])
        reordered.sort_indices()
        self._entries = reordered.data.astype(np.int64) - 1
        self._structure = (reordered.indices, reordered.indptr)

    def values(self, matrix: csc_matrix) -> NDArray[np.float64]:
        """The block's values of a matrix in the system's pattern."""
        return np.asarray(matrix.data, dtype=np.float64)[self._entries]

    def solve(self, values: NDArray, right: NDArray[np.float64]) -> NDArray:
        """The solution for the block with these values, shape of `right`."""
        size = len(self._order)
        block = csc_matrix((values, *self._structure), shape=(size, size))
        solution = np.empty(right.shape, dtype=values.dtype)
        solution[self._order] = _factorised(block, "NATURAL").solve(
            right[self._order].astype(values.dtype)
        )
        return solution


def _one_blas_thread() -> AbstractContextManager:
    """Blocks of sparse factors are too small to share: a second thread would only wait and spin."""
    return _blas().limit(limits=1, user_api="blas")


@cache
def _blas() -> ThreadpoolController:
    return ThreadpoolController()


def _factorised(matrix: csc_matrix, ordering: str) -> SuperLU:
    """LU without pivoting: stable, because real and imaginary part are positive semidefinite."""
    return splu(
        matrix,
        permc_spec=ordering,
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True, "Equil": False},
    )
