"""Skins with corners, holes and slits against a program of scikit-fem alone."""

import numpy as np
import pytest
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import parse_press
from scipy.sparse import block_array, coo_array
from scipy.sparse.linalg import spsolve
from skfem import Basis, BilinearForm, ElementTriP2, MeshTri

R, C = 1e5, 5e-9
"""ohm/sq of both sheets together, F/m²."""
SHEETS = {"top": 0.6 * R, "bottom": 0.4 * R, "c": C}
SIDE = {"length": 0.12, "width": 0.12}
L_SHAPE = [[0, 0], [0.12, 0], [0.12, 0.06], [0.06, 0.06], [0.06, 0.12], [0, 0.12]]
SQUARE = [[0, 0], [0.12, 0], [0.12, 0.12], [0, 0.12]]


def both(edge, **more):
    """The same foil on both sheets."""
    return {f"top-{edge}": more, f"bottom-{edge}": more}


@BilinearForm
def conducted(u, v, _):
    return u.grad[0] * v.grad[0] + u.grad[1] * v.grad[1]


@BilinearForm
def stored(u, v, w):
    return w.c * u * v


def quadratic(lines, kept, foils, s, factor, near):
    """Y in S of a skin of squares between lines, by scikit-fem alone.

    kept: whether a place belongs to the skin. foils: by name, "top", "bottom" and those that float
    on the top sheet, whether a place of the rim is under one. factor: c over C at places. near:
    corners towards which triangles are refined.
    """
    mesh = MeshTri.init_tensor(*lines)
    mesh = mesh.remove_elements(np.flatnonzero(~kept(mesh.p[:, mesh.t].mean(axis=1))))
    for _ in range(14):
        corners = np.isin(mesh.t, [np.hypot(*(mesh.p.T - at).T).argmin() for at in near])
        mesh = mesh.refined(np.flatnonzero(corners.any(axis=0)))
    mesh = mesh.refined(1)
    basis = Basis(mesh, ElementTriP2())
    N, middle = basis.N, mesh.p[:, mesh.t].mean(axis=1)
    K = conducted.assemble(basis)
    M = stored.assemble(basis, c=C * factor(middle)[:, None] * np.ones((1, basis.X.shape[1])))
    A = block_array([[K / 6e4 + s * M, -s * M], [-s * M, K / 4e4 + s * M]]).tocsr()
    number = np.arange(2 * N)
    terminals = {}
    for name, where in foils.items():
        facets = mesh.facets_satisfying(where, boundaries_only=True)
        under = basis.get_dofs(facets).flatten() + (N if name == "bottom" else 0)
        number[under] = terminals[name] = under[0]
    held, number = np.unique(number, return_inverse=True)
    tie = coo_array((np.ones(2 * N), (np.arange(2 * N), number))).tocsr()
    A = (tie.T @ A @ tie).tocsr()
    top, bottom = (np.searchsorted(held, terminals[name]) for name in ("top", "bottom"))
    free = np.setdiff1d(np.arange(len(held)), [top, bottom])
    u = np.zeros(len(held), dtype=complex)
    u[top] = 1.0
    right = -A[free][:, [top]].toarray().ravel()
    u[free] = spsolve(A[free][:, free].tocsc(), right, permc_spec="MMD_AT_PLUS_A")
    return (A @ u)[top]


EVEN = np.linspace(0, 0.12, 13)
LEFT = {name: lambda x: x[0] < 1e-9 for name in ("top", "bottom")}
SLIT = [[0, 0], [0.12, 0], [0.12, 0.12], [0, 0.12], [0, 0.061], [0.06, 0.061], [0.06, 0.059]]
SLIT += [[0, 0.059]]
HOLE = [[0.04, 0.04], [0.08, 0.04], [0.08, 0.08], [0.04, 0.08]]
CASES = {
    "an L": (
        {"points": L_SHAPE},
        both("outline.6"),
        (EVEN, EVEN),
        lambda x: (x[0] < 0.06) | (x[1] < 0.06),
        LEFT,
        [(0.06, 0.06)],
    ),
    "an L with a floating foil": (
        {"points": L_SHAPE},
        {"top-outline.6": {}, "bottom-outline.1": {}, "top-outline.2": {}},
        (EVEN, EVEN),
        lambda x: (x[0] < 0.06) | (x[1] < 0.06),
        {
            "top": lambda x: x[0] < 1e-9,
            "bottom": lambda x: x[1] < 1e-9,
            "floating": lambda x: x[0] > 0.12 - 1e-9,
        },
        [(0.06, 0.06)],
    ),
    "a hole": (
        {"points": SQUARE, "holes": [{"points": HOLE}]},
        both("outline.4", span=(0.0, 0.5)),
        (EVEN, EVEN),
        lambda x: np.abs(x - 0.06).max(axis=0) > 0.02,
        {name: lambda x: (x[0] < 1e-9) & (x[1] > 0.06) for name in ("top", "bottom")},
        [*HOLE, (0, 0.06)],
    ),
    "fed around a hole": (
        {"points": SQUARE, "holes": [{"points": HOLE}]},
        {"top-hole1": {}, "bottom-outline.3": {}},
        (EVEN, EVEN),
        lambda x: np.abs(x - 0.06).max(axis=0) > 0.02,
        {
            "top": lambda x: np.abs(x - 0.06).max(axis=0) < 0.03,
            "bottom": lambda x: x[1] > 0.12 - 1e-9,
        },
        HOLE,
    ),
    "a slit": (
        {"points": SLIT},
        both("outline.4"),
        (EVEN, np.sort([*EVEN[EVEN != EVEN[6]], 0.059, 0.061])),
        lambda x: (x[0] > 0.06) | (abs(x[1] - 0.06) > 0.001),
        {name: lambda x: (x[0] < 1e-9) & (x[1] > 0.0609) for name in ("top", "bottom")},
        [(0.06, 0.059), (0.06, 0.061)],
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_corners_and_holes_against_scikit_fem(varied, off, case):
    """Pixel (1, 2) of 3 x 3 is pressed to twice its capacitance."""
    outline, foils, lines, kept, under, near = CASES[case]
    f = np.array([2e3, 2e5])
    scene = varied({"outline": outline}, foils, frequencies=f, rows=3, columns=3, **SHEETS, **SIDE)

    def factor(x):
        return np.where((abs(x[0] - 0.06) < 0.02) & (x[1] < 0.04), 2.0, 1.0)

    Y = np.array([quadratic(lines, kept, under, 2j * np.pi * each, factor, near) for each in f])
    answer = Solver(scene.parts, 1e-4).solve(parse_press("1,2:2", 2.0))
    estimated, true = np.stack(answer.relative_errors), off(answer.Z, 1 / Y)
    assert max(estimated.max(), true.max()) <= 1e-4 * (1 + 1e-9)
    assert (true <= estimated + 1e-9).all()
