"""Cross-sections by scikit-fem, which share nothing with the layers: a strip, and a press's edge.

Laplace's equation in x and z for each metre along y. Elements shrink geometrically towards the
edges of conductors.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from rcskin.simulator.fem.assembly import quadrilateral
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu
from skfem import Basis, BilinearForm, MeshQuad

from .layers import EPS0
from .lines import Array, graded

ORDER = 4
FINEST, RATIO = 1e-4, 0.2
"""Smallest element at an edge over the foam's thickness, and of neighbouring lengths."""
PLATES = 8.0
"""Thicknesses on either side of a step, where the field is straight to exp(-8 pi)."""


@BilinearForm
def energy(u, v, w):
    """Permittivity times grad u . grad v."""
    return w.permittivity * (u.grad[0] * v.grad[0] + u.grad[1] * v.grad[1])


def strip(
    width: float, thickness: float, permittivity: float, distance: float, far: float
) -> Array:
    """Charges of both sheets by both potentials, F/m, shape (2, 2), the top sheet first.

    distance [m]: from the bottom sheet to an earthed plane. far [m]: from the strip to the walls
    of the box, which are at earth's potential.
    """
    near = FINEST * thickness
    x = _toward(0.0, width / 2, near)
    x = np.concatenate([x, _away(width / 2, far, near)[1:]])
    top = _away(thickness, far, near)
    lower = _away(0.0, thickness / 2, near)
    below = _toward(-distance, 0.0, near)
    z = np.concatenate([below, lower[1:], thickness - lower[::-1][1:], top[1:]])
    mesh = MeshQuad.init_tensor(x, z)
    centre = mesh.p[:, mesh.t].mean(axis=1)
    foam = (centre[0] < width / 2) & (centre[1] > 0) & (centre[1] < thickness)
    basis = Basis(mesh, quadrilateral(ORDER), intorder=2 * ORDER)
    A = _assembled(basis, EPS0 * np.where(foam, permittivity, 1.0))
    at = mesh.p[:, mesh.facets].mean(axis=1)
    slack = near / 100
    sheets = [(abs(at[1] - level) < slack) & (at[0] < width / 2) for level in (thickness, 0.0)]
    on = [_held(basis, each) for each in sheets]
    box = (at[1] < -distance + slack) | (at[0] > x[-1] - slack) | (at[1] > z[-1] - slack)
    earth = _held(basis, box)
    return 2 * _charges(A, basis, on, earth)


def step(thickness: float, factor: float) -> float:
    """Capacitance of an edge where the gap narrows by a factor, beyond the local value.

    Over the permittivity, for each metre. One plate is flat; the other comes down by a vertical
    wall.
    """
    low, near = thickness / factor, FINEST * thickness
    side = PLATES * thickness
    right = _away(0.0, side, near)
    x = np.concatenate([-right[::-1], right[1:]])
    lower, upper = _toward(0.0, low, near), _toward(0.0, thickness - low, near)
    z = np.concatenate([lower, thickness - upper[::-1][1:]])
    mesh = MeshQuad.init_tensor(x, z)
    centre = mesh.p[:, mesh.t].mean(axis=1)
    mesh = mesh.restrict(np.flatnonzero((centre[0] < 0) | (centre[1] < low)))
    basis = Basis(mesh, quadrilateral(ORDER), intorder=2 * ORDER)
    A = _assembled(basis, np.ones(mesh.t.shape[1]))
    at, slack = mesh.p[:, mesh.facets].mean(axis=1), near / 100
    wall = (abs(at[0]) < slack) & (at[1] > low)
    plate = wall | (at[1] > thickness - slack) | ((at[0] > 0) & (abs(at[1] - low) < slack))
    total = _charges(A, basis, [_held(basis, plate)], _held(basis, at[1] < slack))[0, 0]
    return total - side / thickness - side / low


def _toward(start: float, end: float, near: float) -> Array:
    """Lines from start to end that shrink towards the end."""
    return np.concatenate([[start], end - graded(near, RATIO, end - start)[::-1], [end]])


def _away(start: float, far: float, near: float) -> Array:
    """Lines from start on that grow, up to `far` beyond it."""
    return np.concatenate([[start], start + graded(near, RATIO, far), [start + far]])


def _assembled(basis: Basis, permittivity: Array) -> csc_matrix:
    field = np.broadcast_to(permittivity[:, None], basis.dx.shape)
    return csc_matrix(energy.assemble(basis, permittivity=field))


def _held(basis: Basis, facets: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Which functions belong to edges of elements, shape (function,)."""
    found = np.zeros(basis.N, dtype=bool)
    found[basis.get_dofs(facets=np.flatnonzero(facets)).all()] = True
    return found


def _charges(
    A: csc_matrix, basis: Basis, conductors: list[NDArray[np.bool_]], earth: NDArray[np.bool_]
) -> Array:
    """By potentials of 1 V in turn. Only corners carry a constant; the other functions of an edge
    vanish at its ends."""
    fixed = np.array([each & ~earth for each in conductors]).T
    corner = np.zeros((basis.N, 1), dtype=bool)
    corner[np.asarray(basis.nodal_dofs).ravel()] = True
    potentials = (fixed & corner).astype(float)
    free = ~(fixed.any(axis=1) | earth)
    potentials[free] = splu(A[free][:, free]).solve(-(A @ potentials)[free])
    return potentials.T @ (A @ potentials)
