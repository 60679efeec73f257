"""A plain finite element script on scikit-fem: two forms, one sparse solve a frequency."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.rivals.cells import Fields
from rcskin.simulator.press.capacitance import capacitance_map
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.contacts import Contact
from rcskin.simulator.scene.scene import Scene
from scipy.sparse import block_diag, csr_matrix, kron
from scipy.sparse.linalg import spsolve
from skfem import Basis, BilinearForm, Element, ElementQuad1, ElementQuad2, ElementQuadP, MeshQuad

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


def impedance(scene: Scene, press: Press, frequencies: NDArray, elements: Elements) -> NDArray:
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
