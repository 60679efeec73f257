"""Excitations, and their combination to the impedance that a meter reads.

An excitation fixes the potentials of the meter's two terminals and has a symmetric quadratic form
Q(s), so each is solved, bounded and differentiated in the same way. Without earth the excitation of
1 V between high and low is the interface itself: Y = Q. Where the low terminal is a virtual earth,
the meter reads the current that high drives into low, and no current that reaches earth elsewhere:
Z = -1 / Y12. By polarisation that is the difference of two forms, -Y12 = Q(+1/2 V, -1/2 V) - Q(+1/2
V, +1/2 V), all other terminals floating in both.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, fields
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...arrays import Complex, Integer, Real
from ..error_estimate import (
    KRYLOV_SHARE,
    ROUNDING,
    Swept,
    estimated_error,
    frequencies_around,
    reference_susceptance,
    relative_difference,
)
from ..safety_factors import MAX_ORDER_GAIN


@dataclass(frozen=True)
class Excitation:
    """Terminals at high and low, and their potentials; an empty `low` is the zero of the one field.

    potentials: of high and low, V. raised: True if both may rise above earth together, until no net
    current flows to earth. weight: of the form in the interface's admittance; an excitation with a
    negative weight belongs to the interface of the excitation before it.
    """

    high: tuple[int, ...]
    low: tuple[int, ...]
    potentials: tuple[float, float] = (1.0, 0.0)
    raised: bool = False
    weight: float = 1.0

    def stored(self) -> dict[str, Any]:
        """Dictionary for a model file, without the fields that keep their defaults."""
        own = asdict(self)
        return {
            each.name: own[each.name] for each in fields(self) if own[each.name] != each.default
        }

    @classmethod
    def read(cls, stored: dict[str, Any]) -> Excitation:
        """Excitation from the dictionary of a model file."""
        return cls(**{name: _tuples(own) for name, own in stored.items()})


def through_virtual_earth(high: tuple[int, ...], low: tuple[int, ...]) -> tuple[Excitation, ...]:
    """Excitations of an interface whose low terminal is a virtual earth."""
    return (
        Excitation(high, low, (0.5, -0.5)),
        Excitation(high, low, (0.5, 0.5), weight=-1.0),
    )


@dataclass(frozen=True)
class Combination:
    """Combination of excitations to interfaces.

    weights: shape (interface, excitation). Q: forms in S, shape (excitation, ...). Their errors
    add: |dY| <= sum |w_k| |dQ_k|.
    """

    weights: Real

    @property
    def one_to_one(self) -> bool:
        """True if every excitation is an interface."""
        return len(self.weights) == self.weights.shape[1]

    @cached_property
    def groups(self) -> list[Integer]:
        """Indices of the excitations of each interface."""
        return [np.flatnonzero(row) for row in self.weights]

    def admittance(self, Q: NDArray) -> NDArray:
        """Y in S, or the same sum of other forms, shape (interface, ...)."""
        return Q if self.one_to_one else np.tensordot(self.weights, Q, axes=1)

    def bound(self, dQ: Real) -> Real:
        """Bound on errors of admittances from bounds on errors of forms, S, shape (interface,
        ...)."""
        return dQ if self.one_to_one else np.tensordot(np.abs(self.weights), dQ, axes=1)

    def impedance(self, Q: Complex) -> Complex:
        """Z in ohm, shape (interface, ...)."""
        return (1 / self.admittance(Q)).astype(np.complex128)

    def relative_change(self, Q: Complex, truth: Complex) -> Real:
        """`relative_difference` of impedances, with the excitations' parts added without signs.

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
    """Combination of these excitations to interfaces."""
    weight = np.array([excitation.weight for excitation in excitations])
    interface = np.cumsum(weight > 0) - 1
    weights = np.zeros((int((weight > 0).sum()), len(excitations)))
    weights[interface, np.arange(len(excitations))] = weight
    return Combination(weights)


def impedance_with_error(
    sweep: Callable[[Real, float], list[Swept]],
    excitations: Sequence[Excitation],
    frequency: Real,
    rtol: float,
) -> tuple[Complex, Real]:
    """Z in ohm, shape (interface, frequency), and its estimated relative errors, shape (2, ...).

    sweep: called with frequencies in Hz and a tolerance of the solves; returns the forms of the
    `excitations`, then finer ones, then optionally coarser ones. frequency: Hz. rtol: tolerance of
    Rs and Cp.
    """
    around, combined = frequencies_around(frequency), combination(excitations)
    (Q, change), (finer, _), *coarser = sweep(around, KRYLOV_SHARE * rtol)
    off = estimated_error(combined.relative_change(Q, finer))
    for before, _ in coarser:
        gained = estimated_error(combined.relative_change(before, Q))
        off = np.maximum(off, gained / MAX_ORDER_GAIN)
    here = np.s_[:, : len(frequency)]
    return combined.impedance(Q)[here], off + change[here] + ROUNDING
