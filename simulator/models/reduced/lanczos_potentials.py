"""Potentials of presses from the Lanczos vectors of their sweeps, for residuals.

A certificate holds for any potentials; these are close to those of Galerkin's method in the whole
basis.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from ...arrays import Complex, Integer, Real
from ...compiled import compiled
from ...fem.lanczos import MAX_LANCZOS_STEPS
from .dense import DenseExcitation, UnpressedMass, aligned
from .kernel import farthest_of, lanczos_steps, work_vectors

RTOL = 1e-12
"""Tolerance of Lanczos' method for Rs and Cp; that of the potentials is its square root."""
Touched = tuple[Integer, Real]
Potentials = tuple[Complex, Complex]


def spanned_by_all(
    excitations: Sequence[DenseExcitation],
    presses: Iterable[tuple[UnpressedMass, Integer, Real]],
    s: Complex,
) -> Potentials:
    """Potentials and Y of each press and excitation, see `spanned`.

    The potentials have shape (m, press * excitation * s), Y has shape (press, excitation, s).
    """
    found = []
    for unpressed, cells, weights in presses:
        own, touched = aligned(unpressed), (cells, weights)
        found += [spanned(excitation, own, touched, s, RTOL) for excitation in excitations]
    u, Y = zip(*found, strict=True)
    return np.hstack(u), np.stack(Y).reshape(-1, len(excitations), len(s))


@compiled()
def spanned(
    excitation: DenseExcitation, unpressed: UnpressedMass, touched: Touched, s: NDArray, rtol: float
) -> Potentials:  # pragma: no cover
    """Potentials of one press at 1 V, shape (m, s), and Y in S, shape (s,).

    touched: cells and their rises. s, rtol: see `swept`.
    """
    m = unpressed.rows.shape[1]
    work, basis = work_vectors(unpressed, excitation), np.empty((MAX_LANCZOS_STEPS, m))
    diagonal, squared = np.empty(MAX_LANCZOS_STEPS), np.empty(MAX_LANCZOS_STEPS)
    steps, capacitance = lanczos_steps(
        unpressed, excitation, touched, farthest_of(s), rtol, work, diagonal, squared, basis
    )
    u, Y = np.empty((m, len(s)), np.complex128), np.empty(len(s), np.complex128)
    share = np.empty(steps, np.complex128)
    for k in range(len(s)):
        _shares(s[k], diagonal, squared, share)
        Y[k] = excitation.conductance + s[k] * capacitance
        if steps:
            Y[k] += s[k] * np.sqrt(squared[0]) * share[0]
        for row in range(m):
            potential = complex(work[0, row], 0.0)
            for step in range(steps):
                potential += basis[step, row] * share[step]
            u[row, k] = potential
    return u, Y


@compiled()
def _shares(
    s: complex, diagonal: NDArray, squared: NDArray, share: NDArray
) -> None:  # pragma: no cover
    """Writes -s (1 + s T)^-1 e1 b_0 into `share`, by elimination.

    diagonal, squared: of T, see `lanczos_steps`.
    """
    steps = len(share)
    pivot = np.empty(steps, np.complex128)
    for step in range(steps):
        pivot[step] = 1.0 + s * diagonal[step]
        if step == 0:
            share[0] = -s * np.sqrt(squared[0])
        else:
            factor = s * np.sqrt(squared[step]) / pivot[step - 1]
            pivot[step] -= factor * s * np.sqrt(squared[step])
            share[step] = -factor * share[step - 1]
    for step in range(steps - 1, -1, -1):
        if step + 1 < steps:
            share[step] -= s * np.sqrt(squared[step + 1]) * share[step + 1]
        share[step] /= pivot[step]
