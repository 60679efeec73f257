"""Excitations: what is solved for, and the ONE place where they combine to what a meter reads.

An excitation fixes the potentials of the meter's two terminals and has a symmetric quadratic form
Q(s) of them, so each is solved, bounded and differentiated in the same way. Without earth the
excitation of 1 V between high and low is the interface itself: Y = Q. Where the low terminal is a
virtual earth, the meter reads the current that high drives into low and nothing of what reaches
earth otherwise: Z = -1 / Y12. By polarisation that is the difference of two forms,
-Y12 = Q(+1/2 V, -1/2 V) - Q(+1/2 V, +1/2 V), all other terminals floating in both.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, fields
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .error_estimate import (
    KRYLOV_SHARE,
    ROUNDING,
    Swept,
    estimated_error,
    frequencies_around,
    reference_susceptance,
    relative_difference,
)
from .safety_factors import MOST_GAINED


@dataclass(frozen=True)
class Excitation:
    """An excitation: the terminals it connects; an empty `low` is the zero of the one field.

    potentials: of high and low, V. raised: whether both may rise above earth together, by as much
    as lets no current flow to earth. weight: of the form in the interface's admittance; one that is
    negative belongs to the interface of the excitation before.
    """

    high: tuple[int, ...]
    low: tuple[int, ...]
    potentials: tuple[float, float] = (1.0, 0.0)
    raised: bool = False
    weight: float = 1.0

    def stored(self) -> dict[str, Any]:
        """As a file of a model holds it: without what all share where there is no earth."""
        own = asdict(self)
        return {
            each.name: own[each.name] for each in fields(self) if own[each.name] != each.default
        }

    @classmethod
    def read(cls, told: dict[str, Any]) -> Excitation:
        """The same of a file."""
        return cls(**{name: _tuples(own) for name, own in told.items()})


def through_virtual_earth(high: tuple[int, ...], low: tuple[int, ...]) -> tuple[Excitation, ...]:
    """The excitations of an interface whose low terminal is a virtual earth."""
    return (
        Excitation(high, low, (0.5, -0.5)),
        Excitation(high, low, (0.5, 0.5), weight=-1.0),
    )


@dataclass(frozen=True)
class Combination:
    """How excitations combine to interfaces.

    weights: shape (interface, excitation). Q: forms in S, shape (excitation, ...). Their errors
    add: |dY| <= sum |w_k| |dQ_k|.
    """

    weights: NDArray[np.float64]

    @property
    def one_to_one(self) -> bool:
        """Whether every excitation is an interface."""
        return len(self.weights) == self.weights.shape[1]

    @cached_property
    def groups(self) -> list[NDArray[np.int64]]:
        """The excitations of each interface."""
        return [np.flatnonzero(row) for row in self.weights]

    def admittance(self, Q: NDArray) -> NDArray:
        """Y in S, or any other form's sum, shape (interface, ...)."""
        return Q if self.one_to_one else np.tensordot(self.weights, Q, axes=1)

    def bound(self, dQ: NDArray[np.float64]) -> NDArray[np.float64]:
        """What admittances are off by where forms are by so much, S, shape (interface, ...)."""
        return dQ if self.one_to_one else np.tensordot(np.abs(self.weights), dQ, axes=1)

    def impedance(self, Q: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """Z in ohm, shape (interface, ...)."""
        return (1 / self.admittance(Q)).astype(np.complex128)

    def relative_change(
        self, Q: NDArray[np.complex128], truth: NDArray[np.complex128]
    ) -> NDArray[np.float64]:
        """As `relative_difference` of impedances, the excitations' parts added without signs.

        Shape (2, interface, ...). 1/Y - 1/Y' = (Y' - Y) / (Y Y') is exact.
        """
        Z, exact = self.impedance(Q), self.impedance(truth)
        if self.one_to_one:
            return relative_difference(Z, exact)
        of_each = (Q - truth) * np.abs(self.weights)[(...,) + (None,) * (Q.ndim - 1)]
        Rs = np.abs(((Z * exact)[:, None] * of_each).real).sum(axis=1) / np.abs(exact.real)
        Cp = np.abs(of_each.imag).sum(axis=1) / reference_susceptance(self.admittance(truth))
        return np.stack([Rs, Cp])


def _tuples(own: Any) -> Any:
    return tuple(own) if isinstance(own, list) else own


def combination(excitations: Sequence[Excitation]) -> Combination:
    """That of these excitations."""
    weight = np.array([excitation.weight for excitation in excitations])
    interface = np.cumsum(weight > 0) - 1
    weights = np.zeros((int((weight > 0).sum()), len(excitations)))
    weights[interface, np.arange(len(excitations))] = weight
    return Combination(weights)


def impedance_with_error(
    sweep: Callable[[NDArray[np.float64], float], list[Swept]],
    excitations: Sequence[Excitation],
    frequency: NDArray[np.float64],
    rtol: float,
) -> tuple[NDArray[np.complex128], NDArray[np.float64]]:
    """Z in ohm, shape (interface, frequency), and its relative errors, shape (2, ...).

    sweep: from frequencies in Hz and a tolerance of the solves to the forms of the excitations
    `excitations`, to finer ones and perhaps to coarser ones. frequency: Hz. rtol: the tolerance
    asked of Rs and Cp.
    """
    around, combined = frequencies_around(frequency), combination(excitations)
    (Q, change), (finer, _), *coarser = sweep(around, KRYLOV_SHARE * rtol)
    off = estimated_error(combined.relative_change(Q, finer))
    for before, _ in coarser:
        gained = estimated_error(combined.relative_change(before, Q))
        off = np.maximum(off, gained / MOST_GAINED)
    here = np.s_[:, : len(frequency)]
    return combined.impedance(Q)[here], off + change[here] + ROUNDING
