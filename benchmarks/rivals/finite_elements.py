"""Finite elements on scikit-fem.

Plain scripts: two forms, one sparse solve a frequency, on quadrilaterals or on triangles of one
size. A pixel pressed to a depth: T (w_xx + w_yy) = p(w/d) by five points on equal cells, free at
the edges, held at the depth where the applicator is, Newton's method; each cell then is a pixel of
its own. What the others are judged by where no formula is known: high order, graded towards foil
ends, solved for the deviation from the driven potential, so that neither thin cells nor low
frequencies cost digits.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.rivals.bilinear import Fields
from rcskin.simulator.press.capacitance import capacitance_map
from rcskin.simulator.press.press import Press
from rcskin.simulator.press.touch import Touch
from rcskin.simulator.scene.contacts import Contact
from rcskin.simulator.scene.scene import Scene
from scipy.sparse import block_diag, csc_matrix, csr_matrix, diags_array, eye_array, kron
from scipy.sparse.linalg import splu, spsolve
from skfem import (
    Basis,
    BilinearForm,
    Element,
    ElementQuad1,
    ElementQuad2,
    ElementQuadP,
    ElementTriP1,
    ElementTriP2,
    MeshQuad,
    MeshTri,
)

GRADING = 0.2


@dataclass(frozen=True)
class Elements:
    """Order, cells along a pixel's side, and layers of ever smaller cells towards foil ends."""

    order: int
    cells: int
    layers: int = 0


@BilinearForm
def laplacian(u, v, _):
    return u.grad[0] * v.grad[0] + u.grad[1] * v.grad[1]


@BilinearForm
def product(u, v, w):
    return w.c * u * v


@dataclass(frozen=True)
class Matrices:
    """K in S, M in F, the field 1 everywhere, and unknowns under the foils and elsewhere.

    one: coefficients of 1 V all over the first field, shape (unknown,). high: under the first foil.
    """

    K: csr_matrix
    M: csr_matrix
    one: NDArray[np.float64]
    high: NDArray[np.int64]
    free: NDArray[np.int64]


def script(scene: Scene, press: Press, frequencies: NDArray, elements: Elements) -> NDArray:
    """Z = 1/Y with 1 V at one foil and 0 V at the other, Y the current drawn at the first."""
    system = discretised(scene, press, elements)
    one, high, free = system.one, system.high, system.free

    def admittance(s: complex) -> complex:
        A = system.K + s * system.M
        u = np.zeros(A.shape[0], dtype=complex)
        u[high] = one[high]
        u[free] = spsolve(A[free][:, free].tocsc(), -(A[free] @ u))
        return one[high] @ (A[high] @ u)

    return 1 / np.array([admittance(2j * np.pi * f) for f in frequencies])


def discretised(scene: Scene, press: Press, elements: Elements) -> Matrices:
    """The two forms of a press on a scene."""
    fields = Fields.of_scene(scene)
    foils = [fields.high, fields.low]
    mesh = MeshQuad.init_tensor(
        lines(scene.skin.length, scene.pixels.columns, foils, ("bottom", "top"), elements),
        lines(scene.skin.width, scene.pixels.rows, foils, ("left", "right"), elements),
    )
    basis = Basis(mesh, element_of(elements.order), intorder=2 * elements.order)
    L = laplacian.assemble(basis)
    mass = product.assemble(basis, c=at_points(scene, press, basis))
    N, both = basis.N, len(fields.resistances) == 2
    one = np.zeros(N * len(fields.resistances))
    one[basis.nodal_dofs if elements.order > 2 else slice(N)] = 1.0
    high = under_foil(scene, basis, fields.high)
    low = N + under_foil(scene, basis, fields.low) if both else []
    return Matrices(
        csr_matrix(block_diag([L / R for R in fields.resistances])),
        csr_matrix(kron(fields.coupling, mass)),
        one,
        high,
        np.setdiff1d(np.arange(len(one)), [*high, *low]),
    )


def element_of(order: int) -> Element:
    """The quadrilateral element of that order."""
    return {1: ElementQuad1, 2: ElementQuad2}.get(order, lambda: ElementQuadP(order))()


def lines(
    length: float, pixels: int, foils: list[Contact], edges: tuple[str, str], elements: Elements
) -> NDArray:
    """Mesh lines along one side, at pixel edges and ends of foils on `edges` and between them.

    Layers get narrower towards the ends of foils, and towards the edges that foils end on.
    """
    ends = {end * length for foil in foils if foil.edge in edges for end in foil.span}
    pixel = length / pixels
    distinct = np.unique(np.round([*np.linspace(0, length, pixels + 1), *ends], 12))
    counts = np.ceil(np.diff(distinct) / pixel * elements.cells - 1e-6).astype(int)
    between = [
        np.linspace(start, stop, count + 1)[:-1]
        for start, stop, count in zip(distinct[:-1], distinct[1:], counts, strict=True)
    ]
    fine = ends | {
        length if foil.edge in ("right", "top") else 0.0 for foil in foils if foil.edge not in edges
    }
    steps = pixel / elements.cells * GRADING ** np.arange(1, elements.layers + 1)
    near = [place + sign * steps for place in fine for sign in (-1, 1)]
    every = np.concatenate([*between, [length], *near])
    return np.unique(np.round(every[(every >= 0) & (every <= length)], 15))


def at_points(scene: Scene, press: Press, basis: Basis) -> NDArray:
    """c in F/m² at every point of integration, shape (element, point)."""
    c = capacitance_map(scene.parts.skin, press)
    x, y = basis.global_coordinates()
    return c[
        (y / scene.skin.width * scene.pixels.rows).astype(int),
        (x / scene.skin.length * scene.pixels.columns).astype(int),
    ]


def under_foil(scene: Scene, basis: Basis, foil: Contact) -> NDArray:
    """Unknowns under a foil."""
    start, stop = foil.ends(scene.skin)
    along = 1 if foil.edge in ("left", "right") else 0
    tiny = 1e-12

    def covered(x: NDArray) -> NDArray:
        on_edge = abs(x[1 - along] - start[1 - along]) < tiny
        return on_edge & (start[along] - tiny < x[along]) & (x[along] < stop[along] + tiny)

    return basis.get_dofs(basis.mesh.facets_satisfying(covered, boundaries_only=True)).flatten()


ELEMENTS = {1: ElementTriP1, 2: ElementTriP2}

Places = Callable[[NDArray[np.float64]], NDArray]


def on_triangles(
    mesh: MeshTri,
    order: int,
    fed: Places,
    c: Places,
    resistance: float,
    frequencies: NDArray[np.float64],
) -> NDArray[np.complex128]:
    """Z in ohm, shape (frequency,). fed: whether an edge at x (2, ...) lies under the foils. c: at
    x, F/m². resistance: of both sheets together, ohm/sq."""
    basis = Basis(mesh, ELEMENTS[order](), intorder=2 * order)
    K = laplacian.assemble(basis) / resistance
    M = product.assemble(basis, c=c(np.asarray(basis.global_coordinates())))
    under = basis.get_dofs(mesh.facets_satisfying(fed, boundaries_only=True)).flatten()
    free = np.setdiff1d(np.arange(K.shape[0]), under)

    def admittance(s: complex) -> complex:
        A = (K + s * M).tocsr()
        u = np.ones(A.shape[0], dtype=complex)
        u[free] = spsolve(A[free][:, free].tocsc(), -A[free][:, under].sum(axis=1))
        return complex((A[under] @ u).sum())

    return 1 / np.array([admittance(2j * np.pi * f) for f in frequencies])


NEWTON_STEPS, ENOUGH = 50, 1e-12
"""Of Newton's method; in units of the depth."""


def pressed_to_a_depth(
    scene: Scene, pixel: tuple[int, int], frequencies: NDArray[np.float64], cells: int
) -> NDArray[np.complex128]:
    """Z in ohm under a pixel pressed to the scene's depth; so many cells along a pixel's side."""
    rows, columns = (cells * count for count in scene.pixels.shape)
    strain = deflection(scene, pixel, cells) / scene.skin.foam.thickness
    factor = scene.skin.foam.mechanics.factor(strain)
    laid = scene.with_({"pixels.rows": rows, "pixels.columns": columns})
    touches = [Touch(int(i) + 1, int(j) + 1, float(f)) for (i, j), f in np.ndenumerate(factor)]
    return script(laid, Press(tuple(touches)), frequencies, Elements(1, 1))


def deflection(scene: Scene, pixel: tuple[int, int], cells: int) -> NDArray[np.float64]:
    """w in m in the middle of each cell, shape (row, column)."""
    mechanics, thickness = scene.skin.foam.mechanics, scene.skin.foam.thickness
    depth = scene.press.depth
    shape = tuple(cells * count for count in scene.pixels.shape)
    pull = mechanics.tension * _laplacian(shape, scene)
    held = np.zeros(shape, dtype=bool)
    first = [cells * (number - 1) for number in pixel]
    held[first[0] : first[0] + cells, first[1] : first[1] + cells] = True
    free = np.flatnonzero(~held)
    w = np.where(held, depth, 0.0).ravel()
    for _ in range(NEWTON_STEPS):
        strain = w / thickness
        residual = mechanics.elastic.stress(strain) - pull @ w
        stiffness = diags_array(mechanics.elastic.stiffness(strain) / thickness)
        step = spsolve(csc_matrix(stiffness - pull)[free][:, free], residual[free])
        w[free] -= step
        if np.abs(step).max() <= ENOUGH * depth:
            return w.reshape(shape)
    raise AssertionError(
        f"Newton's method moves by {np.abs(step).max():.1e} m after {NEWTON_STEPS} steps"
    )


def _laplacian(shape: tuple[int, ...], scene: Scene) -> csc_matrix:
    """Of cells, with no slope at the edges; 1/m²."""
    across, along = (
        _second(count, side / count)
        for count, side in zip(shape, (scene.skin.width, scene.skin.length), strict=True)
    )
    return csc_matrix(kron(across, eye_array(shape[1])) + kron(eye_array(shape[0]), along))


def _second(count: int, side: float) -> csc_matrix:
    middle = np.full(count, -2.0)
    middle[[0, -1]] = -1.0
    return csc_matrix(
        diags_array([np.ones(count - 1), middle, np.ones(count - 1)], offsets=(-1, 0, 1)) / side**2
    )


STEPS = 25
POWERS = (1, 2, 3)
"""Of the cells at a foil's end, in the error: the field there goes as r^1/2, r^3/2, r^5/2."""
SYMMETRIC: dict = {
    "permc_spec": "MMD_AT_PLUS_A",
    "diag_pivot_thresh": 0.0,
    "options": {"SymmetricMode": True},
}


def over_resolved(scene: Scene, press: Press, frequencies: NDArray, elements: Elements) -> NDArray:
    """Z of the mesh or, where it has layers, of ever more of them: at least as many as POWERS.

    It is extrapolated from a few, for in cells below some 1e-5 of a pixel rounding costs more than
    they gain.
    """
    if elements.layers == 0:
        return of_mesh(scene, press, frequencies, elements)
    counts = range(elements.layers - len(POWERS), elements.layers + 1)
    Z = [of_mesh(scene, press, frequencies, replace(elements, layers=count)) for count in counts]
    for power in POWERS:
        ratio = GRADING**power
        Z = [fine + (fine - coarse) * ratio / (1 - ratio) for coarse, fine in pairwise(Z)]
    return Z[0]


def of_mesh(scene: Scene, press: Press, frequencies: NDArray, elements: Elements) -> NDArray:
    """Z = 1/Y, Y = s g'Mg - s² b'(1 + s T)^-1 b in the space of (K^-1 M)^k K^-1 M g.

    b and T: M g and M in a basis V of that space with V'KV = 1. For omega R C up to some hundreds,
    where 25 dimensions leave nothing but rounding.
    """
    system = discretised(scene, press, elements)
    free = system.free
    charge = system.M @ system.one
    K, M = (csc_matrix(A[free][:, free]) for A in (system.K, system.M))
    factors = splu(K, **SYMMETRIC)
    V = np.zeros((len(free), 0))
    following = charge[free]
    for _ in range(STEPS):
        v = factors.solve(following)
        for _ in range(2):
            v -= V @ (V.T @ (K @ v))
        v /= np.sqrt(v @ (K @ v))
        V = np.column_stack([V, v])
        following = M @ v
    b, T = V.T @ charge[free], V.T @ (M @ V)
    return np.array(
        [
            1 / (s * (system.one @ charge) - s**2 * b @ np.linalg.solve(np.eye(STEPS) + s * T, b))
            for s in 2j * np.pi * np.asarray(frequencies)
        ]
    )
