"""Excitations of a skin, their combination to what a meter reads, and the network of terminals.

An excitation fixes the potentials of the meter's two terminals and has a symmetric quadratic form
Q(s), so each is solved, bounded and differentiated in the same way. Without earth the excitation of
1 V between high and low is the interface itself: Y = Q. Where the low terminal is a virtual earth,
the meter reads the current that high drives into low, and no current that reaches earth elsewhere:
Z = -1 / Y12. By polarisation that is the difference of two forms, -Y12 = Q(+1/2 V, -1/2 V) - Q(+1/2
V, +1/2 V), all other terminals floating in both.

Floating terminals carry no net current. Their potentials U_f join the inner unknowns through the
lift F of each: K F = 0 inside, so K splits into the conductance between them and the inner block.
A potential of a whole floating sheet causes no current. The sheet keeps its charge, which
determines that potential at zero frequency. In a network such potentials are kept as separate modes
whose conductance is zero by construction: a capacitance of femtofarads in parallel with a
conductance of siemens then loses no digits.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, fields
from functools import cache, cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.linalg import SuperLU

from ..arrays import Complex, Integer, Mask, Real
from .error_estimate import (
    KRYLOV_SHARE,
    MAX_ORDER_GAIN,
    ROUNDING,
    Swept,
    estimated_error,
    frequencies_around,
    reference_susceptance,
    relative_difference,
)
from .factors import Bordered, Mass
from .lanczos import Pencil, Pencils


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


Solve = Callable[[Real], Real]
"""Maps currents inside, shape (unknown, side), to potentials."""


@dataclass(frozen=True)
class ExcitedTerminals:
    """Driven and floating terminals, in the unknowns of a space: inner ones, then terminals.

    conductance: between high and low at zero frequency, S. potential: g in V, shape (unknown,); the
    floating terminals carry no direct current in it. floating: F, shape (unknown, floating).
    floating_conductance: S, zero for those that are `common`, the potentials of a whole sheet.
    """

    conductance: float
    potential: Real
    floating: Real
    floating_conductance: Real
    common: Mask


def excited_terminals(
    excitation: Excitation, terminal_field: Integer, conductance: Real, lift: Real
) -> ExcitedTerminals:
    """Driven potentials and floating terminals of one excitation.

    conductance: between terminals, S. lift: shape (unknown, terminal).
    """
    modes, common = allowed_potentials(tuple(terminal_field.tolist()), excitation)
    S = modes.T @ conductance @ modes
    S[common, :] = 0.0
    S[:, common] = 0.0
    tied = np.flatnonzero(~common[1:]) + 1
    driven, through = modes[:, 0], S[0, 0]
    if tied.size:
        follow = -np.linalg.solve(S[np.ix_(tied, tied)], S[tied, 0])
        driven, through = driven + modes[:, tied] @ follow, through + S[0, tied] @ follow
    return ExcitedTerminals(
        conductance=float(through),
        potential=lift @ driven,
        floating=lift @ modes[:, 1:],
        floating_conductance=S[1:, 1:],
        common=common[1:],
    )


@dataclass(frozen=True)
class Unshifted:
    """One excitation at sigma = 0 with one M, in F, of the space.

    K^-1 is that of the inner block, `completed` by the floating terminals.
    """

    driven: ExcitedTerminals
    mass: Mass

    @cached_property
    def potential(self) -> Real:
        """Driven potentials at s = 0, V."""
        return self._neutral(self.driven.potential)

    @cached_property
    def start(self) -> Real:
        """Charge of the driven potentials, C."""
        return self.mass @ self.potential

    def completed(self, y: Real, inside: Real) -> Real:
        """K^-1 y with the floating terminals among the unknowns. inside: K^-1 y of the inner
        block."""
        v = np.zeros_like(y)
        v[: len(inside)] = inside
        tied, conductance = self._tied
        if tied.size:
            v += tied @ np.linalg.solve(conductance, tied.T @ y)
        return self._neutral(v)

    def pencil(self, K: SuperLU) -> Pencil:
        """Pencil for Lanczos' method. K: factors of the inner block."""
        inner, start = K.shape[0], self.start
        return Pencil(
            start,
            self.mass.dot,
            lambda y: self.completed(y, K.solve(y[:inner])),
            self.driven.conductance,
            float(self.potential @ start),
            0.0,
        )

    def _neutral(self, v: Real) -> Real:
        sheets, charge, own = self._sheets
        return v - sheets @ np.linalg.solve(own, charge.T @ v) if sheets.size else v

    @cached_property
    def _tied(self) -> tuple[Real, Real]:
        """Potentials of floating terminals that currents tie to others, and the conductance between
        them."""
        tied = ~self.driven.common
        conductance = self.driven.floating_conductance[np.ix_(tied, tied)]
        return self.driven.floating[:, tied], conductance

    @cached_property
    def _sheets(self) -> tuple[Real, ...]:
        """Potentials of sheets that float as a whole, their charges, and the capacitance between
        them."""
        sheets = self.driven.floating[:, self.driven.common]
        charge = self.mass @ sheets
        return sheets, charge, sheets.T @ charge


def unshifted_pencils(each: Sequence[Unshifted], solve: Solve, inner: int) -> Pencils:
    """Pencils of one K for several excitations and M. solve: of the block of `inner` unknowns."""

    def mass(v: Real, which: Integer) -> Real:
        masses = [each[k].mass for k in which]
        first = [k for k, own in enumerate(masses) if k == 0 or own is not masses[k - 1]]
        parts = zip(first, np.split(v, first[1:]), strict=True)
        return np.concatenate([(masses[k] @ own.T).T for k, own in parts])

    def inverse(y: Real, which: Integer) -> Real:
        inside = solve(y[:, :inner].T).T
        parts = zip(which, y, inside, strict=True)
        return np.stack([each[k].completed(own, inner_part) for k, own, inner_part in parts])

    return Pencils(np.stack([one.start for one in each]), mass, inverse)


def shifted(
    driven: ExcitedTerminals,
    mass: Mass,
    A: SuperLU | Bordered,
    shift: float,
    power: Callable[[Real], float],
) -> Pencil:
    """Pencil for sigma > 0, in 1/s. A: factors of the inner block of K + sigma M.

    mass: M in F. power: v'Kv in W of potentials v. The driven potentials are those of s = sigma.
    """
    inverse = _inverse(driven, mass, A, shift)
    potential = driven.potential - shift * inverse(mass @ driven.potential)
    start = mass @ potential
    capacitance = float(potential @ start)
    admittance = power(potential) + shift * capacitance
    return Pencil(start, mass.dot, inverse, admittance, capacitance, shift)


def potentials(driven: ExcitedTerminals, mass: Mass, A: SuperLU | Bordered, s: complex) -> NDArray:
    """Potentials of all unknowns for 1 V between high and low, V, shape (unknown,).

    A: factors of the inner block of K + s M. s: rad/s, real or complex. mass: M in F.
    """
    charge = (mass @ driven.potential).astype(type(s))
    return driven.potential - s * _inverse(driven, mass, A, s)(charge)


def _inverse(
    driven: ExcitedTerminals, mass: Mass, A: SuperLU | Bordered, s: complex
) -> Callable[[NDArray], NDArray]:
    """Map from y to (K + s M)^-1 y with floating terminals as unknowns and driven ones at 0 V."""
    inner, floating = A.shape[0], driven.floating
    charge = s * np.asarray(mass @ floating)
    coupling = charge[:inner]
    followed = A.solve(coupling) if coupling.size else coupling
    own = driven.floating_conductance + floating.T @ charge - coupling.T @ followed

    def inverse(y: NDArray) -> NDArray:
        v = np.zeros_like(y)
        v[:inner] = A.solve(y[:inner])
        if floating.size:
            U = np.linalg.solve(own, floating.T @ y - coupling.T @ v[:inner])
            v[:inner] -= followed @ U
            v += floating @ U
        return v

    return inverse


@dataclass(frozen=True)
class Network:
    """Admittance Y(f) = conductance + dynamic(f) between terminals.

    field: the sheet that each terminal is on, shape (N,). conductance: at zero frequency, S, shape
    (N, N). dynamic: the rest, S, shape (frequency, N, N).
    """

    field: Integer
    conductance: Real
    dynamic: Complex

    def impedance(self, excitation: Excitation) -> Complex:
        """Z in ohm between the driven terminals, the others floating, shape (frequency,)."""
        return 1 / self.form(excitation)

    def form(self, excitation: Excitation) -> Complex:
        """Q of an excitation in S, shape (frequency,)."""
        modes, common = allowed_potentials(tuple(self.field.tolist()), excitation)
        conductance = modes.T @ self.conductance @ modes
        conductance[common, :] = 0.0
        conductance[:, common] = 0.0
        Y = conductance + modes.T @ self.dynamic @ modes
        if Y.shape[-1] == 1:
            return Y[:, 0, 0]
        floating = np.linalg.solve(Y[:, 1:, 1:], Y[:, 1:, :1])
        return Y[:, 0, 0] - (Y[:, :1, 1:] @ floating)[:, 0, 0]


@cache
def allowed_potentials(field: tuple[int, ...], excitation: Excitation) -> tuple[Real, Mask]:
    """Terminal potentials that an excitation allows, as columns, and which of them cost no direct
    current.

    field: the sheet that each terminal is on. The first column is the driven one, with high and low
    at the excitation's own potentials. In the others both are at 0 V, except the last one of an
    excitation that is `raised`: there all that is connected to them is at 1 V.
    """
    nodes, count = _nodes(len(field), excitation), len(field)
    high, low = nodes[0], nodes[1] if excitation.low else None
    of_high, of_low = excitation.potentials
    driven, currentless = np.zeros(count), True
    columns: list[Real] = []
    common: list[bool] = []
    connected: list[tuple[int, ...]] = []
    for island in _islands(nodes, field):
        whole, floating = _indicator(island, count), [n for n in island if n not in (high, low)]
        if floating == island:
            columns.append(whole)
            common.append(True)
            del floating[0]
        else:
            connected += island
            driven += (of_low if low in island else of_high) * whole
        if high in island and low in island:
            driven += (of_high - of_low) * _indicator([high], count)
            currentless = of_high == of_low
        columns += [_indicator([node], count) for node in floating]
        common += [False] * len(floating)
    if excitation.raised:
        columns.append(_indicator(connected, count))
        common.append(True)
    return np.stack([driven, *columns]).T, np.array([currentless, *common])


def _nodes(count: int, excitation: Excitation) -> list[tuple[int, ...]]:
    """Terminals tied together by the meter, high first, low second; then each floating one."""
    driven = [side for side in (excitation.high, excitation.low) if side]
    tied = {terminal for side in driven for terminal in side}
    return [*driven, *((terminal,) for terminal in range(count) if terminal not in tied)]


def _islands(nodes: list[tuple[int, ...]], field: tuple[int, ...]) -> list[list[tuple[int, ...]]]:
    """Groups of nodes that sheets connect at zero frequency."""
    islands: list[list[tuple[int, ...]]] = []
    for node in nodes:
        sheets = {field[terminal] for terminal in node}
        connected = [
            island for island in islands if sheets & {field[t] for other in island for t in other}
        ]
        islands = [island for island in islands if island not in connected]
        islands.append([*(other for island in connected for other in island), node])
    return islands


def _indicator(nodes: Sequence[tuple[int, ...]], count: int) -> Real:
    column = np.zeros(count)
    column[[terminal for node in nodes for terminal in node]] = 1.0
    return column
