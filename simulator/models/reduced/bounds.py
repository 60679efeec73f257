"""Certificates of many cases at once, as `certificate` gives them one by one.

Potentials of the reduced model come from a few Lanczos steps on small dense matrices, whatever the
press; their residuals and what K^-1 makes of those are found for all presses of a skin together.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...fem.estimate import certified
from ...fem.lanczos import potentials
from .cases import Case, by_skin
from .certificate import residual_power, side_by_side
from .dense import Feed, dense_pencil, mass_of, widened
from .family import Family
from .model import Reduced, ReducedSkin

KRYLOV_RTOL = 1e-6


def bounds(reduced: Reduced, cases: list[Case], s: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Of each case, the largest bound on the relative errors of Rs and Cp. s: rad/s."""
    found = np.empty(len(cases))
    for group in by_skin(cases, reduced.scene):
        skin = reduced.skin_under(cases[group[0]])
        found[group] = _on_skin(skin, [cases[k] for k in group], s)
    return found


def _on_skin(
    skin: ReducedSkin, cases: list[Case], s: NDArray[np.complex128]
) -> NDArray[np.float64]:
    family, reduced, system = skin.reduced.family, skin.reduced, skin.system
    solved = [_solved(skin, case, feed, s) for case in cases for feed in skin.feeds]
    u = skin.turn @ np.hstack([each for each, _ in solved])
    Y = np.stack([each for _, each in solved])
    potential = reduced.coordinates @ side_by_side(u)
    current = family.space.currents(potential, system.sheets, system.films)
    charge = _charges(family, [family.foam_of(case) for case in cases], potential)
    power = residual_power(family.space, current, charge, np.tile(s, len(solved)))
    bound = certified(Y, power.reshape(Y.shape) / skin.least_conductance)
    return bound.max(axis=0).reshape(len(cases), -1).max(axis=1)


def _charges(
    family: Family, maps: list[NDArray[np.float64]], potential: NDArray[np.float64]
) -> NDArray[np.float64]:
    """M of each map times its own potentials, in C, inside."""
    own = potential.reshape(len(potential), 2, len(maps), -1)
    charge = np.empty((family.space.inner, *own.shape[1:]))
    for k, each in enumerate(maps):
        mass, here = family.mass_inside(each), own[:, :, k]
        found = mass @ here.reshape(len(own), -1)
        charge[:, :, k] = found[: family.space.inner].reshape(-1, 2, own.shape[-1])
    return charge.reshape(len(charge), -1)


def _solved(
    skin: ReducedSkin, case: Case, feed: Feed, s: NDArray[np.complex128]
) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    """Potentials of one drive at 1 V in the skin's coordinates, shape (N + n, s), and Y in S."""
    mass = mass_of(*skin.touched(case.cells, case.rises))
    at_zero = widened(feed.driven, len(mass))
    for sheet in widened(feed.common, len(mass)):
        at_zero -= sheet * (sheet @ mass @ at_zero) / (sheet @ mass @ sheet)
    pencil = dense_pencil(mass, feed)
    at_shifts: Any = s
    v = potentials(pencil, at_shifts, KRYLOV_RTOL).astype(np.complex128)
    Y = pencil.admittance + s * (pencil.capacitance + pencil.start @ v)
    return at_zero[:, None] + v, Y
