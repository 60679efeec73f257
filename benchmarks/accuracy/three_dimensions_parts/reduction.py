"""Z of an interface, from Galerkin on a Krylov space of K^-1 M: no digits are lost at low f.

With g_h and g_l the fields of direct current for 1 V at high and at low,
Y_lh = g_l'(K + sM) g_h + s (M g_l)' d, where (K + sM) d = -s M g_h on the free unknowns. Both
fields start the space, so that the error of Y_lh is of second order.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, cho_factor, cho_solve

from .lines import Array

Complex = NDArray[np.complex128]
FIRST_STEPS, MORE_STEPS, MOST_STEPS = 5, 2, 25
SMALL = 1e-12
"""Of a vector, over what it was before those of the space were taken out: it is in the space."""


class Part(NamedTuple):
    """A term of M that a touch adds: scale times the integral of weights (rows u)².

    rows: shape (place, unknown); weights: (place,); scale: () or (frequency,).
    """

    rows: Array
    weights: Array
    scale: Array | float


@dataclass(frozen=True)
class Driven:
    """An interface of a circuit, ready for any M.

    K: conductances, S. inverse: of those of the free unknowns, 0 for others. Both are of shape
    (unknown, unknown). harmonic: fields of direct current for 1 V at high and at low, shape
    (unknown, 2).
    """

    K: Array
    inverse: Array
    harmonic: Array


def driven(K: Array, terminals: tuple[Array, Array]) -> Driven:
    """Raises ValueError where part of a sheet has no path to a driven foil."""
    held, free = terminals
    try:
        factor = cho_factor(free.T @ K @ free)
    except LinAlgError as error:
        raise ValueError("a sheet without a driven foil cannot be solved here") from error
    inverse = free @ cho_solve(factor, free.T)
    return Driven(K, inverse, held - inverse @ (K @ held))


@dataclass(frozen=True)
class Masses:
    """M and what touches add to it. floating: the meter and the skin draw no charge from earth."""

    M: Array
    parts: Sequence[Part] = ()
    floating: bool = False

    def times(self, vectors: Array, index: int) -> Array:
        """M at a frequency, by its index, times vectors of shape (unknown, vector)."""
        if not self.floating:
            return self._times(vectors, index)
        one = np.ones((len(self.M), 1))
        drawn = self._times(np.hstack([one, vectors]), index)
        charge = drawn[:, :1]
        return drawn[:, 1:] - charge @ (charge.T @ vectors) / self._to_earth(charge.sum())

    def _times(self, vectors: Array, index: int) -> Array:
        found = self.M @ vectors
        for part in self.parts:
            weights = part.weights * _at(part.scale, index)
            found += part.rows.T @ (weights[:, None] * (part.rows @ vectors))
        return found

    def between(self, vectors: Array) -> Array:
        """M between vectors at every frequency, shape (frequency or 1, vector, vector)."""
        one = np.ones((len(self.M), 1))
        vectors = np.hstack([vectors, one]) if self.floating else vectors
        found = (vectors.T @ self.M @ vectors)[None]
        for part in self.parts:
            rows = part.rows @ vectors
            own = rows.T @ (part.weights[:, None] * rows)
            found = found + np.atleast_1d(part.scale)[:, None, None] * own
        if not self.floating:
            return found
        charge = found[:, :-1, -1:]
        earth = self._to_earth(found[:, -1:, -1:])
        return found[:, :-1, :-1] - charge @ charge.transpose(0, 2, 1) / earth

    def _to_earth(self, capacitance: Array) -> Array:
        """Of all that is there, F; infinite where it is rounding, as nothing is earthed."""
        return np.where(capacitance > SMALL * abs(self.M).sum(), capacitance, np.inf)

    @property
    def states(self) -> tuple[int, ...]:
        """Frequencies whose M the space follows: the first and the last where touches drift."""
        return (0, -1) if any(np.ndim(part.scale) for part in self.parts) else (0,)


def _at(scale: Array | float, index: int) -> float:
    return float(np.atleast_1d(scale)[index if np.ndim(scale) else 0])


def reduced(interface: Driven, masses: Masses, s: Complex, rtol: float) -> tuple[Complex, float]:
    """Z, shape (frequency,), and the relative change that the last steps made.

    Raises RuntimeError where that stays above rtol.
    """
    space = np.zeros((2, len(masses.M), 0))
    latest = {state: interface.harmonic for state in masses.states}
    before: Complex | None = None
    for step in range(1, MOST_STEPS + 1):
        for state in latest:
            new = _new(interface, masses.times(latest[state], state), space)
            space = np.concatenate([space, new], axis=2)
            latest[state] = new[0]
        if step < FIRST_STEPS or (step - FIRST_STEPS) % MORE_STEPS:
            continue
        Z = -1 / _transfer(interface, masses, s, space[0])
        if before is not None and (change := float(abs(Z / before - 1).max())) < rtol:
            return Z, change
        before = Z
    raise RuntimeError(f"no Z within {rtol:g} after {MOST_STEPS} steps")


def _new(interface: Driven, drawn: Array, space: Array) -> Array:
    """K^-1 of charges on the free unknowns, less what the space has of it, orthonormal by K.

    Each time vectors are made orthonormal, what rounding leaves of the space in a short one grows
    with its length: a third time nothing is left. Vectors and K times them, as those of the space:
    shape (2, unknown, vector).
    """
    found = interface.inverse @ drawn
    size = np.einsum("ij,ij->j", found, interface.K @ found).max(initial=0.0)
    for _ in range(3):
        found = found - space[0] @ (space[1].T @ found)
        values, turn = np.linalg.eigh(found.T @ interface.K @ found)
        kept = values > SMALL**2 * size
        found, size = found @ (turn[:, kept] / np.sqrt(values[kept])), 1.0
    return np.stack([found, interface.K @ found])


def _transfer(interface: Driven, masses: Masses, s: Complex, space: Array) -> Complex:
    """Y between low and high, S."""
    size = space.shape[1]
    M = masses.between(np.hstack([space, interface.harmonic]))
    high, low = M[:, :size, size], M[:, :size, size + 1]
    held = interface.harmonic[:, 1] @ interface.K @ interface.harmonic[:, 0]
    system = np.eye(size) + s[:, None, None] * M[:, :size, :size]
    rising = s[:, None] * np.broadcast_to(high, (len(s), size))
    deviation = -np.linalg.solve(system, rising[..., None])[..., 0]
    return held + s * M[:, size + 1, size] + s * (low * deviation).sum(axis=1)
