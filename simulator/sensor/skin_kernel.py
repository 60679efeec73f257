"""Compiled admittances of many skins, each under its own press; see `models.reduced.kernel`."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..compiled import compiled
from ..fem.kernels import continued_fractions
from ..fem.lanczos import MAX_LANCZOS_STEPS
from ..models.reduced.dense import DenseExcitation, UnpressedMass
from ..models.reduced.kernel import farthest_of, lanczos_steps, work_vectors
from ..press.batch import PressBatch
from .skin_stack import StackedExcitation, StackedMass


@compiled()
def skin_admittances(
    mass: StackedMass,
    excitation: StackedExcitation,
    skins: NDArray,
    presses: NDArray,
    batch: PressBatch,
    s: NDArray,
) -> NDArray:  # pragma: no cover
    """Y in S, shape (row, s): row k is of skin skins[k] of the stack under press presses[k].

    s: rad/s, shape (skin, s). Each row is what `swept` gives for that skin and press.
    """
    cells, rises, starts = batch
    count, frequencies = len(skins), s.shape[1]
    Y, parts = np.empty((count, frequencies), np.complex128), np.empty((4, frequencies))
    fractions, basis = np.empty((2, frequencies)), np.empty((0, mass.rows.shape[2]))
    diagonal, squared = np.empty(MAX_LANCZOS_STEPS), np.empty(MAX_LANCZOS_STEPS)
    first = DenseExcitation(
        excitation.conductance[0],
        excitation.driven,
        excitation.tied[0],
        excitation.tied_inverse[0],
        excitation.common[0],
    )
    work = work_vectors(UnpressedMass(mass.rows[0], mass.diagonal[0], mass.factors[0]), first)
    for row in range(count):
        skin, press = skins[row], presses[row]
        own = UnpressedMass(mass.rows[skin], mass.diagonal[skin], mass.factors[skin])
        driven = DenseExcitation(
            excitation.conductance[skin],  # pyright: ignore[reportArgumentType]
            excitation.driven,
            excitation.tied[skin],
            excitation.tied_inverse[skin],
            excitation.common[skin],
        )
        here = cells[starts[press] : starts[press + 1]]
        weighted = rises[starts[press] : starts[press + 1]].copy()
        for k in range(len(here)):
            weighted[k] *= mass.own[skin, here[k]]
        at = s[skin]
        steps, capacitance = lanczos_steps(
            own, driven, (here, weighted), farthest_of(at),
            mass.rtol[skin],  # pyright: ignore[reportArgumentType]
            work, diagonal, squared, basis,
        )  # fmt: skip
        delayed = 0.0
        if steps:
            delayed = squared[0]
            for k in range(frequencies):
                square = at[k] * at[k]
                parts[0, k], parts[1, k] = at[k].real, at[k].imag
                parts[2, k], parts[3, k] = square.real, square.imag
            continued_fractions(parts, diagonal, squared, steps, fractions)
        for k in range(frequencies):
            at_once = driven.conductance + at[k] * capacitance
            late = complex(parts[2, k], parts[3, k]) * complex(fractions[0, k], fractions[1, k])
            Y[row, k] = at_once - delayed * late if steps else at_once
    return Y
