"""(K + s M) u = 0 by bilinear elements on equal cells, with 1 V and 0 V under the foils."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.rivals.cells import Cells, Fields
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.scene import Scene
from scipy.sparse import csc_matrix, kron
from scipy.sparse.linalg import spsolve

DIFFERENCE = np.array([[1.0, -1.0], [-1.0, 1.0]])
PRODUCT = np.array([[2.0, 1.0], [1.0, 2.0]]) / 6


@dataclass(frozen=True)
class System:
    """K in S, M in F over the nodes of all fields; nodes held at 1 V, at 0 V, and free ones."""

    K: csc_matrix
    M: csc_matrix
    high: NDArray[np.int64]
    low: NDArray[np.int64]
    free: NDArray[np.int64]

    def potential(self, s: complex) -> NDArray[np.complex128]:
        """u in V at every node; s in rad/s."""
        A = csc_matrix(self.K + s * self.M)
        u = np.zeros(len(self.free) + len(self.high) + len(self.low), dtype=complex)
        u[self.high] = 1.0
        u[self.free] = spsolve(A[self.free][:, self.free], -(A[self.free] @ u))
        return u


def build(scene: Scene, press: Press, cells: Cells) -> System:
    """The system of a press on a scene cut into these cells."""
    fields = Fields.of_scene(scene)
    along, across = cells.sides(scene)
    laplacian = across / along * np.kron(PRODUCT, DIFFERENCE)
    laplacian += along / across * np.kron(DIFFERENCE, PRODUCT)
    L = assembled(cells, laplacian, np.ones((cells.across, cells.along)))
    mass = along * across * np.kron(PRODUCT, PRODUCT)
    M = assembled(cells, mass, cells.capacitance(scene, press))
    nodes, last = cells.nodes, len(fields.resistances) - 1
    high = cells.under(fields.high)[0]
    low = nodes + cells.under(fields.low)[0] if last else np.array([], dtype=int)
    return System(
        csc_matrix(kron(np.diag(1 / np.array(fields.resistances)), L)),
        csc_matrix(kron(fields.coupling, M)),
        high,
        low,
        np.setdiff1d(np.arange(nodes * (last + 1)), np.concatenate([high, low])),
    )


def assembled(cells: Cells, element: NDArray, weight: NDArray) -> csc_matrix:
    """The sum over cells of weight times the element matrix, shape (node, node)."""
    nodes = np.arange(cells.nodes).reshape(cells.shape)
    corners = [nodes[:-1, :-1], nodes[:-1, 1:], nodes[1:, :-1], nodes[1:, 1:]]
    of_cell = np.stack([corner.ravel() for corner in corners], axis=1)
    rows, columns = np.repeat(of_cell, 4, axis=1), np.tile(of_cell, (1, 4))
    values = weight.reshape(-1, 1) * element.reshape(1, -1)
    return csc_matrix((values.ravel(), (rows.ravel(), columns.ravel())), shape=(cells.nodes,) * 2)
